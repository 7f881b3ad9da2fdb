//! Meshes to signed distances on a lattice.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Report, Reservation,
    Severity, choice, options, parallel,
};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::TriMesh;
use shapeloom_spatial::is_closed;

use super::band::{self, Block};
use super::bins::Bins;
use super::closing::closing;
use super::clusters::Clusters;
use super::fast_sweeping::{self, FAR};
use super::in_cells::InCells;
use super::open_signs::{OpenSigns, Samples as OpenSamples};
use super::rows::Rows;
use super::thin;
use crate::cubes;
use crate::losses::of_mesh;
use crate::{Quantity, Samples, VoxelGrid};

choice! {
    /// What samples hold that are farther from the surface than the band.
    pub enum FarField {
        /// About the distance, by fast sweeping.
        Sweep = "sweep",
        /// The width of the band.
        Clamp = "clamp",
    }
}

options! {
    /// Signed distances to triangles, on a lattice of cubes around them.
    ///
    /// Within the band each sample has the distance to the nearest triangle, correctly rounded to single precision but for one unit in
    /// the last place; beyond it about the distance (fast sweeping, Zhao 2005), or the width of the band. Samples are negative where the
    /// generalised winding number (Jacobson, Kavan, Sorkine-Hornung 2013) is above 1/2, so meshes with holes, overlaps and duplicate
    /// faces have an inside too. Where the mesh is closed that is decided exactly, by counting crossings along rows of samples; else so
    /// for the mesh and triangles that close it, whose own winding number is then taken off, with proven bounds; only rounding of some
    /// 1e-13 may leave it open. Samples nearer to the surface than 1e-9 of a cell are on it: they are 0.
    ///
    /// Deviation: the zero set of the trilinear interpolant lies within half a cell's diagonal of a closed mesh. The mesh lies within two
    /// diagonals of the zero set if the report says so: that is checked for each cell. Parts thinner than a cell have no sample in them
    /// and vanish; the deviation is then unknown, as it is for meshes that are not closed, where the zero set also closes the holes.
    ///
    /// Memory: 4 bytes a sample for the result, a quarter of a byte a sample meanwhile, 28 bytes a triangle, and for each thread 8 MiB; for
    /// meshes that are not closed 150 bytes a triangle more, and up to 800 for each side of the boundary. Cost: for each triangle the samples
    /// in its band, about a microsecond for a small one and a band of 3; sweeping takes 110 ns a sample, shared by all threads. Signs of meshes
    /// that are not closed take a second or two on 256³ samples, also with thousands of holes, but microseconds a sample where
    /// triangles that bound nothing fill the space or half of a surface is missing.
    ///
    /// Errors: positions that are not finite; cells smaller than 1e-30 or larger than 1e30, where squares leave single precision; too little
    /// memory in the budget.
    pub struct MeshToDistance("mesh-to-distance") {
        required {}
        optional {
            /// The side of a cell, in model units; 0 for what `resolution` says.
            cell_size: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// How many cells the longest side of the box has.
            resolution: u32 [Bounds::closed(1.0, 1e6)] = 128,
            /// How many cells are around the box.
            margin: u32 [Bounds::closed(0.0, 1e6)] = 3,
            /// Up to how many cells from the surface distances are exact.
            band: f64 [Bounds::closed(2.0, 1e3)] = 3.0,
            /// What samples beyond the band hold.
            far: FarField = FarField::Sweep,
        }
    }
}

impl FromTolerance<TriMesh> for MeshToDistance {
    /// The tolerance sets nothing: cells as fine as one would like may not fit into memory.
    fn from_tolerance(_: &TriMesh, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<TriMesh> for MeshToDistance {
    type Output = VoxelGrid;

    fn convert_with(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        let (lattice, _) = cubes::around_mesh(source, self.cell_size, self.resolution, self.margin)?;
        self.onto(source, lattice, exec)
    }
}

impl MeshToDistance {
    /// The distances at the samples of a given lattice, whose cells must be cubes along the axes; the options that place a lattice are
    /// not used. Where the mesh leaves the lattice the deviation is unknown.
    ///
    /// # Errors
    /// Another lattice, or whatever conversion gives.
    pub fn onto(&self, mesh: &TriMesh, lattice: Lattice, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        cubes::check_positions(mesh)?;
        let cell_size = cubes::cell_size_of(&lattice)?;
        let _memory = exec.reserve_elements(lattice.samples(), size_of::<f32>())?;
        let (mut values, closed) = distances_in_cells(mesh, &lattice, cell_size, self.band, exec)?;
        let report = self.report(mesh, &lattice, &values, closed, &exec.part(0.6, 0.7))?;
        let beyond = self.band as f32;
        let exec = exec.part(0.7, 1.0);
        if self.far == FarField::Sweep && !mesh.triangles().is_empty() {
            fast_sweeping::sweep(&mut values, lattice.dimensions(), beyond * (1.0 + 1e-6), &exec)?;
        }
        let clamp = self.far == FarField::Clamp;
        let is_empty = mesh.triangles().is_empty();
        parallel::fill_chunks(&exec, &mut values, 1 << 16, |_, part| {
            for value in part {
                let cells = match *value {
                    far if clamp && far.abs() > beyond => beyond.copysign(far),
                    _ if is_empty => f32::INFINITY,
                    near => near,
                };
                *value = (f64::from(cells) * cell_size) as f32;
            }
            Ok::<_, ConvertError>(())
        })?;
        exec.progress(1.0);
        let grid = VoxelGrid::try_new(lattice, Samples::F32(values), Quantity::SignedDistance)?;
        Ok(Converted::new(grid, report))
    }

    fn report(
        &self,
        mesh: &TriMesh,
        lattice: &Lattice,
        values: &[f32],
        closed: bool,
        exec: &Exec,
    ) -> Result<Report, ConvertError> {
        let lost = match closed && !mesh.triangles().is_empty() {
            true => thin::lost_cells(values, lattice.dimensions(), exec)?,
            false => thin::Lost::default(),
        };
        let bounds = lattice.bounds();
        let held =
            mesh.triangles().as_flattened().iter().all(|&vertex| bounds.contains(mesh.positions()[vertex as usize]));
        let diagonal = lattice.cell_diagonal();
        let (deviation, basis) = if mesh.triangles().is_empty() {
            (Deviation::Exact, "no surface")
        } else if !closed {
            (Deviation::Unknown, "the mesh is not closed: distances jump where the winding number passes 1/2")
        } else if !held {
            (Deviation::Unknown, "the mesh leaves the lattice")
        } else if lost.cells > 0 {
            (Deviation::Unknown, "parts of the mesh have no zero set near: they are thinner than a cell")
        } else {
            let basis = "every cell that the mesh may pass has corners on both sides, or a cell beside it has: two diagonals of a cell";
            (Deviation::AtMost(2.0 * diagonal * (1.0 + 1e-6)), basis)
        };
        let mut report = Report::new(Self::NAME, deviation, basis);
        report.losses.extend(of_mesh(mesh, "a grid of distances has no attributes"));
        if !closed {
            let message = "the mesh is not closed: inside is where its winding number is above 1/2";
            report.findings.push("W-voxels-open", Severity::Note, Place::Whole, message);
        }
        if closed && held && lost.cells > 0 {
            let at = lost.first.map_or(0, |cell| lattice.index(cell));
            let message = "cells that the mesh may pass have only samples of one side around them: what is thinner than a cell, \
                           or has faces that look inward, is lost";
            report.findings.push_many(
                "W-voxels-lost",
                Severity::Warning,
                Place::element("sample", at),
                message,
                lost.cells,
            );
        }
        report.figure("cell_size", lattice.spacing().x);
        report.figure("samples", lattice.samples() as f64);
        let near = parallel::map_chunks(exec, values.len(), 1 << 16, |range| {
            Ok::<_, ConvertError>(values[range].iter().filter(|value| value.abs() < FAR).count() as u64)
        })?;
        let inside = parallel::map_chunks(exec, values.len(), 1 << 16, |range| {
            Ok::<_, ConvertError>(values[range].iter().filter(|&&value| value < 0.0).count() as u64)
        })?;
        if !mesh.triangles().is_empty() && inside.iter().all(|&count| count == 0) {
            let message = "no sample is inside: the mesh encloses nothing, or only what is thinner than a cell";
            report.findings.push("W-voxels-nothing", Severity::Warning, Place::Whole, message);
        }
        report.figure("band_samples", near.iter().sum::<u64>() as f64);
        report.figure("lost_cells", lost.cells as f64);
        if closed && held && !mesh.triangles().is_empty() {
            report.figure("zero_set_to_mesh", 0.5 * diagonal);
        }
        Ok(report)
    }
}

/// The square of the distance, in cells, below which a sample counts as on the surface: rounding decides nothing there, so that a
/// box whose faces lie on samples has no crumbs along its edges.
const TOUCHING: f32 = 1e-18;

/// Signed distances in cells, [`FAR`] beyond the band, and whether the mesh is closed.
pub(crate) fn distances_in_cells(
    mesh: &TriMesh,
    lattice: &Lattice,
    cell_size: f64,
    band: f64,
    exec: &Exec,
) -> Result<(Vec<f32>, bool), ConvertError> {
    let closed = is_closed(mesh.positions(), mesh.triangles(), exec)?;
    exec.progress(0.05);
    let cells = InCells::new(mesh, lattice, cell_size, exec)?;
    let reach = band * (1.0 + 1e-7);
    let bins = Bins::new(&cells, reach, exec)?;
    let open = match closed {
        true => None,
        false => Some(Open::new(&cells, exec)?),
    };
    exec.progress(0.1);
    let mut values = vec![0f32; lattice.samples() as usize];
    let limit = (band * band * (1.0 + 1e-6)) as f32;
    let whole = exec.part(0.1, 0.6);
    let [columns, rows, slabs] = cells.dimensions;
    parallel::fill_chunks(exec, &mut values, lattice.slab_len() * bins.slabs as usize, |first, part| {
        let first_slab = (first / lattice.slab_len()) as u32;
        let depth = (part.len() / lattice.slab_len()) as u32;
        let room = Block::room([columns, rows], depth);
        let _memory = exec.reserve_elements(room + part.len() as u64, size_of::<f32>())?;
        let mut block = Block::new([columns, rows], first_slab, depth, limit);
        let mut changes = vec![0i32; part.len()];
        let along = Rows { axis: 0, offset: 0.0, count: columns, across: [0..rows, first_slab..first_slab + depth] };
        let mut left = bins.of((first_slab / bins.slabs) as usize);
        while !left.is_empty() {
            exec.check()?;
            let (members, rest) = left.split_at(cells.quick(left, reach, depth));
            left = rest;
            band::lower(&mut block, &cells, members, reach);
            members.iter().for_each(|&triangle| count(&along, &cells.corners(triangle), &mut changes));
        }
        if let Some(open) = &open {
            for members in open.bins.of((first_slab / bins.slabs) as usize).chunks(512) {
                exec.check()?;
                members.iter().for_each(|&at| count(&along, &open.clusters.triangles[at as usize], &mut changes));
            }
        }
        for (row, values) in part.chunks_mut(columns as usize).enumerate() {
            let (j, k) = (row as u32 % rows, row as u32 / rows + first_slab);
            for (value, &squared) in values.iter_mut().zip(block.row(j, k)) {
                *value = match squared {
                    on_it if on_it < TOUCHING => 0.0,
                    near if near < limit => near.sqrt(),
                    _ => FAR,
                };
            }
            let mut winding = 0i32;
            let changes = &mut changes[row * columns as usize..(row + 1) * columns as usize];
            for (value, change) in values.iter_mut().zip(changes) {
                winding += *change;
                *change = winding;
                *value = if closed && winding > 0 && *value > 0.0 { -*value } else { *value };
            }
        }
        if let Some(open) = &open {
            let (columns, rows, first_slab) = (columns as usize, rows as usize, first_slab as usize);
            let mut samples = OpenSamples { values: part, windings: &changes, columns, rows, first_slab };
            OpenSigns { mesh: &cells, closing: &open.clusters }.give(&mut samples, exec)?;
        }
        whole.progress(f64::from(first_slab + depth) / f64::from(slabs));
        Ok::<_, ConvertError>(())
    })?;
    Ok((values, closed))
}

/// Adds a triangle's crossings with rows to the changes of winding numbers from sample to sample.
fn count(along: &Rows, corners: &[DVec3; 3], changes: &mut [i32]) {
    let [rows, slabs] = &along.across;
    along.cross(corners, |crossing| {
        if crossing.first_beyond < along.count {
            let row = (crossing.row[1] - slabs.start) as usize * rows.len() + crossing.row[0] as usize;
            changes[row * along.count as usize + crossing.first_beyond as usize] += crossing.change;
        }
    });
}

/// What signs of a mesh that is not closed need.
struct Open {
    /// The triangles that close it.
    clusters: Clusters,
    bins: Bins,
    _memory: Reservation,
}

impl Open {
    fn new(cells: &InCells<'_>, exec: &Exec) -> Result<Self, ConvertError> {
        let closing = closing(cells, exec)?;
        let memory = exec.reserve_elements(closing.len() as u64, 9 * size_of::<f64>())?;
        let corners = closing.iter().map(|triangle| triangle.map(|vertex| cells.positions[vertex as usize]));
        let clusters = Clusters::new(corners.collect(), exec)?;
        let bins = Bins::of_corners(&clusters.triangles, cells.dimensions, 0.0, exec)?;
        Ok(Self { clusters, bins, _memory: memory })
    }
}
