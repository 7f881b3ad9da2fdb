//! A plate with holes as triangles: as few as can be, and with no angle below 28 degrees for a simulation.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::mesh::{Crossings, PlanarRegion, RegionMethod, TriangulateRegion};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let circle = |x: f64, y: f64, radius: f64, count: u32| -> Vec<DVec3> {
        let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
        (0..count).map(|k| DVec2::from_angle(angle(k)) * radius + DVec2::new(x, y)).map(|p| p.extend(0.0)).collect()
    };
    let outline = [(0.0, 0.0), (10.0, 0.0), (10.0, 3.0), (4.5, 3.0), (3.0, 4.5), (3.0, 9.0), (0.0, 9.0)];
    let outline: Vec<DVec3> = outline.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    // Holes, an island in one of them, whatever their order.
    let loops = [
        circle(7.8, 1.5, 0.5, 16),
        outline,
        circle(7.8, 1.5, 1.1, 32),
        circle(1.5, 7.2, 0.8, 24),
        circle(1.6, 1.6, 0.5, 6),
    ];
    let plate = PlanarRegion::try_new(&loops)?;

    let refine = |angle: f64, max_area: f64| TriangulateRegion { angle, max_area, ..TriangulateRegion::new() };
    let mut scene = Scene::default();
    for (words, converter, at) in [
        ("earcut", TriangulateRegion { method: RegionMethod::Earcut, ..TriangulateRegion::new() }, (0.0, 0.0)),
        ("constrained Delaunay", TriangulateRegion::new(), (11.0, 0.0)),
        ("no angle below 28 degrees", refine(28.0, 0.0), (0.0, -10.0)),
        ("and no area above 0.1", refine(28.0, 0.1), (11.0, -10.0)),
    ] {
        let converted = converter.convert(&plate)?;
        let (mesh, report) = (converted.value, converted.report);
        println!("{words}: {} triangles, area {:.6}, error {}", mesh.triangles().len(), mesh.area(), report.deviation);
        for name in ["smallest_angle", "vertices_added"] {
            report.find(name).iter().for_each(|value| println!("  {name} {value:.3}"));
        }
        let moved = mesh.positions().iter().map(|&position| position + DVec3::new(at.0, at.1, 0.0)).collect();
        scene.surfaces.push(SceneMesh::new(moved, mesh.triangles().to_vec()));
    }
    // A loop that crosses itself is split where it does, or refused with the place.
    let eight = [(0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let eight = PlanarRegion::try_new(&[eight])?;
    let refuse = TriangulateRegion { crossings: Crossings::Refuse, ..TriangulateRegion::new() };
    println!("an eight: area {}", TriangulateRegion::new().convert(&eight)?.value.area());
    refuse.convert(&eight).err().iter().for_each(|error| println!("an eight, refused: {error}"));

    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.7, ground: false, ..Picture::new() };
    println!("{}", output.draw("triangulate_region", &scene, [0.0, 80.0], look)?.display());
    Ok(())
}
