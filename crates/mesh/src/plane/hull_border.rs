//! The edges around a triangulation.

use spade::Triangulation as _;
use spade::handles::FixedUndirectedEdgeHandle;

use super::inside::Edge;
use super::triangulation::{Cdt, position};

/// The edges around everything within the hull but flat triangles at it, and how many of these there are.
///
/// Points that were meant to lie on a straight border are off it by rounding. The hull then has triangles along it that are
/// flat but for that rounding, and no vertices could make them better.
pub(super) fn border(cdt: &Cdt) -> (Vec<FixedUndirectedEdgeHandle>, u64) {
    let is_flat = |edge: Edge<'_>| {
        edge.opposite_vertex().is_some_and(|apex| {
            let [p, q] = [edge.from(), edge.to()].map(|vertex| position(cdt, vertex.fix()));
            let apex = position(cdt, apex.fix());
            let length = p.distance(q);
            let height = (q - p).perp_dot(apex - p) / length;
            let reach = p.abs().max(q.abs()).max_element();
            let between = (apex - p).dot(q - p) > 0.0 && (apex - q).dot(p - q) > 0.0;
            between && height <= (FINEST * length).max(ROUNDING * reach)
        })
    };
    let mut is_peeled = vec![false; cdt.num_all_faces()];
    let (mut border, mut peeled) = (Vec::new(), 0);
    let mut ahead: Vec<_> = cdt.convex_hull().map(|edge| edge.rev().fix()).collect();
    while let Some(edge) = ahead.pop() {
        let edge = cdt.directed_edge(edge);
        let Some(face) = edge.face().as_inner() else { continue };
        if is_peeled[face.index()] {
            continue;
        }
        if !edge.is_constraint_edge() && is_flat(edge) {
            is_peeled[face.index()] = true;
            peeled += 1;
            ahead.extend([edge.next().rev().fix(), edge.prev().rev().fix()]);
        } else {
            border.push(edge);
        }
    }
    if peeled as usize == cdt.num_inner_faces() {
        return (cdt.convex_hull().map(|edge| edge.as_undirected().fix()).collect(), 0);
    }
    border.retain(|edge| edge.face().as_inner().is_some_and(|face| !is_peeled[face.index()]));
    (border.into_iter().map(|edge| edge.as_undirected().fix()).collect(), peeled)
}

/// What is off a line by this part of its coordinates, or less, is off by rounding: some 64 units in the last place.
pub(super) const ROUNDING: f64 = 1.0 / (1u64 << 47) as f64;

/// Triangles whose shortest side is less than this part of the largest coordinate stay: their circumcentres would be noise.
pub(super) const FINEST: f64 = 1.0 / (1u64 << 40) as f64;
