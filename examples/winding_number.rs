//! Winding numbers around a mesh with holes and flipped faces: they still tell inside from outside.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::primitives::Torus;
use shapeloom::mesh::{TriMesh, TriangulatePolygons};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::spatial::WindingTree;
use shapeloom_examples::{Output, Slice};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    let torus = Torus { segments: 96, sides: 48, ..Torus::new() }.mesh(&exec)?.value;
    let torus = TriangulatePolygons::new().convert(&torus)?.value;

    // Patches of faces are missing, others are flipped.
    let patch = |p: DVec3| (7.0 * p.x).sin() * (6.0 * p.y).sin() + 0.5 * (11.0 * p.z + 4.0 * p.x).sin();
    let mut triangles = Vec::new();
    for (index, &[a, b, c]) in torus.triangles().iter().enumerate() {
        let [p, q, r] = torus.corners(index);
        match patch((p + q + r) / 3.0) {
            hole if hole > 0.8 => {}
            flip if flip < -1.1 => triangles.push([a, c, b]),
            _ => triangles.push([a, b, c]),
        }
    }
    let broken = TriMesh::try_new(torus.positions().to_vec(), triangles)?;
    println!("{} of {} triangles are left", broken.triangles().len(), torus.triangles().len());

    let whole = WindingTree::build(torus.positions(), torus.triangles(), &exec)?;
    let tree = WindingTree::build(broken.positions(), broken.triangles(), &exec)?;
    let inside = DVec3::new(1.0, 0.0, 0.1);
    println!(
        "inside the whole torus: {:.6}, its middle hole: {:.6}",
        whole.winding_number(inside),
        whole.winding_number(DVec3::ZERO)
    );
    println!("inside the broken one: {:.6} quickly", tree.winding_number(inside));
    for tolerance in [0.1, 1e-3] {
        let found = tree.winding_number_within(inside, tolerance);
        println!("  within {tolerance}: {:.6}, proven to {:.1e}", found.value, found.bound);
    }
    let exact = tree.winding_number_exact(inside);
    println!("  over all triangles: {:.6}, proven to {:.1e}", exact.value, exact.bound);

    // A slice through both, and how many points the broken one judges otherwise than the whole one.
    let bounds = torus.bounds().padded(0.25);
    let slice = Slice { from: bounds.min.truncate(), to: bounds.max.truncate(), height: 0.02, columns: 200 };
    let mut scene = Scene::default();
    let shift = DVec3::X * (slice.to.x - slice.from.x) * 1.03;
    for (tree, shift) in [(&whole, DVec3::ZERO), (&tree, shift)] {
        let mut numbers = vec![0.0; slice.points().len()];
        tree.winding_numbers(&slice.points(), &mut numbers, &exec)?;
        let cells = slice.colored(&numbers, |number| number.clamp(-0.25, 1.25) / 1.5 + 1.0 / 6.0, 25);
        let moved =
            |mesh: SceneMesh| SceneMesh { positions: mesh.positions.iter().map(|&p| p + shift).collect(), ..mesh };
        scene.surfaces.extend(cells.into_iter().map(moved));
    }
    let judged = |point: &&DVec3| (whole.winding_number(**point) > 0.5) != (tree.winding_number(**point) > 0.5);
    println!("judged otherwise: {} of {}", slice.points().iter().filter(judged).count(), slice.points().len());
    let look = Picture { mode: Mode::Flat, ..Picture::new() };
    println!("{}", output.draw("winding_number", &scene, [0.0, 89.0], look)?.display());
    Ok(())
}
