//! Distances from any samples.

use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Report, options,
};
use shapeloom_isosurface::{InsideChoice, IsoValue, Level};

use super::march::{Bricks, Dense, March, SAMPLE_BYTES, Table};
use super::{check_scale, distance_grid};
use crate::full_cells::FullCells;
use crate::sparse_bricks::{BRICK, Filled, SIDE, samples_of};
use crate::{Quantity, SparseBricks, VoxelGrid, morton};

options! {
    /// Signed distances to the surface of a grid of anything: negative inside.
    ///
    /// The surface between samples is cut into triangles by marching tetrahedra; the samples around it get their exact
    /// distance to those. From there on a front goes outward in the order of distance, as in fast marching (Sethian
    /// 1996), but each sample takes the nearest of the triangles that its neighbours have and of those in the cells
    /// around, instead of solving a quadratic equation: its value is the exact distance to some triangle, so never less
    /// than to the nearest, and mostly that. Lattices may be skewed.
    ///
    /// Every sample keeps its side, so no cell gains or loses surface. At the border of the lattice the surface ends:
    /// distances are to what lies inside. Samples that are NaN or infinite are outside, and get finite distances too.
    /// On one thread. Cost: O(n log n) in samples; with a band in those of the band. Memory: 64 bytes a sample, 92 a
    /// triangle.
    pub struct Redistance("redistance") {
        required {}
        optional {
            /// The value that parts inside and outside; auto for what the samples suggest.
            iso: IsoValue [IsoValue::BOUNDS] = IsoValue::Auto,
            /// On which side of the value the inside is.
            inside: InsideChoice = InsideChoice::Auto,
            /// Distances beyond this are cut to it, in model units; 0 for none that are cut.
            band: f64 [Bounds::NON_NEGATIVE] = 0.0,
        }
    }
}

impl FromTolerance<VoxelGrid> for Redistance {
    fn from_tolerance(_: &VoxelGrid, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<VoxelGrid> for Redistance {
    type Output = VoxelGrid;

    fn convert_with(&self, source: &VoxelGrid, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        exec.check()?;
        let (level, words) = Level::settle(source, self.iso, self.inside, exec)?;
        let band = if self.band == 0.0 { f64::INFINITY } else { self.band };
        let Distances { values, surface_cells, not_finite } = distances(source, level, band, exec)?;
        let lattice = *source.lattice();
        let (deviation, basis) = match not_finite {
            0 => (
                Deviation::AtMost(lattice.cell_diagonal().next_up()),
                "the diagonal of a cell: every sample keeps its side, so the same cells have surface",
            ),
            _ => (Deviation::Unknown, "samples that are not finite have no interpolant"),
        };
        let mut report = Report::new(Self::NAME, deviation, format!("{words}; {basis}"));
        level.tell(source, &words, not_finite, surface_cells, &mut report, exec)?;
        report.figure("surface_cells", surface_cells as f64);
        exec.progress(1.0);
        Ok(Converted::new(distance_grid(lattice, values)?, report))
    }
}

/// Distances at every sample.
pub(super) struct Distances {
    pub values: Vec<f32>,
    pub surface_cells: u64,
    pub not_finite: u64,
}

/// A distance with its side, in single precision. Inside is never 0, which would be outside.
fn signed(distance: f64, inside: bool) -> f32 {
    let distance = distance as f32;
    if inside { -distance.max(f32::MIN_POSITIVE) } else { distance }
}

pub(super) fn distances(source: &VoxelGrid, level: Level, band: f64, exec: &Exec) -> Result<Distances, ConvertError> {
    let lattice = *source.lattice();
    check_scale(&lattice)?;
    let dimensions = lattice.dimensions();
    let _memory = exec.reserve_elements(lattice.samples(), SAMPLE_BYTES + size_of::<f32>())?;
    let _bits = exec.reserve(FullCells::bytes(lattice.samples()))?;
    let cells = FullCells::of(source, level, exec)?;
    let mut march = March::new(Dense(dimensions), &lattice, exec);
    let mut surface_cells = 0u64;
    for k in 0..dimensions[2] - 1 {
        exec.progress(0.2 * f64::from(k) / f64::from(dimensions[2]));
        for j in 0..dimensions[1] - 1 {
            exec.check()?;
            for i in 0..dimensions[0] - 1 {
                let corner = |c: u32| [i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)];
                let inside = (0..8).filter(|&c| cells.is_full(corner(c).map(i64::from))).count();
                if inside % 8 != 0 {
                    let samples = std::array::from_fn(|c| source.samples().get(lattice.index(corner(c as u32))));
                    march.add_cell([i, j, k], &samples, level)?;
                    surface_cells += 1;
                }
            }
        }
    }
    // Without a surface everything is as far as can be.
    let far = (lattice.bounds().diagonal() + lattice.cell_diagonal()).min(band);
    march.run(band)?;
    let side = |at: usize| cells.is_full(lattice.coordinates(at as u64).map(i64::from));
    let mut values = Vec::with_capacity(march.table.len());
    for at in 0..march.table.len() {
        if at % 4096 == 0 {
            exec.check()?;
        }
        values.push(signed(march.distance(at).min(far), side(at)));
    }
    Ok(Distances { values, surface_cells, not_finite: cells.not_finite })
}

/// Signed distances in a narrow band, as [`Redistance`] has them, from the signs and crossings of another: samples
/// within the background's value of the surface are active, all others have that value with their side. Only bricks
/// that the band meets are touched.
///
/// # Errors
/// A background that is not positive, a lattice too large or small for single precision, too little memory, or the
/// reason to stop.
pub fn redistance_band(source: &SparseBricks, exec: &Exec) -> Result<SparseBricks, ConvertError> {
    exec.check()?;
    let lattice = *source.lattice();
    check_scale(&lattice)?;
    let half_width = source.background();
    let mut result = SparseBricks::try_new(lattice, half_width, Quantity::SignedDistance)?;
    if !(half_width > 0.0 && half_width.is_finite()) {
        let found = f64::from(half_width);
        return Err(crate::VoxelError::Overflow { what: "a half width", found }.into());
    }
    let level = Level { iso: 0.0, inside: shapeloom_isosurface::Inside::Below };
    let dimensions = lattice.dimensions();
    let mut march = March::new(Bricks::default(), &lattice, exec);
    for &key in source.keys() {
        exec.check()?;
        let base = morton::decode(key).map(|at| i64::from(at * SIDE));
        // Cells that begin in this brick, and those that reach into it from bricks that are not stored.
        for step in 0..9i64.pow(3) {
            let cell = [base[0] + step % 9 - 1, base[1] + step / 9 % 9 - 1, base[2] + step / 81 - 1];
            if (0..3).any(|axis| cell[axis] < 0 || cell[axis] + 1 >= i64::from(dimensions[axis])) {
                continue;
            }
            let cell = cell.map(|at| at as u32);
            let own = crate::sparse_bricks::key_of(cell);
            if own != key && source.keys().binary_search(&own).is_ok() {
                continue;
            }
            let samples: [f32; 8] =
                std::array::from_fn(|c| source.sample(std::array::from_fn(|axis| cell[axis] + (c >> axis & 1) as u32)));
            let inside = samples.iter().filter(|&&sample| level.holds(sample)).count();
            if inside % 8 != 0 {
                march.add_cell(cell, &samples, level)?;
            }
        }
    }
    march.run(f64::from(half_width))?;
    let places = &march.table.places;
    let mut keys: Vec<u64> = source.keys().iter().copied().chain(places.keys().copied()).collect();
    keys.sort_unstable();
    keys.dedup();
    let _memory = exec.reserve_elements(keys.len() as u64, 2 * SparseBricks::BRICK_BYTES)?;
    for key in keys {
        exec.check()?;
        let before = source.filled(key);
        let mut filled = Filled { key, values: [half_width; BRICK], mask: [0; 8] };
        for (_, at) in samples_of(key, dimensions) {
            let distance = places.get(&key).map_or(f64::INFINITY, |place| march.distance(place * BRICK + at));
            let cut = distance.min(f64::from(half_width));
            filled.values[at] = signed(cut, level.holds(before.values[at]));
            filled.mask[at / 64] |= u64::from((cut as f32) < half_width) << (at % 64);
        }
        result.push(filled);
    }
    Ok(result)
}
