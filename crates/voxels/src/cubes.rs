//! Lattices of cubes around shapes.

use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::TriMesh;

use crate::VoxelError;

/// The lattice of cubes around the triangles of a mesh, and the size of the cubes: as [`around`] their corners. Vertices that no
/// triangle names have no surface.
pub(crate) fn around_mesh(
    mesh: &TriMesh,
    cell_size: f64,
    resolution: u32,
    margin: u32,
) -> Result<(Lattice, f64), VoxelError> {
    check_positions(mesh)?;
    let corners = mesh.triangles().as_flattened().iter().map(|&vertex| mesh.positions()[vertex as usize]);
    around(&Aabb::from_points(corners), cell_size, resolution, margin)
}

/// Refuses positions that are not finite.
pub(crate) fn check_positions(mesh: &TriMesh) -> Result<(), VoxelError> {
    match mesh.first_non_finite() {
        Some(vertex) => Err(VoxelError::Position { element: vertex as u64 }),
        None => Ok(()),
    }
}

/// The lattice of cubes around a box, and the size of the cubes.
///
/// With a cell size of 0 the longest side of the box has `resolution` cells. Around the box are `margin` cells more, and what is left of
/// a cell is on both sides alike. An empty box and one without size get cells of size 1, or the one asked for.
pub(crate) fn around(
    bounds: &Aabb,
    cell_size: f64,
    resolution: u32,
    margin: u32,
) -> Result<(Lattice, f64), VoxelError> {
    let (center, size) =
        if bounds.is_empty() { (DVec3::ZERO, DVec3::ZERO) } else { (bounds.center(), bounds.max - bounds.min) };
    let longest = size.max_element();
    let cell = match cell_size {
        0.0 if longest > 0.0 => longest / f64::from(resolution.max(1)),
        0.0 => 1.0,
        given => given,
    };
    let wrong = |expected| VoxelError::CellSize { found: cell, cells: longest / cell, expected };
    if !(1e-30..=1e30).contains(&cell) || longest / cell > 1e9 {
        return Err(wrong("a size from 1e-30 to 1e30 and at most 1e9 cells along the shape"));
    }
    // Twice the margin, and a sample more than cells.
    let counts = (size / cell).ceil().to_array().map(|cells| cells as u64 + 2 * u64::from(margin) + 1);
    let dimensions = counts.map(|count| count.min(u64::from(u32::MAX)) as u32);
    let extent = DVec3::from_array(dimensions.map(|count| f64::from(count - 1) * cell));
    let lattice = Lattice::along_axes(dimensions, center - extent * 0.5, DVec3::splat(cell))
        .map_err(|_| wrong("at most 2^40 samples with the margin, and 2^31 in a slab"))?;
    // Far from the origin samples would fall on each other.
    let far = lattice.bounds();
    let ulp = far.min.abs().max(far.max.abs()).max_element() * 2f64.powi(-48);
    match ulp > cell {
        true => Err(wrong("samples that do not fall on each other so far from the origin")),
        false => Ok((lattice, cell)),
    }
}

/// The size of a lattice's cells, which must be cubes along the axes.
pub(crate) fn cell_size_of(lattice: &Lattice) -> Result<f64, VoxelError> {
    let [x, y, z] = lattice.steps();
    let size = x.x;
    let cubes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * size) == [x, y, z];
    if !cubes {
        return Err(VoxelError::NotCubes);
    }
    if !(1e-30..=1e30).contains(&size) {
        return Err(VoxelError::CellSize {
            found: size,
            cells: f64::from(lattice.dimensions().into_iter().max().unwrap_or(0)),
            expected: "a size from 1e-30 to 1e30",
        });
    }
    Ok(size)
}
