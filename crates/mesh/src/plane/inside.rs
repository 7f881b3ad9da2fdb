//! Which triangles are inside.

use std::collections::VecDeque;

use shapeloom_core::{Exec, Stop};
use spade::Triangulation as _;
use spade::handles::DirectedEdgeHandle;

use super::triangulation::{Cdt, Mark};

pub(crate) type Edge<'a> = DirectedEdgeHandle<'a, spade::Point2<f64>, (), spade::CdtEdge<Mark>, ()>;

/// Whether each triangle is inside, by the number of its face: seen from infinity, the smallest number of walls that a way
/// to it crosses is odd.
///
/// Where walls are closed loops this is the even-odd rule. A wall with the same triangles to both sides, such as one that
/// ends somewhere, encloses nothing. Cost: linear.
pub(crate) fn inside(cdt: &Cdt, exec: &Exec, is_wall: impl Fn(Edge<'_>) -> bool) -> Result<Vec<bool>, Stop> {
    const UNSEEN: u32 = u32::MAX;
    let mut depth = vec![UNSEEN; cdt.num_all_faces()];
    let outer = cdt.outer_face().fix().index();
    depth[outer] = 0;
    // Edges to step over, with the depth on their left: those that are no wall first, so that depths rise.
    let mut ahead = VecDeque::new();
    let add = |ahead: &mut VecDeque<_>, edge: Edge<'_>, depth: u32| match is_wall(edge) {
        true => ahead.push_back((edge.fix(), depth + 1)),
        false => ahead.push_front((edge.fix(), depth)),
    };
    cdt.convex_hull().for_each(|edge| add(&mut ahead, edge, 0));
    let mut work = 0;
    while let Some((edge, here)) = ahead.pop_front() {
        if work % 4096 == 0 {
            exec.check()?;
        }
        work += 1;
        let over = cdt.directed_edge(edge).rev();
        let Some(face) = over.face().as_inner() else { continue };
        let known = &mut depth[face.index()];
        if *known > here {
            *known = here;
            add(&mut ahead, over.next(), here);
            add(&mut ahead, over.prev(), here);
        }
    }
    Ok(depth.into_iter().map(|depth| depth != UNSEEN && depth % 2 == 1).collect())
}
