//! Implicits to triangles: a machine part, whose edges dual contouring keeps, and Barth's sextic with its 65 nodes.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Aabb, AxisAngle, Convert};
use shapeloom::implicit::{Region, SampledSurface, SurfaceMethod, Tree};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

/// A flange with a collar, a bore, a keyway and six holes.
fn part() -> Result<Tree, Box<dyn Error>> {
    let mut part = Tree::cylinder(1.0, 0.3).union(Tree::cylinder(0.5, 0.9).translate(0.0, 0.0, 0.45));
    part = part.difference(Tree::cylinder(0.3, 4.0)).difference(Tree::cuboid(0.2, 0.4, 4.0).translate(0.0, 0.25, 0.0));
    for k in 0..6 {
        let turn = AxisAngle::new(DVec3::Z, f64::from(k) * std::f64::consts::FRAC_PI_3)?;
        part = part.difference(Tree::cylinder(0.12, 1.0).translate(0.75, 0.0, 0.0).rotate(turn));
    }
    Ok(part)
}

/// The surface of the sixth degree with the most nodes that there can be (Barth 1996).
fn sextic() -> Tree {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let square = |tree: Tree| tree.square();
    let [x, y, z] = [Tree::x, Tree::y, Tree::z].map(|axis| square(axis()));
    let pair = |a: &Tree, b: &Tree| a.clone() * (golden * golden) - b.clone();
    let product = pair(&x, &y) * pair(&y, &z) * pair(&z, &x) * 4.0;
    -(product - square(x + y + z - 1.0) * (1.0 + 2.0 * golden))
}

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let edges = SampledSurface { method: SurfaceMethod::DualContouring, ..SampledSurface::new(0.05) };
    let part = edges.convert(&part()?.compile()?)?;
    // It has no end: what lies in a ball is shown.
    let cut = sextic().intersection(Tree::sphere(1.75));
    let region = Region::Box(Aabb::from_corners(DVec3::splat(-1.8), DVec3::splat(1.8)));
    let nodes = SampledSurface { region, ..SampledSurface::new(0.03) }.convert(&cut.compile()?)?;
    for (name, made) in [("the part", &part), ("Barth's sextic", &nodes)] {
        println!(
            "{name}: {} triangles, volume {:.4}, deviation {}; {:.0} of {:.0} samples were evaluated",
            made.value.triangles().len(),
            made.value.volume(),
            made.report.deviation,
            made.report.find("evaluations").unwrap_or(0.0),
            made.report.find("samples").unwrap_or(0.0)
        );
    }
    let shown = [(part, -1.5, 1.4), (nodes, 1.6, 0.75)].map(|(made, x, size)| {
        let moved = |&position: &DVec3| position * size + DVec3::X * x;
        SceneMesh::new(made.value.positions().iter().map(moved).collect(), made.value.triangles().to_vec())
    });
    let picture = Picture { wires: false, ..Picture::new() };
    println!(
        "{}",
        output.draw("sampled_surface", &Scene { surfaces: shown.into() }, [-30.0, 30.0], picture)?.display()
    );
    Ok(())
}
