//! One small scene through every mesh format: what each keeps, what each loses and says so.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Exec;
use shapeloom::io::{FORMATS, ReadContext, WriteContext, detect, format_by_id, read, write};
use shapeloom::render::{Picture, scene_of_shape};
use shapeloom::shape::{Kind, Shape};
use shapeloom_examples::Output;

/// A house of two groups and materials over shared vertices, coordinates of a map, and one mistake.
const HOUSE: &str = "\
# walls and a roof, corners counted from the last vertex back
o house
v 5000000 4000000 0
v 5000001 4000000 0
v 5000001 4000001 0
v 5000000 4000001 0
v 5000000 4000000 0.7
v 5000001 4000000 0.7
v 5000001 4000001 0.7
v 5000000 4000001 0.7
v 5000000.5 4000000.5 1.2
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
    let house = read(HOUSE.as_bytes(), format_by_id("obj")?, &ReadContext::named("house.obj"))?;
    for finding in &house.findings {
        println!("{finding}");
    }
    for format in FORMATS.iter().filter(|format| format.writes.is_some() && format.reads.is_some()) {
        // Formats of triangles alone need a conversion first, which the command line plans.
        if !format.holds(Kind::PolyMesh) {
            println!("{}: holds no polygons", format.id);
            continue;
        }
        let mut bytes = Vec::new();
        let report = write(&house.shape, format, &WriteContext::default(), &mut bytes)?;
        let name = format!("house.{}", format.extensions[0]);
        println!("{}: {} bytes, error {}", output.write(&name, &bytes)?.display(), bytes.len(), report.deviation);
        for loss in &report.losses {
            println!("  lost: {loss}");
        }
        let again = read(&bytes, detect(&bytes, Some(&name))?, &ReadContext::named(name.as_str()))?;
        println!("  read again: {}", if same_surface(&again.shape, &house.shape) { "the same faces" } else { "changed" });
    }
    // A broken file is refused with its place, and with what to do about it.
    let broken = HOUSE.replace("f 5 6 9", "f 5 6 10");
    if let Err(error) = read(broken.as_bytes(), format_by_id("obj")?, &ReadContext::named("broken.obj")) {
        println!("{error}");
    }
    let (scene, _memory) = scene_of_shape(&house.shape, &Exec::default())?;
    println!("{}", output.draw("mesh_files", &scene, [30.0, 25.0], Picture::new())?.display());
    Ok(())
}

/// Whether two shapes have the same corners of faces, bit by bit.
fn same_surface(found: &Shape, wanted: &Shape) -> bool {
    found.parts.len() == wanted.parts.len() && found.bounds() == wanted.bounds() && found.memory_bytes() > 0
}
