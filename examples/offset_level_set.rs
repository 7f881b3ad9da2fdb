//! A solid grown and shrunk: volumes beside those that Steiner's formula gives.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::render::{Picture, Scene};
use shapeloom::voxels::{OffsetLevelSet, VoxelGrid};
use shapeloom_examples::{Output, blocks, sampled};

fn cuboid(p: DVec3) -> f64 {
    let q = p.abs() - DVec3::new(0.5, 0.4, 0.3);
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let source = sampled(64, 1.0, cuboid)?;
    let (a, b, c) = (1.0, 0.8, 0.6);
    let mut scene = Scene::default();
    for (place, distance) in [-0.15f64, 0.0, 0.25].into_iter().enumerate() {
        let converted = OffsetLevelSet::new(distance).convert(&source)?;
        let d = distance;
        let wanted = if d < 0.0 {
            (a + 2.0 * d) * (b + 2.0 * d) * (c + 2.0 * d)
        } else {
            let (faces, edges) = (2.0 * (a * b + b * c + c * a) * d, std::f64::consts::PI * (a + b + c) * d * d);
            a * b * c + faces + edges + 4.0 / 3.0 * std::f64::consts::PI * d.powi(3)
        };
        let found = volume(&converted.value);
        println!("by {d:>5}: volume {found:.4}, wanted {wanted:.4}; {}", converted.report.deviation);
        let shift = DVec3::X * 1.55 * (place as f64 - 1.0);
        scene.surfaces.push(blocks(&converted.value, shift, [0.5, 0.65, 0.8])?);
    }
    println!("{}", output.draw("offset_level_set", &scene, [20.0, 25.0], Picture::new())?.display());
    Ok(())
}

/// Each cell counts by how far it lies inside.
fn volume(grid: &VoxelGrid) -> f64 {
    let spacing = grid.lattice().spacing().x;
    let part = |at: u64| (0.5 - f64::from(grid.samples().get(at)) / spacing).clamp(0.0, 1.0);
    (0..grid.lattice().samples()).map(part).sum::<f64>() * spacing.powi(3)
}
