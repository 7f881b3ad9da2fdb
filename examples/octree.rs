//! Octrees of full and empty octants: their sizes beside the grid's, set operations, and the octants of a ball.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Exec;
use shapeloom::core::glam::DVec3;
use shapeloom::isosurface::{Inside, Level};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::voxels::{Octree, VoxelGrid};
use shapeloom_examples::{Output, sampled};

const LEVEL: Level = Level { iso: 0.0, inside: Inside::Below };

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    println!("{:>22} {:>9} {:>9} {:>9} {:>9}", "", "nodes", "grid", "tree", "bits");
    for count in [64u32, 128] {
        let spacing = 2.0 / f64::from(count - 1);
        let board = |p: DVec3| {
            let sum = ((p + 1.0) / spacing).round().element_sum() as i64;
            if sum % 2 == 0 { -1.0 } else { 1.0 }
        };
        tell(&format!("ball {count}^3"), &sampled(count, 1.0, |p| p.length() - 0.9)?)?;
        tell(&format!("shell {count}^3"), &sampled(count, 1.0, |p| (p.length() - 0.88).abs() - 0.02)?)?;
        tell(&format!("checkerboard {count}^3"), &sampled(count, 1.0, board)?)?;
    }

    // A ball less a smaller one beside it, cut in half.
    let tree = |value: &dyn Fn(DVec3) -> f64| -> Result<Octree, Box<dyn Error>> {
        Ok(Octree::from_slabs(&sampled(32, 1.0, value)?, LEVEL, &exec)?)
    };
    let ball = tree(&|p| p.length() - 0.95)?;
    let bite = tree(&|p| p.distance(DVec3::new(0.5, 0.0, 0.5)) - 0.45)?;
    let half = tree(&|p| p.y + 0.03)?;
    let bitten = ball.difference(&bite, &exec)?.difference(&half, &exec)?;
    println!("{} cells in {} octants", bitten.full_cells(), bitten.full_octants().len());

    let mut scene = Scene::default();
    for (base, side) in bitten.full_octants() {
        let color = [0.9, 0.75 - 0.08 * side as f32, 0.25 + 0.09 * side as f32];
        scene.surfaces.push(cube(DVec3::from(base.map(f64::from)), f64::from(side) - 0.12, color));
    }
    println!("{}", output.draw("octree", &scene, [-20.0, 20.0], Picture::new())?.display());
    Ok(())
}

fn tell(name: &str, grid: &VoxelGrid) -> Result<(), Box<dyn Error>> {
    let exec = Exec::default();
    let tree = Octree::from_slabs(grid, LEVEL, &exec)?;
    let bits = tree.encode(&exec)?.len();
    let grid = tree.to_grid(&exec)?;
    println!("{name:>22} {:>9} {:>9} {:>9} {bits:>9}", tree.counts().nodes(), grid.memory_bytes(), tree.memory_bytes());
    Ok(())
}

fn cube(base: DVec3, side: f64, color: [f32; 3]) -> SceneMesh {
    let corner = |c: u32| base + DVec3::new(f64::from(c & 1), f64::from(c >> 1 & 1), f64::from(c >> 2)) * side;
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneMesh { color, ..SceneMesh::new((0..8).map(corner).collect(), triangles) }
}
