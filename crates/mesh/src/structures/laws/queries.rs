//! Every structure gives the true answers, each element once, and stops when told to.

use std::ops::ControlFlow;

use shapeloom_core::Exec;

use super::meshes::{Dice, Mesh, random, random_patch, special};
use super::truth::{Edge, Found, Truth};
use crate::structures::{Cost, EdgeId, Incidence, Query, StructureKind};

/// Elements of each kind that are asked about in a large mesh.
const ASKED: usize = 12;

fn spread(count: usize) -> impl Iterator<Item = usize> {
    let step = count.div_ceil(ASKED).max(1);
    // The first ones and the last, and some between.
    (0..count).filter(move |i| i % step == 0 || i + 2 > count || count < 40)
}

fn vertices_of(structure: &dyn Incidence, edge: u32) -> Edge {
    let ends = structure.answer(Query::EV, edge).unwrap();
    assert!(ends.len() == 2 && ends[0] != ends[1], "{}: {ends:?}", structure.name());
    [ends[0].min(ends[1]), ends[0].max(ends[1])]
}

/// Elements as a truth has them: vertices and faces by number, edges by their vertices.
fn as_found(structure: &dyn Incidence, wanted: char, numbers: &[u32]) -> Vec<Edge> {
    let one = |&number: &u32| if wanted == 'E' { vertices_of(structure, number) } else { [number, number] };
    numbers.iter().map(one).collect()
}

pub fn assert_answers(mesh: &Mesh, truth: &Truth, structure: &dyn Incidence) {
    let name = format!("{}, {}", mesh.name, structure.name());
    let knows = |query: Query| structure.cost(query) != Cost::Unanswered;
    let edges: Vec<EdgeId> = match structure.edges() {
        Ok(edges) => edges,
        Err(error) => {
            assert!(!knows(Query::EV) && error == structure.unanswered(Query::EV), "{name}");
            assert!(Query::ALL.iter().all(|&query| structure.answer(query, 0) == Err(structure.unanswered(query))));
            return;
        }
    };
    assert_eq!(structure.vertex_count(), mesh.vertices as usize, "{name}");
    let has_faces = knows(Query::FV);
    assert_eq!(structure.face_count(), if has_faces { truth.faces.len() } else { 0 }, "{name}");
    let numbers: Vec<u32> = edges.iter().map(|edge| edge.0).collect();
    let by_vertices = as_found(structure, 'E', &numbers);
    assert_eq!(by_vertices.len(), truth.edges.len(), "{name}");
    assert!(by_vertices.iter().copied().collect::<Found>().iter().eq(truth.edges.keys()), "{name}");

    for query in Query::ALL {
        let letters: Vec<char> = query.name().chars().collect();
        let elements: Vec<(u32, Edge)> = match letters[0] {
            'V' => spread(mesh.vertices as usize).map(|v| (v as u32, [v as u32; 2])).collect(),
            'E' => spread(edges.len()).map(|i| (numbers[i], by_vertices[i])).collect(),
            _ => spread(truth.faces.len()).map(|f| (f as u32, [f as u32; 2])).collect(),
        };
        for (number, element) in elements {
            let answer = structure.answer(query, number);
            if !knows(query) {
                assert_eq!(answer, Err(structure.unanswered(query)), "{name}, {query}");
                continue;
            }
            let answer = answer.unwrap_or_else(|error| panic!("{name}: {error}"));
            if query == Query::FV {
                // In order, from the first corner, as often as the face has them.
                assert_eq!(answer, truth.faces[number as usize], "{name}");
                continue;
            }
            let found = as_found(structure, letters[1], &answer);
            let set: Found = found.iter().copied().collect();
            assert_eq!(set.len(), found.len(), "{name}: {query} of {element:?} has something twice: {found:?}");
            assert_eq!(set, truth.answer(query, element), "{name}: {query} of {element:?}");
            // Told to stop after some, it calls no more.
            for enough in [1, answer.len() / 2].into_iter().filter(|&enough| enough > 0 && enough <= answer.len()) {
                let mut seen = Vec::new();
                let stopping = structure.visit(query, number, &mut |found| {
                    seen.push(found);
                    if seen.len() == enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                });
                assert!(stopping.is_ok() && seen == answer[..enough], "{name}: {query} of {element:?}");
            }
        }
    }
    let mut calls = 0;
    let stopping = structure.visit_edges(&mut |_| {
        calls += 1;
        ControlFlow::Break(())
    });
    assert!(stopping.is_ok() && calls == edges.len().min(1), "{name}");
}

/// How many structures held the mesh.
fn assert_all_answer(mesh: &Mesh) -> usize {
    let truth = Truth::new(&mesh.faces, mesh.vertices);
    let built = StructureKind::ALL.iter().filter_map(|kind| kind.build(&mesh.faces, &Exec::default()).ok());
    built.map(|structure| assert_answers(mesh, &truth, &*structure)).count()
}

#[test]
fn special_meshes_are_answered_by_definition() {
    for mesh in special() {
        assert!(assert_all_answer(&mesh) >= 4, "{}", mesh.name);
    }
}

#[test]
fn random_faces_are_answered_by_definition() {
    let mut dice = Dice(3);
    let held: Vec<usize> = (0..2000).map(|_| assert_all_answer(&random(&mut dice))).collect();
    assert!(held.iter().any(|&held| held == StructureKind::ALL.len()) && held.contains(&4));
}

#[test]
fn random_patches_are_answered_by_definition() {
    let mut dice = Dice(5);
    let held: Vec<usize> = (0..300).map(|_| assert_all_answer(&random_patch(&mut dice))).collect();
    assert!(held.iter().filter(|&&held| held == StructureKind::ALL.len()).count() >= 10, "{held:?}");
}
