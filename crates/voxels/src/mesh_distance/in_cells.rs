//! Triangles in the coordinates of a lattice.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec, Reservation, parallel};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::TriMesh;

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
        Ok(Self { positions, triangles: mesh.triangles(), dimensions: lattice.dimensions(), _memory: memory })
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|vertex| self.positions[vertex as usize])
    }
}
