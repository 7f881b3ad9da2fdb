//! What new vertices are made of.

use shapeloom_core::glam::DVec2;
use spade::Triangulation as _;
use spade::handles::FixedVertexHandle;

use super::constraints::Crossing;
use super::location::{locate, vertices_around};
use super::triangulation::{Cdt, Triangulation, position};

/// A vertex as source points with weights that add up to 1.
pub(crate) type Mixture = Vec<(u32, f64)>;

/// What each vertex of a triangulation is made of, before it is refined: a point, or at a crossing halfway between the two
/// edges.
pub(crate) fn of_vertices(triangulation: &Triangulation, edges: &[[u32; 2]], crossings: &[Crossing]) -> Vec<Mixture> {
    let mut mixtures: Vec<Mixture> = triangulation.point_of.iter().map(|&point| vec![(point, 1.0)]).collect();
    mixtures.resize(triangulation.cdt.num_vertices(), Vec::new());
    for crossing in crossings {
        let own = &mut mixtures[crossing.vertex as usize];
        if own.is_empty() {
            for part in crossing.edges.map(|edge| on_edge(triangulation, edges[edge as usize], crossing.vertex)) {
                own.extend(part.map(|(point, weight)| (point, weight * 0.5)));
            }
        }
    }
    mixtures
}

/// Where a vertex lies between the ends of a source edge.
pub(crate) fn on_edge(triangulation: &Triangulation, ends: [u32; 2], vertex: u32) -> [(u32, f64); 2] {
    let at = position(&triangulation.cdt, FixedVertexHandle::from_index(vertex as usize));
    let part = part_of_segment(ends.map(|end| of_point(triangulation, end)), at);
    [(ends[0], 1.0 - part), (ends[1], part)]
}

/// How far a vertex lies from the line of a source edge, on the triangulation's scale.
pub(crate) fn off_edge(triangulation: &Triangulation, ends: [u32; 2], vertex: u32) -> f64 {
    let at = position(&triangulation.cdt, FixedVertexHandle::from_index(vertex as usize));
    let [a, b] = ends.map(|end| of_point(triangulation, end));
    (b - a).perp_dot(at - a).abs() / a.distance(b)
}

fn of_point(triangulation: &Triangulation, point: u32) -> DVec2 {
    let vertex = triangulation.vertex_of[point as usize] as usize;
    position(&triangulation.cdt, FixedVertexHandle::from_index(vertex))
}

fn part_of_segment([a, b]: [DVec2; 2], at: DVec2) -> f64 {
    let part = (at - a).dot(b - a) / a.distance_squared(b);
    if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.5 }
}

/// What a place is made of in a triangulation in a box: the corners of the triangle that it lies in by barycentric
/// coordinates. The box's corners are made of nothing: a place at the hull that is rounded outwards has the hull edge's ends.
/// It is looked for from the vertex `near`.
pub(crate) fn at(cdt: &Cdt, mixtures: &[Mixture], place: DVec2, near: FixedVertexHandle) -> Mixture {
    let corners = vertices_around(cdt, locate(cdt, place, near));
    let own: Vec<_> = corners.into_iter().filter(|corner| !mixtures[corner.index()].is_empty()).collect();
    let parts = match own[..] {
        [a, b, c] => in_triangle([a, b, c], [a, b, c].map(|corner| position(cdt, corner) - place)),
        [a, b, ..] => {
            let part = part_of_segment([a, b].map(|end| position(cdt, end)), place);
            vec![(a, 1.0 - part), (b, part)]
        }
        [only] => vec![(only, 1.0)],
        [] => vec![(near, 1.0)],
    };
    let mut mixed: Mixture = Vec::new();
    for (vertex, share) in parts {
        for &(point, weight) in &mixtures[vertex.index()] {
            match mixed.iter_mut().find(|(known, _)| *known == point) {
                Some((_, known)) => *known += share * weight,
                None => mixed.push((point, share * weight)),
            }
        }
    }
    mixed
}

/// Barycentric coordinates of a place, from which the corners of a triangle around it lie so far.
fn in_triangle(corners: [FixedVertexHandle; 3], [a, b, c]: [DVec2; 3]) -> Vec<(FixedVertexHandle, f64)> {
    let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)].map(|area| area.max(0.0));
    let total: f64 = areas.iter().sum();
    match total > 0.0 {
        true => corners.into_iter().zip(areas.map(|area| area / total)).collect(),
        false => vec![(corners[0], 1.0)],
    }
}
