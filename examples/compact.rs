//! The teapot in few bits: how far vertices move, and how many bits they take, beside theory.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::io::{ReadContext, format_by_id, read};
use shapeloom::mesh::{Compact, TriMesh};
use shapeloom::parametric::{BezierSurface, TessellatePatches};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::shape::Representation;
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let bytes = std::fs::read("data/teapot.bpt")?;
    let shape = read(&bytes, format_by_id("bpt")?, &ReadContext::named("teapot.bpt"))?.shape;
    let surface = BezierSurface::from_geometry(&shape.parts[0].geometry)?;
    let teapot = TessellatePatches::new(0.004).convert(surface)?.value;
    let (vertices, triangles) = (teapot.positions().len(), teapot.triangles().len());
    println!("the teapot: {vertices} vertices, {triangles} triangles");

    let before = (size_of_val(teapot.positions()) + size_of_val(teapot.triangles())) as f64;
    let mut scene = Scene::default();
    for (bits, aside) in [(5, 0.0), (7, 5.5), (12, 11.0)] {
        let packed = Compact::new(bits).pack(&teapot, &Exec::default())?;
        let (store, report) = (packed.value, packed.report);
        let theory = 3 * bits + 6 * store.index_bits();
        println!("{bits} bits: error {}", report.deviation);
        println!(
            "  {:.2} bits a vertex, {theory} for two triangles a vertex",
            report.find("bits_a_vertex").unwrap_or(0.0)
        );
        println!("  {} bytes, 1 in {:.1} of the mesh's", store.memory_bytes(), before / store.memory_bytes() as f64);
        println!("  vertex 100 at {:?}, triangle 100 is {:?}", store.position(100), store.triangle(100));
        report.findings.iter().for_each(|finding| println!("  {finding}"));
        let back = TriMesh::from(&store);
        let moved = back.positions().iter().map(|&position| position + DVec3::X * aside).collect();
        scene.surfaces.push(SceneMesh::new(moved, back.triangles().to_vec()));
    }
    let look = Picture { mode: Mode::Flat, ..Picture::new() };
    println!("{}", output.draw("compact", &scene, [0.0, 25.0], look)?.display());
    Ok(())
}
