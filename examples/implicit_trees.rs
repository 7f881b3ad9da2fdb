//! The teapot as a field: a hull around it cut open, with a ring and a handle of curves in one tree with it.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::sync::Arc;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec, Field};
use shapeloom::implicit::{CurveDistance, Program, Tree};
use shapeloom::io::{ReadContext, format_by_id, read};
use shapeloom::isosurface::{FieldSlabs, Lattice, ManifoldSurfaceNets};
use shapeloom::parametric::{BezierSurface, TessellatePatches};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::shape::Representation;
use shapeloom::spatial::SignedDistance;
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/teapot.bpt");
    let file = read(&std::fs::read(path)?, format_by_id("bpt")?, &ReadContext::named("teapot.bpt"))?.shape;
    let mesh = TessellatePatches::new(0.005).convert(BezierSurface::from_geometry(&file.parts[0].geometry)?)?.value;
    let distance = SignedDistance::build(mesh.positions(), mesh.triangles(), &Exec::default())?;
    let teapot = Tree::foreign("mesh(\"teapot.bpt\")", Arc::new(distance), false).named("teapot");

    // All points within 0.12 of the surface, seen where the front half is taken away.
    let hull = teapot.clone().shell(0.24).difference(Tree::plane(DVec3::Y, 0.0));
    // A generalised cylinder about two Bézier pieces, and a ring, joined softly.
    let arch = [
        vec![DVec3::new(-2.2, 0.0, 3.2), DVec3::new(-2.4, 0.0, 4.6), DVec3::new(0.0, 0.0, 4.8)],
        vec![DVec3::new(0.0, 0.0, 4.8), DVec3::new(2.4, 0.0, 5.0), DVec3::new(2.2, 0.0, 3.2)],
    ];
    let arch = Tree::foreign("arch", Arc::new(CurveDistance::try_new(&arch, 0.13, 1e-3)?), false);
    let ring = Tree::torus(2.3, 0.16).translate(0.0, 0.0, 3.0);
    let handle = arch.smooth_union(ring, 0.5).named("handle");
    let whole = Tree::union_of([hull, handle.clone()]);
    for (name, tree) in [("teapot", &teapot), ("handle", &handle), ("whole", &whole)] {
        let program = tree.compile()?;
        println!("{name}: {} nodes, {} steps, {}", tree.node_count(), program.len(), tree.nature().meaning().name());
    }

    let program = whole.compile()?;
    let side = output.width / 3;
    let step = 7.6 / f64::from(side - 1);
    let lattice = Lattice::along_axes([side; 3], DVec3::new(-3.8, -3.8, -1.5), DVec3::splat(step))?;
    let mesh = ManifoldSurfaceNets::new().convert(&FieldSlabs::new(&program, lattice))?.value;
    println!(
        "{} triangles; largest value at a vertex {:.4}",
        mesh.triangles().len(),
        largest(&program, mesh.positions())
    );
    let scene = Scene { surfaces: vec![SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec())] };
    println!("{}", output.draw("implicit_trees", &scene, [70.0, 20.0], Picture::new())?.display());
    Ok(())
}

fn largest(field: &Program, points: &[DVec3]) -> f64 {
    points.iter().map(|&point| field.value(point).abs()).fold(0.0, f64::max)
}
