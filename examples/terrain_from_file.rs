//! A mountain from an elevation model: read with its place and unit, drawn with its heights as colours, and kept in other
//! formats of heights with a bound on what they round.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::io::{ReadContext, ReadOptions, WriteContext, detect, format_by_id, read, write};
use shapeloom::mesh::{HeightField, TriangulateHeightField};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::shape::Representation;
use shapeloom_examples::Output;

/// Meadow, forest, rock, snow: heights in metres and linear colours, blended between.
const COLORS: [(f64, [f32; 3]); 5] = [
    (680.0, [0.10, 0.20, 0.06]),
    (1150.0, [0.05, 0.12, 0.04]),
    (1600.0, [0.20, 0.16, 0.11]),
    (2100.0, [0.34, 0.30, 0.27]),
    (2540.0, [0.85, 0.86, 0.90]),
];

fn color(height: f64) -> [f32; 3] {
    let above = COLORS.iter().position(|(from, _)| *from > height).unwrap_or(COLORS.len() - 1).max(1);
    let ((low, dark), (high, light)) = (COLORS[above - 1], COLORS[above]);
    let part = ((height - low) / (high - low)).clamp(0.0, 1.0) as f32;
    [0, 1, 2].map(|channel| dark[channel] + part * (light[channel] - dark[channel]))
}

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/mount_st_helens.dem");
    let bytes = std::fs::read(path)?;
    let mountain = read(&bytes, detect(&bytes, Some(path))?, &ReadContext::named("mount_st_helens.dem"))?;
    mountain.findings.iter().for_each(|finding| println!("{finding}"));
    let field = HeightField::from_geometry(&mountain.shape.parts[0].geometry)?;
    println!("{}: {} x {} samples", mountain.shape.parts[0].name, field.columns(), field.rows());

    let converted = TriangulateHeightField::new().convert(field)?;
    let mesh = converted.value;
    println!("{} triangles, error {}", mesh.triangles().len(), converted.report.deviation);
    let summit = mesh.positions().iter().copied().max_by(|a, b| a.z.total_cmp(&b.z)).unwrap_or(DVec3::ZERO);
    println!("summit: {} m at {} east, {} north", summit.z, summit.x, summit.y);
    let colors = mesh.positions().iter().map(|point| color(point.z)).collect();
    let surface = SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec());
    let scene = Scene { surfaces: vec![SceneMesh { colors: Some(colors), ..surface }] };
    println!("{}", output.draw("terrain_from_file", &scene, [155.0, 32.0], Picture::new())?.display());

    for id in ["asc", "png"] {
        let mut kept = Vec::new();
        let report = write(&mountain.shape, format_by_id(id)?, &WriteContext::default(), &mut kept)?;
        let name = format!("mountain.{id}");
        println!("{}: {} bytes, heights {}", output.write(&name, &kept)?.display(), kept.len(), report.deviation);
        report.losses.iter().for_each(|loss| println!("  lost: {loss}"));
    }
    // Of a picture that says nothing of heights the caller does.
    let grey = b"P2 3 2 9\n0 4 9\n0 2 3\n";
    let options = ReadOptions { height: 120.0, spacing: 30.0, ..ReadOptions::new() };
    let picture = read(grey, format_by_id("pgm")?, &ReadContext { options, ..ReadContext::default() })?;
    println!("a picture of 3 x 2 pixels: {:?}", picture.shape.bounds());
    Ok(())
}
