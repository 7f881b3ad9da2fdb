//! Grids of signed distances from formulas, and how they are shown.

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::isosurface::Lattice;
use shapeloom::mesh::TriangulatePolygons;
use shapeloom::render::SceneMesh;
use shapeloom::voxels::{CellFaces, Quantity, Samples, VoxelGrid};

/// A function sampled on a cubic lattice of `count` samples a side around the origin, `half` to each side.
///
/// # Errors
/// Numbers that make no lattice.
pub fn sampled(count: u32, half: f64, value: impl Fn(DVec3) -> f64) -> Result<VoxelGrid, Box<dyn Error>> {
    let spacing = 2.0 * half / f64::from(count - 1);
    let lattice = Lattice::along_axes([count; 3], DVec3::splat(-half), DVec3::splat(spacing))?;
    let at = |at: u64| value(lattice.position(lattice.coordinates(at))) as f32;
    let samples = Samples::F32((0..lattice.samples()).map(at).collect());
    Ok(VoxelGrid::try_new(lattice, samples, Quantity::SignedDistance)?)
}

/// The faces of a grid's full cells, moved and coloured.
///
/// # Errors
/// A grid that has no faces to show.
pub fn blocks(grid: &VoxelGrid, shift: DVec3, color: [f32; 3]) -> Result<SceneMesh, Box<dyn Error>> {
    let faces = CellFaces { merge: true, ..CellFaces::new() }.convert(grid)?.value;
    let mesh = TriangulatePolygons::new().convert(&faces)?.value;
    let positions = mesh.positions().iter().map(|&position| position + shift).collect();
    Ok(SceneMesh { color, ..SceneMesh::new(positions, mesh.triangles().to_vec()) })
}
