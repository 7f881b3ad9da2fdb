//! The signed distance to a torus: a slice through it, its gradient, and what is known over a box.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Aabb, Convert, Exec, Field};
use shapeloom::mesh::TriangulatePolygons;
use shapeloom::mesh::primitives::Torus;
use shapeloom::render::{Mode, Picture, Scene};
use shapeloom::spatial::SignedDistance;
use shapeloom_examples::{Output, Slice};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    let torus = Torus { segments: 96, sides: 48, ..Torus::new() };
    let mesh = TriangulatePolygons::new().convert(&torus.mesh(&exec)?.value)?.value;
    let distance = SignedDistance::build(mesh.positions(), mesh.triangles(), &exec)?;
    println!("closed: {}, Lipschitz constant {:?}", distance.is_closed(), distance.lipschitz());

    // Beside that of the smooth torus, which the mesh stays within a chord of.
    let (around, across) = (torus.major_radius, torus.minor_radius);
    for point in [DVec3::new(around, 0.0, 0.1), DVec3::new(0.3, 0.4, 0.2), DVec3::new(1.5, -1.0, 0.5)] {
        let smooth = (point.truncate().length() - around).hypot(point.z) - across;
        let gradient = distance.gradient(point);
        println!("{point}: {:.5}, smooth {smooth:.5}, gradient {gradient:.3}", distance.distance(point));
    }
    let region = Aabb::from_corners(DVec3::new(1.6, 0.0, 0.6), DVec3::new(1.8, 0.2, 0.8));
    println!("over {region:?}: {:?}", distance.range(&region));

    // Inside blue, outside warm, with a line at every tenth.
    let bounds = mesh.bounds().padded(0.3);
    let slice = Slice { from: bounds.min.truncate(), to: bounds.max.truncate(), height: 0.02, columns: 320 };
    let mut values = vec![0.0; slice.points().len()];
    distance.distances(&slice.points(), &mut values, &exec)?;
    let shade = |value: f64| {
        let line = (value * 10.0 - (value * 10.0).round()).abs() < 0.08;
        0.5 + (if line { 0.65 } else { 1.0 }) * (0.12f64.copysign(-value) - value * 0.55).clamp(-0.5, 0.5)
    };
    let scene = Scene { surfaces: slice.colored(&values, shade, 48) };
    let look = Picture { mode: Mode::Flat, ..Picture::new() };
    println!("{}", output.draw("signed_distance", &scene, [0.0, 89.0], look)?.display());
    Ok(())
}
