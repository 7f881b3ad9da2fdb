//! Curvature flow: a ball beside its closed form, dense and in a narrow band, and a rough solid that becomes smooth.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::isosurface::{Inside, Level};
use shapeloom::render::{Picture, Scene};
use shapeloom::voxels::{
    CurvatureFlow, GridField, Interpolation, Redistance, SparseBricks, VoxelGrid, curvature_flow_band,
};
use shapeloom_examples::{Output, blocks, sampled};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    let ball = sampled(48, 1.0, |p| p.length() - 0.7)?;
    let band = SparseBricks::narrow_band(&ball, 0.25, &exec)?;
    println!("{} bytes as a grid, {} as a band", ball.memory_bytes(), band.memory_bytes());
    for time in [0.03, 0.06, 0.09] {
        let wanted = (0.49f64 - 4.0 * time).sqrt();
        let dense = radius(&CurvatureFlow::new(time).convert(&ball)?.value)?;
        let sparse = radius(&curvature_flow_band(&band, time, 0.9, &exec)?.to_grid(&exec)?)?;
        println!("after {time}: radius {wanted:.4}, found {dense:.4} on the grid, {sparse:.4} in the band");
    }

    let rough = |p: DVec3| {
        let bumps = (9.0 * p.x).sin() * (11.0 * p.y).sin() * (10.0 * p.z).sin();
        p.x.abs().max(p.y.abs()).max(p.z.abs()) - 0.65 + 0.12 * bumps
    };
    let rough = Redistance::new().convert(&sampled(56, 1.0, rough)?)?.value;
    let mut scene = Scene::default();
    for (place, time) in [0.0, 0.004, 0.03].into_iter().enumerate() {
        let smooth = CurvatureFlow::new(time).convert(&rough)?.value;
        scene.surfaces.push(blocks(&smooth, DVec3::X * 1.7 * (place as f64 - 1.0), [0.85, 0.6, 0.35])?);
    }
    println!("{}", output.draw("curvature_flow", &scene, [20.0, 25.0], Picture::new())?.display());
    Ok(())
}

/// Where the surface crosses the first axis.
fn radius(grid: &VoxelGrid) -> Result<f64, Box<dyn Error>> {
    let level = Level { iso: 0.0, inside: Inside::Below };
    let field = GridField::try_new(grid, level, Interpolation::Tricubic, &Exec::default())?;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let middle = (low + high) / 2.0;
        let inside = shapeloom::core::Field::value(&field, DVec3::X * middle) < 0.0;
        (low, high) = if inside { (middle, high) } else { (low, middle) };
    }
    Ok(low)
}
