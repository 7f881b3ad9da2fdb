//! Which faces of a mesh pass through one another, which overlap and which only touch; decided exactly.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Exec;
use shapeloom::core::glam::DVec3;
use shapeloom::judge::{PairKind, SelfIntersections, self_intersections_of_polygons};
use shapeloom::mesh::PolyMesh;
use shapeloom::mesh::primitives::{Platonic, Solid, Torus};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

const ORANGE: [f32; 3] = [0.85, 0.2, 0.02];

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;

    // Two solids in one mesh: side by side with a face in common, the same a little lower, and one into the other.
    let cube = Platonic::new(Solid::Cube).mesh(&Exec::default())?.value;
    for (what, shift) in
        [("on each other", DVec3::Z), ("shifted", DVec3::new(0.25, 0.25, 1.0)), ("merged", DVec3::splat(0.5))]
    {
        let found = judge(what, &joined(&cube, &cube, |p| p + shift)?)?;
        assert_eq!(found.crosses(), what == "merged");
    }

    // Two rings, linked and through each other; the faces that cross are painted.
    let ring = Torus { segments: 48, sides: 24, ..Torus::new() }.mesh(&Exec::default())?.value;
    let mut scene = Scene::default();
    for (what, shift, place) in [("linked rings", 1.0, -2.3), ("crossing rings", 0.5, 1.9)] {
        let rings = joined(&ring, &ring, |p| DVec3::new(p.x + shift, -p.z, p.y))?;
        let found = judge(what, &rings)?;
        let crossing: Vec<u32> = found.crossing.listed.iter().flat_map(|pair| pair.faces).collect();
        let positions: Vec<DVec3> = rings.positions().iter().map(|&p| p + DVec3::X * place).collect();
        for (crosses, color) in [(false, SceneMesh::GLAZE), (true, ORANGE)] {
            let chosen = (0..rings.face_count()).filter(|&face| crossing.contains(&(face as u32)) == crosses);
            let cut = |face: usize| {
                let ring = rings.face(face);
                (1..ring.len() - 1).map(|i| [ring[0], ring[i], ring[i + 1]]).collect::<Vec<_>>()
            };
            let triangles: Vec<[u32; 3]> = chosen.flat_map(cut).collect();
            if !triangles.is_empty() {
                scene.surfaces.push(SceneMesh { color, ..SceneMesh::new(positions.clone(), triangles) });
            }
        }
    }
    println!("{}", output.draw("self_intersection", &scene, [-20.0, 42.0], Picture::new())?.display());
    Ok(())
}

fn judge(what: &str, mesh: &PolyMesh) -> Result<SelfIntersections, Box<dyn Error>> {
    let found = self_intersections_of_polygons(mesh, 10_000, &Exec::default())?;
    let seen = PairKind::ALL.into_iter().filter(|&kind| found.count(kind) > 0);
    let kinds: Vec<String> = seen.map(|kind| format!("{} {}", found.count(kind), kind.name())).collect();
    println!("{what}: {}", if kinds.is_empty() { "no pair".to_owned() } else { kinds.join(", ") });
    Ok(found)
}

/// A mesh and its image under a map, as one mesh.
fn joined(a: &PolyMesh, b: &PolyMesh, map: impl Fn(DVec3) -> DVec3) -> Result<PolyMesh, Box<dyn Error>> {
    let first = a.positions().len() as u32;
    let moved = b.faces().map(|face| face.iter().map(|vertex| vertex + first).collect());
    let faces: Vec<Vec<u32>> = a.faces().map(<[u32]>::to_vec).chain(moved).collect();
    let positions = a.positions().iter().copied().chain(b.positions().iter().map(|&p| map(p))).collect();
    Ok(PolyMesh::from_faces(positions, &faces)?)
}
