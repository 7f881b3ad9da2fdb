//! The parts of a mesh.

use super::boundary::BoundaryLoops;
use super::edges::Edges;
use crate::Faces;
use crate::union_find::DisjointSets;

/// Faces that are joined through edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Component {
    /// The smallest face.
    pub first_face: u32,
    /// How many faces it has.
    pub faces: u32,
    /// Its boundary loops; one that joins two components at a vertex is one of both.
    pub boundary_loops: u32,
    /// Its edges with one face.
    pub boundary_edges: u32,
    /// Its edges with more than two faces.
    pub non_manifold_edges: u32,
    /// Its edges with two faces that run along it in the same direction.
    pub inconsistent_edges: u32,
    /// Whether its faces can be oriented alike.
    pub orientable: bool,
    /// Vertices less edges plus faces.
    pub euler_characteristic: i64,
    /// The number of its handles, or where it is not orientable of its crosscaps. None where the mesh is not manifold, or
    /// where a face meets itself so that the number would not be whole.
    pub genus: Option<u64>,
}

impl Component {
    /// Whether every edge has two faces that run along it in opposite directions.
    pub fn is_shell(&self) -> bool {
        self.boundary_edges == 0 && self.non_manifold_edges == 0 && self.inconsistent_edges == 0
    }
}

/// The components by their smallest face, and the component of each face. Genus is told where the mesh is manifold.
pub(super) fn components(
    faces: &Faces<'_>,
    edges: &Edges,
    boundary: &BoundaryLoops,
    twisted: &[u32],
    manifold: bool,
) -> (Vec<Component>, Vec<u32>) {
    let mut joined = DisjointSets::new(faces.len());
    for uses in edges.iter() {
        let first = faces.face_of(uses[0]);
        uses[1..].iter().for_each(|&wedge| joined.join(first, faces.face_of(wedge)));
    }
    // The number of each face's component; representatives are smallest, so they come before the rest.
    let mut number = vec![0u32; faces.len()];
    let mut found: Vec<Component> = Vec::new();
    for face in 0..faces.len() as u32 {
        let first = joined.find(face);
        if first == face {
            number[face as usize] = found.len() as u32;
            found.push(Component {
                first_face: face,
                faces: 0,
                boundary_loops: 0,
                boundary_edges: 0,
                non_manifold_edges: 0,
                inconsistent_edges: 0,
                orientable: true,
                euler_characteristic: 0,
                genus: None,
            });
        }
        number[face as usize] = number[first as usize];
        let component = &mut found[number[face as usize] as usize];
        component.faces += 1;
        component.euler_characteristic += 1;
    }
    for &face in twisted {
        found[number[face as usize] as usize].orientable = false;
    }
    let mut at_loop = vec![u32::MAX; if boundary.is_empty() { 0 } else { faces.vertex_count() }];
    for (index, edges) in boundary.iter().enumerate() {
        edges.iter().flatten().for_each(|&vertex| at_loop[vertex as usize] = index as u32);
    }
    let mut loops = Vec::new();
    for uses in edges.iter() {
        let index = number[faces.face_of(uses[0]) as usize];
        let component = &mut found[index as usize];
        component.euler_characteristic -= 1;
        match *uses {
            [one] => {
                component.boundary_edges += 1;
                loops.push((index, at_loop[faces.side(one)[0] as usize]));
            }
            [one, other] => component.inconsistent_edges += u32::from(faces.side(one) == faces.side(other)),
            _ => component.non_manifold_edges += 1,
        }
    }
    loops.sort_unstable();
    loops.dedup();
    for (component, _) in loops {
        found[component as usize].boundary_loops += 1;
    }
    // A vertex counts once for each component that names it.
    let mut last = vec![u32::MAX; faces.vertex_count()];
    let mut counted_twice = Vec::new();
    for face in 0..faces.len() as u32 {
        let component = number[face as usize];
        for &vertex in faces.face(face) {
            let seen = &mut last[vertex as usize];
            if *seen == u32::MAX {
                *seen = component;
                found[component as usize].euler_characteristic += 1;
            } else if *seen != component {
                counted_twice.push((vertex, component));
            }
        }
    }
    counted_twice.sort_unstable();
    counted_twice.dedup();
    for (_, component) in counted_twice {
        found[component as usize].euler_characteristic += 1;
    }
    if manifold {
        for component in &mut found {
            // χ = 2 − 2G − B, or 2 − K − B with crosscaps.
            let twice = 2 - component.euler_characteristic - i64::from(component.boundary_loops);
            let whole = if component.orientable { (twice % 2 == 0).then_some(twice / 2) } else { Some(twice) };
            component.genus = whole.and_then(|genus| u64::try_from(genus).ok());
        }
    }
    (found, number)
}
