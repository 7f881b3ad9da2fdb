//! A freeform roof of quadrilaterals, made flat for panels of glass: coloured by how far each is from flat, before and after.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::{PlanarizeQuads, PolyMesh, QuadGrid, TriangulatePolygons};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh, sequential_color};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // An arch that narrows and leans as it goes.
    let (columns, rows) = (22, 19);
    let points = (0..columns * rows).map(|k| {
        let (u, v) = (f64::from(k % columns) / f64::from(columns - 1), f64::from(k / columns) / f64::from(rows - 1));
        let arch = DVec2::from_angle(std::f64::consts::PI * (0.08 + 0.84 * v)) * (0.5 - 0.18 * u * u);
        DVec3::new(1.7 * u + 0.25 * (v - 0.5) * (4.0 * u).sin(), -arch.x, arch.y + 0.08 * (6.0 * u + 3.0 * v).sin())
    });
    let roof = QuadGrid::try_new(columns, rows, points.collect(), [false, false])?.to_mesh(&Exec::default())?;
    let worst = (0..roof.face_count()).map(|face| roof.planarity(face)).fold(0.0, f64::max);

    let mut scene = Scene { surfaces: vec![colored(&roof, worst, 0.0)?] };
    for (hold_border, aside) in [(false, 1.3), (true, 2.6)] {
        let made = PlanarizeQuads { hold_border, ..PlanarizeQuads::new(1e-5) }.convert(&roof)?;
        let figure = |name: &str| made.report.find(name).unwrap_or(f64::NAN);
        println!("border held: {hold_border}; {} Newton steps", figure("newton_steps"));
        println!("  corners from their planes: {:.2e}, before {:.2e}", figure("planarity"), figure("planarity_before"));
        println!("  vertices moved: {}", made.report.deviation);
        made.report.findings.iter().for_each(|finding| println!("  {finding}"));
        scene.surfaces.push(colored(&made.value, worst, aside)?);
    }
    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.8, ..Picture::new() };
    println!("{}", output.draw("planarize_quads", &scene, [-55.0, 40.0], look)?.display());
    Ok(())
}

/// A mesh moved aside, each face in the colour of its distance from flat; dark is flat.
fn colored(mesh: &PolyMesh, most: f64, aside: f64) -> Result<SceneMesh, Box<dyn Error>> {
    let (mut positions, mut colors, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for face in 0..mesh.face_count() {
        let first = positions.len() as u32;
        positions.extend(mesh.outline(face).map(|corner| corner - DVec3::Y * aside));
        colors.resize(positions.len(), sequential_color(mesh.planarity(face) / most));
        faces.push((first..positions.len() as u32).collect::<Vec<u32>>());
    }
    let apart = PolyMesh::from_faces(positions, &faces)?;
    let triangles = TriangulatePolygons::new().convert(&apart)?.value;
    // The sides of the quadrilaterals alone, not the diagonals.
    let edges = triangles.triangles().iter().map(|t| [0, 1, 2].map(|k| (t[k].abs_diff(t[(k + 1) % 3])) % 2 == 1));
    let scene = SceneMesh::new(triangles.positions().to_vec(), triangles.triangles().to_vec());
    Ok(SceneMesh { colors: Some(colors), edges: Some(edges.collect()), ..scene })
}
