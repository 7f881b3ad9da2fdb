//! The teapot to cells: all that its surface meets, the thinnest that hold water, and solid by their centres.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::io::{ReadContext, format_by_id, read};
use shapeloom::parametric::TessellatePatches;
use shapeloom::render::{Picture, Scene};
use shapeloom::shape::Geometry;
use shapeloom::voxels::{CellRule, VoxelizeMesh, VoxelizeMode};
use shapeloom_examples::{Output, boxes};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let bytes = std::fs::read("data/teapot.bpt")?;
    let shape = read(&bytes, format_by_id("bpt")?, &ReadContext::named("teapot.bpt"))?.shape;
    let Some(Geometry::BezierSurface(teapot)) = shape.parts.first().map(|part| &*part.geometry) else {
        return Err("the teapot is made of patches".into());
    };
    // A parametric surface becomes cells by way of its triangles.
    let mesh = TessellatePatches::new(0.01).convert(teapot)?.value;

    let ways = [
        ("all that the surface meets", VoxelizeMode::Surface, CellRule::Conservative, [0.075, 0.24, 0.48]),
        ("crossed through the centre", VoxelizeMode::Surface, CellRule::Center, [0.45, 0.16, 0.05]),
        ("solid, by the centre", VoxelizeMode::Solid, CellRule::Center, [0.12, 0.33, 0.12]),
    ];
    let mut scene = Scene::default();
    for (n, (words, mode, rule, color)) in ways.into_iter().enumerate() {
        let made = VoxelizeMesh { mode, rule, resolution: 48, ..VoxelizeMesh::new() }.convert(&mesh)?;
        let full = made.report.find("full_cells").unwrap_or(0.0);
        println!(
            "{words}: {full} full cells, {} bytes, deviation {}",
            made.value.memory_bytes(),
            made.report.deviation
        );
        println!("  {}", made.report.basis);
        // Cut open, to see what is inside.
        let middle = made.value.lattice().dimensions()[1] / 2;
        let is_full = |cell: [u32; 3]| cell[1] >= middle && made.value.sample(cell) == 1.0;
        let mut cells = boxes(&made.value, is_full, color);
        let shift = DVec3::X * (n as f64 * 1.08 * made.value.bounds().size().x);
        cells.positions.iter_mut().for_each(|position| *position += shift);
        scene.surfaces.push(cells);
    }
    println!("{}", output.draw("voxelize_mesh", &scene, [-12.0, 25.0], Picture::new())?.display());
    Ok(())
}
