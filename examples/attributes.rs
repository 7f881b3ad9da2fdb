//! Attributes of any name on vertices, faces and wedges: carried through operations, mixed on triangles, lost by name.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Report};
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::mesh::{Blend, Column, Domain, PolyMesh, TEXCOORD, TriMesh, TriangulatePolygons, Values, Weld};
use shapeloom::shape::{Part, Shape};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;

    // Two squares side by side, each with corners of its own.
    let square = |x: f64| [[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let mut quads = PolyMesh::from_faces([square(0.0), square(1.0)].concat(), &[[0, 1, 2, 3], [4, 5, 6, 7]])?;

    // On vertices a measure, which mixes linearly; on faces text, which is copied; on wedges texture coordinates.
    let heat = vec![0.0f32, 10.0, 10.0, 0.0, 10.0, 20.0, 20.0, 10.0];
    quads.insert_attribute(Domain::Vertex, Column::try_new("heat", 1, Values::F32(heat))?)?;
    let wood = Values::Text { names: vec!["oak".to_owned(), "elm".to_owned()], index: vec![0, 1] };
    quads.insert_attribute(Domain::Face, Column::try_new("wood", 1, wood)?)?;
    let unit = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    quads.insert_attribute(Domain::Wedge, Column::texcoords(TEXCOORD, &[unit, unit].concat()))?;
    // A vertex attribute about which the two squares disagree where they touch.
    let side = Column::try_new("side", 1, Values::U8(vec![0, 0, 0, 0, 1, 1, 1, 1]))?.with_blend(Blend::Copy);
    quads.insert_attribute(Domain::Vertex, side)?;

    let triangulated = TriangulatePolygons::new().convert(&quads)?;
    say("triangulated", &triangulated.value, &triangulated.report);
    // Eight vertices become six. Merged vertices agree about the heat; about the side they do not: it moves to wedges.
    let welded = Weld::new().convert(&triangulated.value)?;
    say("welded", &welded.value, &welded.report);
    let mesh = welded.value;

    // At a point of a triangle, given by barycentric weights.
    let weights = [0.5, 0.25, 0.25];
    for triangle in 0..mesh.triangles().len() {
        let heat = mesh.interpolate(Domain::Vertex, "heat", triangle, weights);
        let uv = mesh.interpolate(Domain::Wedge, TEXCOORD, triangle, weights);
        let wood = mesh.attribute(Domain::Face, "wood").and_then(|column| column.text(triangle));
        println!("triangle {triangle}: heat {heat:?}, texcoord {uv:?}, wood {wood:?}");
    }

    // What a format cannot keep is named.
    for (id, name) in [("ply", "attributes.ply"), ("glb", "attributes.glb")] {
        let mut bytes = Vec::new();
        let shape = Shape::new(Part::new(mesh.clone()));
        let report = write(&shape, format_by_id(id)?, &WriteContext::default(), &mut bytes)?;
        println!("{}: {} losses", output.write(name, &bytes)?.display(), report.losses.len());
        report.losses.iter().for_each(|loss| println!("  lost: {loss}"));
    }
    Ok(())
}

fn say(what: &str, mesh: &TriMesh, report: &Report) {
    println!("{what}: {} vertices, {} triangles", mesh.positions().len(), mesh.triangles().len());
    for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
        let names: Vec<&str> = mesh.attributes().of(domain).iter().map(Column::name).collect();
        println!("  on each {domain}: {}", names.join(", "));
    }
    report.losses.iter().for_each(|loss| println!("  lost: {loss}"));
}
