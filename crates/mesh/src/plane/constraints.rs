//! Edges that a triangulation must keep.

use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::doubled_area;
use shapeloom_core::{ConvertError, Exec, Reservation};
use spade::Triangulation as _;
use spade::handles::FixedVertexHandle;

use super::error::PlaneError;
use super::hull_border::ROUNDING;
use super::location::locate;
use super::scale::flushed;
use super::triangulation::{Cdt, Mark, Triangulation, insert_near, position};

/// A constraint edge of the triangulation: a piece of a source edge, or of several that overlap there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Piece {
    /// The first of the source edges.
    pub(crate) source: u32,
    /// How many of them there are.
    pub(crate) copies: u32,
}

/// A vertex that was made where two edges cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crossing {
    /// The source edges.
    pub(crate) edges: [u32; 2],
    /// The vertex: a new one, or one that was at the place already.
    pub(crate) vertex: u32,
}

/// What became of the edges.
#[derive(Debug, Default)]
pub(crate) struct Constraints {
    /// The table that marks of constraint edges index.
    pub(crate) pieces: Vec<Piece>,
    /// Every crossing that was split, in the order of the source edges.
    pub(crate) crossings: Vec<Crossing>,
    /// Source edges that run over edges there already, in order.
    pub(crate) overlapping: Vec<u32>,
    /// Source edges between points at one place, in order.
    pub(crate) without_length: Vec<u32>,
    /// Source edges that were led through a vertex which they pass within rounding: each with the vertex.
    pub(crate) led_through: Vec<Crossing>,
    /// Source edges that another point lies on, in order.
    pub(crate) through_points: Vec<u32>,
    _memory: Vec<Reservation>,
}

/// A piece of a source edge that is still to be put in.
#[derive(Clone, Copy)]
struct Task {
    ends: [FixedVertexHandle; 2],
    piece: Piece,
}

/// How many pieces memory is reserved for at a time.
const BATCH: usize = 1024;
/// Memory for a piece and what a crossing adds to the triangulation.
const BYTES_A_PIECE: usize = 1024;

/// Makes edges between points constraints. Where one passes through a vertex it is split there; where two cross, both
/// are split at a new vertex in the crossing, rounded to the nearest numbers.
///
/// A piece that was rounded may cross another one by so little: it is split again, until nothing crosses. Where pieces cross
/// so near to an end of one that rounding could put the crossing on either side of it, no vertex is made: the other
/// piece is led through that end. So new vertices come from crossings that are more than rounding, of which rounding makes no
/// more, and pieces led through vertices that are there become shorter each time: this ends. Each step takes memory from
/// the budget all the same.
pub(crate) fn constrain(
    triangulation: &mut Triangulation,
    edges: &[[u32; 2]],
    exec: &Exec,
) -> Result<Constraints, ConvertError> {
    let mut done = Constraints::default();
    let mut tasks: Vec<Task> = Vec::new();
    for (source, ends) in (0u32..).zip(edges) {
        if source % 256 == 0 {
            exec.check()?;
            exec.progress(f64::from(source) / edges.len() as f64);
        }
        let ends = ends.map(|end| FixedVertexHandle::from_index(triangulation.vertex_of[end as usize] as usize));
        if ends[0] == ends[1] {
            done.without_length.push(source);
            continue;
        }
        tasks.push(Task { ends, piece: Piece { source, copies: 1 } });
        while let Some(task) = tasks.pop() {
            if done.pieces.len() + done.crossings.len() + done.led_through.len() >= BATCH * done._memory.len() {
                exec.check()?;
                done._memory.push(exec.reserve_elements(BATCH as u64, BYTES_A_PIECE)?);
            }
            put(&mut triangulation.cdt, task, source, &mut done, &mut tasks)?;
        }
    }
    Ok(done)
}

/// Puts one piece in, or splits it and what it crosses and leaves the parts as tasks.
fn put(
    cdt: &mut Cdt,
    Task { ends, piece }: Task,
    current: u32,
    done: &mut Constraints,
    tasks: &mut Vec<Task>,
) -> Result<(), ConvertError> {
    if ends[0] == ends[1] {
        return Ok(());
    }
    let conflict = cdt.get_conflicting_edges_between_vertices(ends[0], ends[1]).next();
    let Some(conflict) = conflict.map(|edge| edge.as_undirected().fix()) else {
        let before = cdt.num_constraints();
        let parts = cdt.try_add_constraint(ends[0], ends[1]);
        if parts.is_empty() {
            return Err(PlaneError::Edge { edge: u64::from(piece.source) }.into());
        }
        if parts.len() > 1 && done.through_points.last() != Some(&piece.source) && piece.source == current {
            done.through_points.push(piece.source);
        }
        let overlaps = cdt.num_constraints() - before < parts.len();
        if overlaps && piece.source == current && done.overlapping.last() != Some(&current) {
            done.overlapping.push(current);
        }
        for part in parts {
            claim(cdt, part.as_undirected(), piece, done);
        }
        return Ok(());
    };
    let others_ends = cdt.undirected_edge(conflict).vertices().map(|vertex| vertex.fix());
    let [a, b] = ends.map(|end| position(cdt, end));
    let [u, v] = others_ends.map(|end| position(cdt, end));
    let through = |through: FixedVertexHandle, [from, to]: [FixedVertexHandle; 2], piece: Piece| {
        [[from, through], [through, to]].map(|ends| Task { ends, piece })
    };
    if let Some(near) = others_ends.into_iter().find(|&end| passes_within_rounding([a, b], position(cdt, end), [u, v]))
    {
        done.led_through.push(Crossing { edges: [piece.source; 2], vertex: near.index() as u32 });
        tasks.extend(through(near, ends, piece).into_iter().rev());
        return Ok(());
    }
    let (other, _) = release(cdt, conflict, done);
    if let Some(near) = ends.into_iter().find(|&end| passes_within_rounding([u, v], position(cdt, end), [a, b])) {
        done.led_through.push(Crossing { edges: [other.source; 2], vertex: near.index() as u32 });
        tasks.push(Task { ends, piece });
        tasks.extend(through(near, others_ends, other));
        return Ok(());
    }
    let at = flushed(meeting_point([a, b], [u, v]));
    // A third edge on which the point comes to lie exactly is split there too.
    let third = match locate(cdt, at, others_ends[0]) {
        spade::PositionInTriangulation::OnEdge(edge) if cdt.is_constraint_edge(edge.as_undirected()) => {
            Some(release(cdt, edge.as_undirected(), done))
        }
        _ => None,
    };
    let vertex = insert_near(cdt, at, others_ends[0])?;
    let edges = [other.source.min(piece.source), other.source.max(piece.source)];
    done.crossings.push(Crossing { edges, vertex: vertex.index() as u32 });
    let split = [(ends, piece), (others_ends, other)].into_iter().chain(third.map(|(piece, ends)| (ends, piece)));
    // In reverse, so that parts of the current edge come first, from its start.
    let parts: Vec<Task> =
        split.flat_map(|([from, to], piece)| [[from, vertex], [vertex, to]].map(|ends| Task { ends, piece })).collect();
    tasks.extend(parts.into_iter().rev());
    Ok(())
}

/// Whether a segment passes between its ends an end of another one that it crosses, so closely that rounding the crossing
/// could put it on either side.
fn passes_within_rounding([p, q]: [DVec2; 2], end: DVec2, other: [DVec2; 2]) -> bool {
    let is_shorter = p.distance_squared(q) <= other[0].distance_squared(other[1]);
    let [from, to] = if is_shorter { [p, q] } else { other };
    let off = doubled_area(p, q, end).abs() / p.distance(q);
    let is_between = (end - p).dot(q - p) > 0.0 && (end - q).dot(p - q) > 0.0;
    is_between && off <= from.abs().max(to.abs()).max_element() * ROUNDING
}

/// Writes a piece on a constraint edge, on top of what is there.
fn claim(cdt: &mut Cdt, edge: spade::handles::FixedUndirectedEdgeHandle, piece: Piece, done: &mut Constraints) {
    let mark = cdt.undirected_edge_data_mut(edge).data_mut();
    // Edges that were no constraint until now may have the mark of one that is gone: pieces that are released are empty.
    match mark.index().and_then(|index| done.pieces.get_mut(index)).filter(|known| known.copies > 0) {
        Some(known) => {
            known.copies += piece.copies;
            known.source = known.source.min(piece.source);
        }
        None => {
            *mark = Mark::new(done.pieces.len());
            done.pieces.push(piece);
        }
    }
}

/// Takes a constraint off an edge: what it was, and its ends.
fn release(
    cdt: &mut Cdt,
    edge: spade::handles::FixedUndirectedEdgeHandle,
    done: &mut Constraints,
) -> (Piece, [FixedVertexHandle; 2]) {
    let ends = cdt.undirected_edge(edge).vertices().map(|vertex| vertex.fix());
    let data = cdt.undirected_edge_data_mut(edge).data_mut();
    let index = std::mem::take(data).index();
    let piece = index.and_then(|index| done.pieces.get_mut(index)).map_or(Piece { source: 0, copies: 1 }, |known| {
        let piece = *known;
        known.copies = 0;
        piece
    });
    cdt.remove_constraint_edge(edge);
    (piece, ends)
}

/// Where two segments that cross meet, rounded, within the boxes of both.
fn meeting_point(one: [DVec2; 2], other: [DVec2; 2]) -> DVec2 {
    // Along the shorter one, beside which the coordinates of the longer may be too large to tell places apart.
    let is_shorter = one[0].distance_squared(one[1]) <= other[0].distance_squared(other[1]);
    let ([a, b], [u, v]) = if is_shorter { (one, other) } else { (other, one) };
    let (from, to) = (doubled_area(u, v, a), doubled_area(u, v, b));
    // From the nearer end, where less is rounded.
    let met = match from.abs() <= to.abs() {
        true => a + (b - a) * (from / (from - to)),
        false => b + (a - b) * (to / (to - from)),
    };
    let low = a.min(b).max(u.min(v));
    let high = a.max(b).min(u.max(v));
    met.max(low).min(high)
}
