//! One small scene through every mesh format: what each keeps, what each loses and says so.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::convert::{Job, Wish, convert_shape};
use shapeloom::core::Exec;
use shapeloom::io::{FORMATS, ReadContext, WriteContext, detect, format_by_id, read, write};
use shapeloom::render::{Picture, scene_of_shape};
use shapeloom::shape::Kind;
use shapeloom_examples::Output;

/// A house of two groups and materials over shared vertices, coordinates of a map, and one mistake.
const HOUSE: &str = "\
# walls and a roof, corners counted from the last vertex back
o house
v 5000000.3 4000000.4 0
v 5000001.3 4000000.4 0
v 5000001.3 4000001.4 0
v 5000000.3 4000001.4 0
v 5000000.3 4000000.4 0.7
v 5000001.3 4000000.4 0.7
v 5000001.3 4000001.4 0.7
v 5000000.3 4000001.4 0.7
v 5000000.8 4000000.9 1.2
g walls
usemtl plaster
f -9 -8 -4 -5
f -8 -7 -3 -4
f -7 -6 -2 -3
f -6 -9 -5 -2
f 1 4 3 2
g roof
usemtl tiles
f 5 6 9
f 6 7 9
f 7 8 9
f 8 5 9
f 9 9 5
";

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let mut house = read(HOUSE.as_bytes(), format_by_id("obj")?, &ReadContext::named("house.obj"))?;
    // What a material library beside the file would say.
    for (material, color) in house.shape.materials.iter_mut().zip([[0.8, 0.7, 0.5, 1.0], [0.6, 0.1, 0.05, 1.0]]) {
        material.base_color = color;
    }
    for finding in &house.findings {
        println!("{finding}");
    }
    for format in FORMATS.iter().filter(|format| format.holds(Kind::TriMesh)) {
        // To what the format holds: nothing to do for polygons where it has them, triangles where it has not.
        let job = Job { wish: Wish::to(format.kinds), tolerance: 0.0, settings: Vec::new() };
        let shape = convert_shape(&house.shape, &job, &Exec::default())?.shape;
        let mut bytes = Vec::new();
        let report = write(&shape, format, &WriteContext::default(), &mut bytes)?;
        let name = format!("house.{}", format.extensions[0]);
        println!("{}: {} bytes, error {}", output.write(&name, &bytes)?.display(), bytes.len(), report.deviation);
        for loss in &report.losses {
            println!("  lost: {loss}");
        }
        let again = read(&bytes, detect(&bytes, Some(&name))?, &ReadContext::named(name.as_str()))?;
        let moved = (again.shape.bounds().max - shape.bounds().max).length();
        println!("  read again: the far corner of its box is {moved:.2e} away");
    }
    // A broken file is refused with its place, and with what to do about it.
    let broken = HOUSE.replace("f 5 6 9", "f 5 6 10");
    if let Err(error) = read(broken.as_bytes(), format_by_id("obj")?, &ReadContext::named("broken.obj")) {
        println!("{error}");
    }
    let job = Job { wish: Wish::to([Kind::TriMesh]), tolerance: 0.0, settings: Vec::new() };
    let triangles = convert_shape(&house.shape, &job, &Exec::default())?.shape;
    let (scene, _memory) = scene_of_shape(&triangles, &Exec::default())?;
    println!("{}", output.draw("mesh_files", &scene, [30.0, 25.0], Picture::new())?.display());
    Ok(())
}
