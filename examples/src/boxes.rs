//! Cells drawn as boxes.

use shapeloom::core::glam::DVec3;
use shapeloom::render::SceneMesh;
use shapeloom::voxels::VoxelGrid;

/// The faces of cells that are kept, where the cell on their other side is not, in one colour.
pub fn boxes(grid: &VoxelGrid, keep: impl Fn([u32; 3]) -> bool, color: [f32; 3]) -> SceneMesh {
    let lattice = grid.lattice();
    let dimensions = lattice.dimensions();
    let steps = lattice.steps();
    let mut mesh = SceneMesh { color, ..SceneMesh::new(Vec::new(), Vec::new()) };
    for at in 0..lattice.samples() {
        let cell = lattice.coordinates(at);
        if !keep(cell) {
            continue;
        }
        let center = lattice.position(cell);
        for axis in 0..3 {
            for up in [false, true] {
                let mut beside = cell;
                beside[axis] = if up { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
                if beside[axis] < dimensions[axis] && keep(beside) {
                    continue;
                }
                let side = if up { 0.5 } else { -0.5 };
                let (u, v) = (steps[(axis + 1) % 3] * 0.5, steps[(axis + 2) % 3] * side);
                let corner = |s: f64, t: f64| center + steps[axis] * side + u * s + v * t;
                let first = mesh.positions.len() as u32;
                let corners: [DVec3; 4] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
                mesh.positions.extend(corners);
                mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
        }
    }
    mesh.edges = Some([[true, true, false], [false, true, true]].repeat(mesh.triangles.len() / 2));
    mesh
}
