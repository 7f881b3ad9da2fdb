//! Structures put together by hand are refused or sound, whatever they are put together from.

use super::meshes::{Dice, Mesh, random_patch};
use super::queries::assert_answers;
use super::truth::Truth;
use crate::structures::{
    AdjacencyMatrix, EdgeList, ExtendedEdgeList, Incidence, IndexedPolygons, StructureError, WingedEdge,
};

/// Changes a few numbers to others that are near, far out, or nothing.
fn shaken<'a>(numbers: impl Iterator<Item = &'a mut u32>, dice: &mut Dice) {
    let mut numbers: Vec<&mut u32> = numbers.collect();
    for _ in 0..dice.below(3) {
        if numbers.is_empty() {
            return;
        }
        let chosen = dice.below(numbers.len() as u32) as usize;
        let other = *numbers[dice.below(numbers.len() as u32) as usize];
        *numbers[chosen] = match dice.below(6) {
            0 => u32::MAX,
            1 => dice.below(100),
            2 => numbers[chosen].wrapping_add(1),
            _ => other,
        };
    }
}

/// Notes whether a structure was accepted; an accepted one gives true answers about the faces that it has.
fn judge<S: Incidence>(built: Result<S, StructureError>, faces: impl Fn(&S) -> IndexedPolygons, told: &mut [usize; 2]) {
    match built {
        Ok(structure) => {
            let (vertices, faces) = (structure.vertex_count() as u32, faces(&structure));
            let mesh = Mesh { name: "by hand".to_owned(), vertices, faces };
            assert_answers(&mesh, &Truth::new(&mesh.faces, vertices), &structure);
            told[0] += 1;
        }
        Err(error) => {
            assert!(!matches!(error, StructureError::OverBudget(_) | StructureError::Stop(_)), "{error}");
            told[1] += 1;
        }
    }
}

#[test]
fn shaken_structures_are_refused_or_sound() {
    let mut dice = Dice(31);
    let (mut winged, mut extended, mut matrices) = ([0; 2], [0; 2], [0; 2]);
    for _ in 0..1200 {
        let mesh = random_patch(&mut dice);
        if let Ok(sound) = WingedEdge::try_from(&mesh.faces) {
            let mut edges = sound.edges().to_vec();
            let mut of_vertices: Vec<u32> =
                (0..mesh.vertices).map(|vertex| sound.edge_of_vertex(vertex).unwrap_or(u32::MAX)).collect();
            let mut of_faces: Vec<u32> = (0..sound.face_count() as u32).map(|face| sound.edge_of_face(face)).collect();
            let of_edges = edges
                .iter_mut()
                .flat_map(|edge| edge.vertices.iter_mut().chain(&mut edge.faces).chain(edge.wings.as_flattened_mut()));
            shaken(of_edges.chain(&mut of_vertices).chain(&mut of_faces), &mut dice);
            judge(WingedEdge::try_new(edges, of_vertices, of_faces), |mesh| mesh.into(), &mut winged);
        }
        if let Ok(sound) = ExtendedEdgeList::try_from(&mesh.faces) {
            let (mut edges, mut firsts) = (sound.edges().to_vec(), sound.firsts().to_vec());
            let of_edges = edges.iter_mut().flat_map(|edge| edge.vertices.iter_mut().chain(&mut edge.faces));
            shaken(of_edges.chain(&mut firsts), &mut dice);
            judge(ExtendedEdgeList::try_new(mesh.vertices, edges, firsts), |list| list.into(), &mut extended);
        }
        let sound = AdjacencyMatrix::try_from(&mesh.faces).unwrap();
        let rows: Vec<&[u32]> = (0..mesh.vertices).map(|row| sound.row(row)).collect();
        let mut columns = rows.concat();
        let mut starts = vec![0u32];
        rows.iter().for_each(|row| starts.push(starts[starts.len() - 1] + row.len() as u32));
        shaken(starts.iter_mut().chain(&mut columns), &mut dice);
        // An accepted one is the matrix of its own edges.
        match AdjacencyMatrix::try_new(starts, columns) {
            Ok(matrix) => {
                assert_eq!(AdjacencyMatrix::try_from(&EdgeList::from(&matrix)), Ok(matrix));
                matrices[0] += 1;
            }
            Err(_) => matrices[1] += 1,
        }
    }
    for told in [winged, extended, matrices] {
        assert!(told.iter().all(|&count| count >= 50), "{winged:?} {extended:?} {matrices:?}");
    }
}
