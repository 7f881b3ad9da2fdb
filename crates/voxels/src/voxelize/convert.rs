//! Meshes to full and empty cells.

use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Place, Report, Severity, choice,
    options, parallel,
};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::TriMesh;

use super::cells::Cells;
use crate::losses::of_mesh;
use crate::mesh_distance::{Bins, InCells, distances_in_cells, lost_cells};
use crate::{Quantity, Samples, VoxelGrid, cubes};

choice! {
    /// What of a mesh is made of voxels.
    pub enum VoxelizeMode {
        /// Its triangles.
        Surface = "surface",
        /// Its triangles and what they enclose.
        Solid = "solid",
    }
}

choice! {
    /// When a cell is full.
    pub enum CellRule {
        /// When its closed cube meets the shape.
        Conservative = "conservative",
        /// When its centre is in the shape; for a surface, when it crosses one of the three lines that join the middles of
        /// opposite faces.
        Center = "center",
    }
}

options! {
    /// Full and empty cells from triangles.
    ///
    /// Cells are cubes around samples, half a step to each side. With the rule `conservative` a cell is full when its closed cube meets
    /// a triangle (separating axes, Akenine-Möller 2001): rounding never loses one, and adds none that is farther than some 1e-13 of the
    /// coordinates. Solids are filled where the winding number of a cell's centre is above 1/2, as [`MeshToDistance`](crate::MeshToDistance)
    /// tells it. With the rule `center` a solid is the cells whose centre is inside; a surface is the cells where it crosses a line
    /// through the centre parallel to an axis, decided exactly: the thinnest set of cells that no path over faces leaks through (Laine
    /// 2013, A topological approach to voxelization; for surfaces that are closed).
    ///
    /// Deviation: of the surface where the trilinear interpolant of full (1) and empty (0) is a half. It is bounded where every cell
    /// that the mesh passes is checked to have a cell of the other sort beside it, and the solid is closed; else unknown.
    ///
    /// Memory: a bit a sample and 28 bytes a triangle; solids take 4 bytes a sample more meanwhile. Cost: for each triangle the cells in its
    /// box near its plane, some 20 ns each; solids cost as distances with a band of 2.
    ///
    /// Errors: as [`MeshToDistance`](crate::MeshToDistance).
    pub struct VoxelizeMesh("voxelize-mesh") {
        required {}
        optional {
            /// The side of a cell, in model units; 0 for what `resolution` says.
            cell_size: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// How many cells the longest side of the box has.
            resolution: u32 [Bounds::closed(1.0, 1e6)] = 128,
            /// How many cells are around the box.
            margin: u32 [Bounds::closed(0.0, 1e6)] = 2,
            /// What is made of voxels.
            mode: VoxelizeMode = VoxelizeMode::Solid,
            /// When a cell is full.
            rule: CellRule = CellRule::Conservative,
        }
    }
}

impl FromTolerance<TriMesh> for VoxelizeMesh {
    /// The tolerance sets nothing: cells as fine as one would like may not fit into memory.
    fn from_tolerance(_: &TriMesh, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<TriMesh> for VoxelizeMesh {
    type Output = VoxelGrid;

    fn convert_with(&self, source: &TriMesh, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        let (lattice, _) = cubes::around_mesh(source, self.cell_size, self.resolution, self.margin)?;
        self.onto(source, lattice, exec)
    }
}

impl VoxelizeMesh {
    /// The cells of a given lattice, which must be cubes along the axes; the options that place a lattice are not used.
    ///
    /// # Errors
    /// Another lattice, or whatever conversion gives.
    pub fn onto(&self, mesh: &TriMesh, lattice: Lattice, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        cubes::check_positions(mesh)?;
        let cell_size = cubes::cell_size_of(&lattice)?;
        let words = lattice.samples().div_ceil(64);
        let _memory = exec.reserve_elements(words, 3 * size_of::<u64>())?;
        let is_solid = self.mode == VoxelizeMode::Solid;
        let solid = match is_solid {
            true => {
                let memory = exec.reserve_elements(lattice.samples(), size_of::<f32>())?;
                let (values, closed) = distances_in_cells(mesh, &lattice, cell_size, 2.0, &exec.part(0.0, 0.6))?;
                Some((values, closed, memory))
            }
            false => None,
        };
        let cells = InCells::new(mesh, &lattice, cell_size, exec)?;
        let bins = Bins::new(&cells, 0.5 + 1e-6, exec)?;
        let [columns, rows, slabs] = lattice.dimensions();
        let blocks = slabs.div_ceil(bins.slabs) as usize;
        let parts = parallel::map_chunks(exec, blocks, 1, |range| {
            let first = range.start as u32 * bins.slabs;
            let mut made = Cells::new([columns, rows], first..(first + bins.slabs).min(slabs));
            for (n, &triangle) in bins.of(range.start).iter().enumerate() {
                if n % 256 == 0 {
                    exec.check()?;
                }
                let corners = cells.corners(triangle);
                match (self.rule, is_solid) {
                    (CellRule::Conservative, _) => made.fill_met(&corners, exec)?,
                    (CellRule::Center, false) => made.fill_crossed(&corners, exec)?,
                    (CellRule::Center, true) => break,
                }
            }
            Ok::<_, ConvertError>(made)
        })?;
        exec.progress(0.9);
        let (mut met, mut count) = (vec![0u64; words as usize], 0);
        for part in parts {
            exec.check()?;
            part.append_to(&mut met, count);
            count += part.count();
        }
        let mut bits = met.clone();
        if let Some((values, ..)) = &solid {
            parallel::fill_chunks(exec, &mut bits, 1 << 10, |first, part| {
                fill_inside(&values[first * 64..], part);
                Ok::<_, ConvertError>(())
            })?;
        }
        let solid = solid.as_ref().map(|(values, closed, _)| (&values[..], *closed));
        let deviation = self.deviation(mesh, &lattice, solid, [&met, &bits], exec)?;
        let report = self.report(mesh, &lattice, solid.map(|(_, closed)| closed), &bits, deviation);
        let grid = VoxelGrid::try_new(lattice, Samples::Bits(bits), Quantity::Occupancy)?;
        exec.progress(1.0);
        Ok(Converted::new(grid, report))
    }

    fn report(
        &self,
        mesh: &TriMesh,
        lattice: &Lattice,
        closed: Option<bool>,
        bits: &[u64],
        (deviation, basis): (Deviation, &str),
    ) -> Report {
        let mut report = Report::new(Self::NAME, deviation, basis);
        report.losses.extend(of_mesh(mesh, "a grid of cells has no attributes"));
        if closed == Some(false) {
            let message = "the mesh is not closed: inside is where its winding number is above 1/2";
            report.findings.push("W-voxels-open", Severity::Note, Place::Whole, message);
        }
        let full: u64 = bits.iter().map(|word| u64::from(word.count_ones())).sum();
        report.figure("cell_size", lattice.spacing().x);
        report.figure("samples", lattice.samples() as f64);
        report.figure("full_cells", full as f64);
        report.figure("full_volume", full as f64 * lattice.placement().determinant().abs());
        report
    }

    /// How far the surface between full and empty cells may be from the mesh, and why. `met` are the cells that the rule finds on the
    /// mesh, `full` those and the inside.
    fn deviation(
        &self,
        mesh: &TriMesh,
        lattice: &Lattice,
        solid: Option<(&[f32], bool)>,
        [met, full]: [&[u64]; 2],
        exec: &Exec,
    ) -> Result<(Deviation, &'static str), ConvertError> {
        if mesh.triangles().is_empty() {
            return Ok((Deviation::Exact, "no surface"));
        }
        if matches!(solid, Some((_, false))) {
            return Ok((Deviation::Unknown, "the mesh is not closed"));
        }
        let bounds = lattice.bounds();
        if !mesh.triangles().as_flattened().iter().all(|&vertex| bounds.contains(mesh.positions()[vertex as usize])) {
            return Ok((Deviation::Unknown, "the mesh leaves the lattice"));
        }
        let diagonal = lattice.cell_diagonal() * (1.0 + 1e-6);
        let lost = "parts of the mesh have no cells of both sorts near: they are as thin as a cell, or lie inside";
        Ok(match (self.rule, solid) {
            (CellRule::Center, None) => {
                (Deviation::Unknown, "a surface may pass the corners of cells that are not full")
            }
            (CellRule::Center, Some((values, _))) => match lost_cells(values, lattice.dimensions(), exec)?.cells {
                0 => (
                    Deviation::AtMost(2.0 * diagonal),
                    "every cell that the mesh may pass has samples of both sorts around it",
                ),
                _ => (Deviation::Unknown, lost),
            },
            (CellRule::Conservative, _) => match any_buried(lattice, met, full, exec)? {
                false => {
                    (Deviation::AtMost(1.5 * diagonal), "every cell that the mesh meets has an empty one beside it")
                }
                true => (Deviation::Unknown, lost),
            },
        })
    }
}

/// Sets the bits of samples whose distance is negative.
fn fill_inside(distances: &[f32], words: &mut [u64]) {
    for (word, part) in words.iter_mut().zip(distances.chunks(64)) {
        for (i, distance) in part.iter().enumerate() {
            *word |= u64::from(*distance < 0.0) << i;
        }
    }
}

/// Whether a cell that the mesh meets has only full cells around it, of the 26 that are there.
fn any_buried(lattice: &Lattice, met: &[u64], full: &[u64], exec: &Exec) -> Result<bool, ConvertError> {
    let dimensions = lattice.dimensions();
    let is_empty = |at: u64| full[(at / 64) as usize] >> (at % 64) & 1 == 0;
    let found = parallel::map_chunks(exec, met.len(), 1 << 12, |range| {
        for word in range {
            let mut left = met[word];
            while left != 0 {
                let cell = lattice.coordinates(word as u64 * 64 + u64::from(left.trailing_zeros()));
                left &= left - 1;
                let around = [0, 1, 2].map(|axis| cell[axis].saturating_sub(1)..(cell[axis] + 2).min(dimensions[axis]));
                let [x, y, z] = around;
                let mut cells = z.flat_map(|k| {
                    y.clone().flat_map({
                        let x = x.clone();
                        move |j| x.clone().map(move |i| [i, j, k])
                    })
                });
                if !cells.any(|cell| is_empty(lattice.index(cell))) {
                    return Ok::<_, ConvertError>(true);
                }
            }
        }
        Ok(false)
    })?;
    Ok(found.contains(&true))
}
