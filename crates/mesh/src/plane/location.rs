//! Where a place lies in a triangulation.

use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::orient2d;
use spade::handles::{FixedDirectedEdgeHandle, FixedFaceHandle, FixedVertexHandle, InnerTag};
use spade::{PositionInTriangulation, Triangulation as _};

use super::triangulation::{Cdt, position};

/// Where a place lies, looked for from a vertex by going through sides that it lies beyond (Devillers, Pion and Teillaud
/// 2002), with exact signs.
///
/// Across edges that must stay such a walk may go round in a circle, as spade's own does: one that visits more triangles than
/// there are gives up, and all triangles are looked at.
pub(crate) fn locate(cdt: &Cdt, at: DVec2, near: FixedVertexHandle) -> PositionInTriangulation {
    let first = cdt.vertex(near).out_edges().find_map(|edge| edge.face().as_inner().map(|face| face.fix()));
    let Some(mut face) = first.or_else(|| cdt.inner_faces().next().map(|face| face.fix())) else {
        return PositionInTriangulation::NoTriangulation;
    };
    for step in 0..cdt.num_inner_faces() {
        let sides = sides(cdt, face);
        // From another side each time, which breaks most circles.
        let beyond = (0..3).map(|k| sides[(k + step) % 3]).find(|&side| side_of(cdt, side, at).is_lt());
        let Some(side) = beyond else { return within(cdt, face, at) };
        match cdt.directed_edge(side).rev().face().as_inner() {
            Some(next) => face = next.fix(),
            None => return PositionInTriangulation::OutsideOfConvexHull(side.rev()),
        }
    }
    cdt.inner_faces()
        .map(|face| face.fix())
        .find(|&face| sides(cdt, face).into_iter().all(|side| side_of(cdt, side, at).is_ge()))
        .map_or(PositionInTriangulation::NoTriangulation, |face| within(cdt, face, at))
}

/// Where a place lies in a triangle that it does not lie outside of.
fn within(cdt: &Cdt, face: FixedFaceHandle<InnerTag>, at: DVec2) -> PositionInTriangulation {
    if let Some(vertex) = corners(cdt, face).into_iter().find(|&corner| position(cdt, corner) == at) {
        return PositionInTriangulation::OnVertex(vertex);
    }
    match sides(cdt, face).into_iter().find(|&side| side_of(cdt, side, at).is_eq()) {
        Some(side) => PositionInTriangulation::OnEdge(side),
        None => PositionInTriangulation::OnFace(face),
    }
}

/// The vertices of what a place lies in, or of the edge at the hull that it lies beyond.
pub(crate) fn vertices_around(cdt: &Cdt, at: PositionInTriangulation) -> Vec<FixedVertexHandle> {
    match at {
        PositionInTriangulation::OnVertex(vertex) => vec![vertex],
        PositionInTriangulation::OnEdge(edge) | PositionInTriangulation::OutsideOfConvexHull(edge) => {
            cdt.directed_edge(edge).vertices().map(|vertex| vertex.fix()).to_vec()
        }
        PositionInTriangulation::OnFace(face) => corners(cdt, face).to_vec(),
        PositionInTriangulation::NoTriangulation => Vec::new(),
    }
}

fn sides(cdt: &Cdt, face: FixedFaceHandle<InnerTag>) -> [FixedDirectedEdgeHandle; 3] {
    cdt.face(face).adjacent_edges().map(|edge| edge.fix())
}

fn corners(cdt: &Cdt, face: FixedFaceHandle<InnerTag>) -> [FixedVertexHandle; 3] {
    cdt.face(face).vertices().map(|vertex| vertex.fix())
}

fn side_of(cdt: &Cdt, side: FixedDirectedEdgeHandle, at: DVec2) -> std::cmp::Ordering {
    let [from, to] = cdt.directed_edge(side).vertices().map(|vertex| position(cdt, vertex.fix()));
    orient2d(from, to, at)
}
