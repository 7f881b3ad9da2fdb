//! Distances from any samples.

use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Report, Reservation, options,
    parallel,
};
use shapeloom_isosurface::{InsideChoice, IsoValue, Level, Slabs};

use super::march::March;
use super::surface::{Sampled, Surface};
use super::{check_scale, distance_grid, spread};
use crate::sparse_bricks::{BRICK, Filled, SIDE, samples_of};
use crate::{Quantity, SparseBricks, VoxelGrid, morton};

options! {
    /// Signed distances to the surface of a grid of anything: negative inside.
    ///
    /// The surface between samples is cut into triangles by marching tetrahedra. Sweeps over the lattice in all orders
    /// hand the cells of these triangles on from sample to sample, each of which keeps the one whose middle is nearest
    /// (Danielsson 1980; Tsai 2002). Then every sample looks at the triangles in that cell and in the 27 around it, goes
    /// on from the nearest, and looks at last in the cells that its neighbours found: its value is the exact distance to
    /// some triangle, so never less than to the nearest, and mostly that. Lattices may be skewed.
    ///
    /// Every sample keeps its side, so no cell gains or loses surface. At the border of the lattice the surface ends:
    /// distances are to what lies inside. Samples that are NaN or infinite are outside, and get finite distances too.
    /// On all threads, with the same bits. Cost: linear in samples. Memory: 8 bytes a sample, and some 200 a triangle while
    /// the surface is found.
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
        let Distances { values, surface_cells, pieces, not_finite } = distances(source, level, band, exec)?;
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
        report.figure("triangles", pieces as f64);
        exec.progress(1.0);
        Ok(Converted::new(distance_grid(lattice, values)?, report))
    }
}

/// Distances at every sample.
pub(super) struct Distances {
    pub values: Vec<f32>,
    pub surface_cells: u64,
    pub pieces: u64,
    pub not_finite: u64,
}

/// A distance with its side, in single precision. Inside is never 0, which would be outside.
fn signed(distance: f32, inside: bool) -> f32 {
    if inside { -distance.max(f32::MIN_POSITIVE) } else { distance }
}

pub(super) fn distances(source: &VoxelGrid, level: Level, band: f64, exec: &Exec) -> Result<Distances, ConvertError> {
    let lattice = *source.lattice();
    check_scale(&lattice)?;
    let _memory = exec.reserve_elements(lattice.samples(), spread::SAMPLE_BYTES)?;
    let (surface, not_finite) = Surface::of(source, level, &exec.part(0.0, 0.2))?;
    // Without a surface everything is as far as can be.
    let far = (lattice.bounds().diagonal() + lattice.cell_diagonal()).min(band);
    let mut values = match surface.cells() {
        0 => vec![far as f32; lattice.samples() as usize],
        _ => spread::distances(&surface, &lattice, far, &exec.part(0.2, 0.95))?,
    };
    parallel::fill_chunks(exec, &mut values, lattice.slab_len(), |first, part| {
        let _memory = exec.reserve_elements(part.len() as u64, size_of::<f32>())?;
        let mut buffer = Vec::new();
        let samples = source.slab((first / lattice.slab_len()) as u32, &mut buffer)?;
        part.iter_mut().zip(samples).for_each(|(value, &sample)| *value = signed(*value, level.holds(sample)));
        Ok::<_, ConvertError>(())
    })?;
    let (surface_cells, pieces) = (surface.cells() as u64, surface.pieces() as u64);
    Ok(Distances { values, surface_cells, pieces, not_finite })
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
    let (mut cells, mut room): (Vec<Sampled>, Vec<Reservation>) = (Vec::new(), Vec::new());
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
                if cells.len() == cells.capacity() {
                    let more = cells.len().max(1 << 10);
                    room.push(exec.reserve_elements(more as u64, size_of::<Sampled>())?);
                    cells.reserve_exact(more);
                }
                cells.push((cell, samples));
            }
        }
    }
    cells.sort_unstable_by_key(|&([i, j, k], _)| [k, j, i]);
    cells.dedup_by_key(|(cell, _)| *cell);
    let surface = Surface::in_cells(&cells, &lattice, level, exec)?;
    drop((cells, room));
    let mut march = March::new(&surface, &lattice, exec)?;
    march.run(f64::from(half_width), lattice.cell_diagonal())?;
    let places = &march.bricks.places;
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
            filled.values[at] = signed(cut as f32, level.holds(before.values[at]));
            filled.mask[at / 64] |= u64::from((cut as f32) < half_width) << (at % 64);
        }
        result.push(filled);
    }
    Ok(result)
}
