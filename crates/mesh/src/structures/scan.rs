//! The queries on lists of faces, by looking at all of them.

use std::collections::HashSet;

use super::face_list::{FaceList, ordered, sides_of};
use super::incidence::{Visitor, visit_each};
use super::{EdgeId, FaceId, VertexId};

/// Calls with each proper side: the corner that it starts at, and its vertices in its direction.
fn sides(faces: &impl FaceList) -> impl Iterator<Item = (u32, [u32; 2])> + '_ {
    let all = (0..faces.face_total() as u32).flat_map(move |face| sides_of(faces, face));
    all.filter(|(_, [a, b])| a != b)
}

/// The first side of each edge that passes a test.
fn first_sides<'a>(
    faces: &'a impl FaceList,
    mut wanted: impl FnMut([u32; 2]) -> bool + 'a,
) -> impl Iterator<Item = (u32, [u32; 2])> + 'a {
    let mut seen = HashSet::new();
    sides(faces).filter_map(move |(corner, side)| {
        let edge = ordered(side);
        (wanted(edge) && seen.insert(edge)).then_some((corner, edge))
    })
}

pub(crate) fn edges(faces: &impl FaceList, visit: &mut Visitor<'_, EdgeId>) {
    visit_each(first_sides(faces, |_| true).map(|(corner, _)| EdgeId(corner)), visit);
}

pub(crate) fn vertex_vertices(faces: &impl FaceList, vertex: u32, visit: &mut Visitor<'_, VertexId>) {
    check(vertex, faces.vertex_total());
    let near = first_sides(faces, |[a, b]| a == vertex || b == vertex);
    visit_each(near.map(|(_, [a, b])| VertexId(if a == vertex { b } else { a })), visit);
}

pub(crate) fn vertex_edges(faces: &impl FaceList, vertex: u32, visit: &mut Visitor<'_, EdgeId>) {
    check(vertex, faces.vertex_total());
    let near = first_sides(faces, |[a, b]| a == vertex || b == vertex);
    visit_each(near.map(|(corner, _)| EdgeId(corner)), visit);
}

pub(crate) fn vertex_faces(faces: &impl FaceList, vertex: u32, visit: &mut Visitor<'_, FaceId>) {
    check(vertex, faces.vertex_total());
    let near = (0..faces.face_total() as u32).filter(|&face| faces.face(face).contains(&vertex));
    visit_each(near.map(FaceId), visit);
}

pub(crate) fn edge_vertices(faces: &impl FaceList, edge: u32, visit: &mut Visitor<'_, VertexId>) {
    visit_each(ordered(faces.side(edge)).map(VertexId), visit);
}

pub(crate) fn edge_edges(faces: &impl FaceList, edge: u32, visit: &mut Visitor<'_, EdgeId>) {
    let own = ordered(faces.side(edge));
    let near = first_sides(faces, |other| other != own && other.iter().any(|vertex| own.contains(vertex)));
    visit_each(near.map(|(corner, _)| EdgeId(corner)), visit);
}

pub(crate) fn edge_faces(faces: &impl FaceList, edge: u32, visit: &mut Visitor<'_, FaceId>) {
    let own = ordered(faces.side(edge));
    let near = |&face: &u32| sides_of(faces, face).any(|(_, side)| ordered(side) == own);
    visit_each((0..faces.face_total() as u32).filter(near).map(FaceId), visit);
}

pub(crate) fn face_vertices(faces: &impl FaceList, face: u32, visit: &mut Visitor<'_, VertexId>) {
    visit_each(faces.face(face).iter().map(|&vertex| VertexId(vertex)), visit);
}

pub(crate) fn face_edges(faces: &impl FaceList, face: u32, visit: &mut Visitor<'_, EdgeId>) {
    let mut own: Vec<[u32; 2]> = Vec::new();
    let mut seen = HashSet::new();
    for (_, side) in sides_of(faces, face) {
        if side[0] != side[1] && seen.insert(ordered(side)) {
            own.push(ordered(side));
        }
    }
    let mut first = std::collections::HashMap::new();
    for (corner, edge) in first_sides(faces, |edge| seen.contains(&edge)) {
        first.insert(edge, corner);
    }
    visit_each(own.iter().map(|edge| EdgeId(first[edge])), visit);
}

pub(crate) fn face_faces(faces: &impl FaceList, face: u32, visit: &mut Visitor<'_, FaceId>) {
    let own: HashSet<[u32; 2]> =
        sides_of(faces, face).filter(|(_, [a, b])| a != b).map(|(_, side)| ordered(side)).collect();
    let near = |&other: &u32| other != face && sides_of(faces, other).any(|(_, side)| own.contains(&ordered(side)));
    visit_each((0..faces.face_total() as u32).filter(near).map(FaceId), visit);
}

fn check(vertex: u32, count: usize) {
    assert!((vertex as usize) < count, "there is no vertex {vertex} among {count}");
}

/// Implements [`Incidence`](super::Incidence) for a list of faces.
macro_rules! answer_by_scanning {
    ($type:ty, $name:literal) => {
        impl crate::structures::Incidence for $type {
            fn name(&self) -> &'static str {
                $name
            }

            fn vertex_count(&self) -> usize {
                self.vertex_total()
            }

            fn face_count(&self) -> usize {
                self.face_total()
            }

            fn cost(&self, query: crate::structures::Query) -> crate::structures::Cost {
                use crate::structures::{Cost, Query};
                if matches!(query, Query::FV | Query::EV) { Cost::Local } else { Cost::Scan }
            }

            fn memory_bytes(&self) -> usize {
                size_of_val(self.all_corners()) + self.start_bytes()
            }

            fn visit_edges(
                &self,
                visit: &mut crate::structures::Visitor<'_, crate::structures::EdgeId>,
            ) -> crate::structures::Answered {
                crate::structures::scan::edges(self, visit);
                Ok(())
            }

            crate::structures::scan::answer_by_scanning!(@queries
                vertex_vertices(VertexId) -> VertexId,
                vertex_edges(VertexId) -> EdgeId,
                vertex_faces(VertexId) -> FaceId,
                edge_vertices(EdgeId) -> VertexId,
                edge_edges(EdgeId) -> EdgeId,
                edge_faces(EdgeId) -> FaceId,
                face_vertices(FaceId) -> VertexId,
                face_edges(FaceId) -> EdgeId,
                face_faces(FaceId) -> FaceId,
            );
        }
    };
    (@queries $($name:ident($from:ident) -> $to:ident,)*) => {$(
        fn $name(
            &self,
            element: crate::structures::$from,
            visit: &mut crate::structures::Visitor<'_, crate::structures::$to>,
        ) -> crate::structures::Answered {
            crate::structures::scan::$name(self, element.0, visit);
            Ok(())
        }
    )*};
}

pub(crate) use answer_by_scanning;
