//! Triangles in the coordinates of a lattice.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec, Reservation, parallel};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::TriMesh;

use crate::VoxelError;

/// A mesh in lattice coordinates: the step between samples is 1, and samples are at whole numbers.
///
/// Each vertex is mapped once, so triangles that meet in a mesh meet here too, bit for bit.
pub(crate) struct InCells<'a> {
    pub positions: Vec<DVec3>,
    pub triangles: &'a [[u32; 3]],
    pub dimensions: [u32; 3],
    _memory: Reservation,
}

/// Coordinates below this are zero: products of them would underflow in exact predicates.
const TINY: f64 = 1e-60;

/// Triangles farther than so many cells from the first sample have no places in double precision that tell cells apart.
const FARTHEST: f64 = 1e14;

impl<'a> InCells<'a> {
    /// Maps the vertices of a mesh into a lattice along the axes with cubic cells.
    pub fn new(mesh: &'a TriMesh, lattice: &Lattice, cell_size: f64, exec: &Exec) -> Result<Self, ConvertError> {
        let memory = exec.reserve_elements(mesh.positions().len() as u64, size_of::<DVec3>())?;
        let mut positions = vec![DVec3::ZERO; mesh.positions().len()];
        let origin = lattice.placement().translation;
        parallel::fill_chunks(exec, &mut positions, 1 << 14, |first, part| {
            for (position, cell) in mesh.positions()[first..].iter().zip(part) {
                let at = (*position - origin) / cell_size;
                *cell = DVec3::from_array(at.to_array().map(|x| if x.abs() < TINY { 0.0 } else { x }));
            }
            Ok::<_, ConvertError>(())
        })?;
        let is_far = |position: &DVec3| position.abs().max_element() > FARTHEST;
        if positions.iter().any(is_far) {
            let named = mesh.triangles().as_flattened().iter().map(|&vertex| positions[vertex as usize]);
            if let Some(far) = named.into_iter().find(is_far) {
                let cells = far.abs().max_element();
                let expected = "every vertex within some 1e14 cells of the lattice";
                return Err(VoxelError::CellSize { found: cell_size, cells, expected }.into());
            }
        }
        Ok(Self { positions, triangles: mesh.triangles(), dimensions: lattice.dimensions(), _memory: memory })
    }

    /// How many of the first triangles are scanned in a few milliseconds together, in so many slabs: one at least.
    pub fn quick(&self, triangles: &[u32], reach: f64, slabs: u32) -> usize {
        let [columns, rows, _] = self.dimensions.map(f64::from);
        let most = DVec3::new(columns, rows, f64::from(slabs));
        let mut left = 2e5;
        for (count, &triangle) in triangles.iter().enumerate().take(512) {
            let [a, b, c] = self.corners(triangle);
            let size = (a.max(b).max(c) - a.min(b).min(c) + (2.0 * reach + 1.0)).min(most);
            left -= size.x * size.y * size.z;
            if left < 0.0 {
                return count.max(1);
            }
        }
        triangles.len().min(512)
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize])
    }
}
