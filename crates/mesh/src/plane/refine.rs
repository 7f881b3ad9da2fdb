//! Better triangles by more vertices.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::{in_circle, orient2d};
use shapeloom_core::{ConvertError, Exec, Reservation};
use spade::handles::{FixedUndirectedEdgeHandle, FixedVertexHandle};
use spade::{PositionInTriangulation, Triangulation as _};

use super::error::PlaneError;
use super::hull_border::{FINEST, border};
use super::inside::{Edge, inside};
use super::location::locate;
use super::scale::{exponent_of, flushed};
use super::triangle_shape::{Shape, circumcenter};
use super::triangulation::{Cdt, Mark, Triangulation, insert_near, position};

/// What is asked of the triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// The square of the sine of the smallest angle; 0 for any.
    pub(crate) sine_squared: f64,
    /// No area larger than the square of this, in the triangulation's scale; infinite for any.
    pub(crate) side: f64,
    /// How many vertices may be added.
    pub(crate) most: u32,
    /// Whether constraint edges may be split.
    pub(crate) split_edges: bool,
}

/// What was reached.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Reached {
    pub(crate) added: u32,
    /// How many of these split constraint edges.
    pub(crate) on_edges: u32,
    /// Whether the limit on added vertices ended it.
    pub(crate) out_of_vertices: bool,
    /// Triangles that stay as they are because they lie between edges that meet in a small angle.
    pub(crate) at_small_angles: u64,
    /// Triangles that could be improved only by splitting edges that must not be.
    pub(crate) blocked: u64,
    /// Triangles so small that numbers do not tell their parts apart.
    pub(crate) too_small: u64,
    /// Triangles at the hull that are too flat to be anything but rounding, and are left out.
    pub(crate) peeled: u64,
}

/// An edge that stays where it is, though it may be split.
#[derive(Clone, Copy, Debug)]
struct Segment {
    /// Its ends, as they were before it was split.
    ends: [FixedVertexHandle; 2],
    /// Whether it bounds the region that is refined, rather than being a constraint alone.
    is_wall: bool,
    /// Whether it may be split.
    may_split: bool,
}

/// A constraint edge of the triangulation that is refined: a piece of a segment.
#[derive(Clone, Copy, Debug)]
struct Piece {
    segment: u32,
    /// Whether the triangles to its left are to be refined, and those to its right, as seen from its end of smaller index.
    inside: [bool; 2],
}

const NONE: u32 = u32::MAX;

/// How many vertices the box around a triangulation has; they come before those that are added.
pub(crate) const BOX: usize = 4;

/// Delaunay refinement (Ruppert 1995): a vertex is inserted in the circumcentre of the worst triangle, or where that would
/// come too near to an edge that must stay, the edge is split.
///
/// Edges that meet in a small angle are split at distances from it that are powers of two, so that their pieces do not
/// force each other to be split without end, and triangles between them stay (Shewchuk 2002; Miller, Pav and Walkington 2003).
pub(crate) struct Refinement<'a> {
    cdt: &'a mut Cdt,
    wanted: Wanted,
    /// Sides that are no longer than this stay as they are.
    finest: f64,
    segments: Vec<Segment>,
    pieces: Vec<Piece>,
    /// The segment that each vertex was put on, or none.
    on_segment: Vec<u32>,
    /// For each added vertex, one not far from it that was there before.
    beside: Vec<FixedVertexHandle>,
    /// Of the vertices that were there before: whether two segments meet there in less than 60 degrees.
    is_acute: Vec<bool>,
    edges: VecDeque<[FixedVertexHandle; 2]>,
    triangles: BinaryHeap<Reverse<(u64, u64, [FixedVertexHandle; 3])>>,
    pushed: u64,
    reached: Reached,
    memory: Vec<Reservation>,
}

impl<'a> Refinement<'a> {
    /// Prepares a triangulation: its hull and its constraint edges become segments, and a box is put around it, so that
    /// the hull is an edge like others. If `whole`, everything within the hull is refined, else what the constraint
    /// edges enclose.
    pub(crate) fn prepare(
        triangulation: &'a mut Triangulation,
        whole: bool,
        wanted: Wanted,
        exec: &Exec,
    ) -> Result<Self, ConvertError> {
        let cdt = &mut triangulation.cdt;
        let ends = |edge: FixedUndirectedEdgeHandle, cdt: &Cdt| cdt.undirected_edge(edge).vertices().map(|v| v.fix());
        let mut segments = Vec::new();
        let own: Vec<_> =
            cdt.undirected_edges().filter(|edge| edge.is_constraint_edge()).map(|edge| edge.fix()).collect();
        for edge in own {
            *cdt.undirected_edge_data_mut(edge).data_mut() = Mark::new(segments.len());
            segments.push(Segment { ends: ends(edge, cdt), is_wall: !whole, may_split: wanted.split_edges });
        }
        let mut peeled = 0;
        if whole {
            let (edges, flat) = border(cdt);
            peeled = flat;
            for edge in edges {
                if !cdt.is_constraint_edge(edge) {
                    let [from, to] = ends(edge, cdt);
                    cdt.try_add_constraint(from, to);
                    *cdt.undirected_edge_data_mut(edge).data_mut() = Mark::new(segments.len());
                    segments.push(Segment { ends: [from, to], is_wall: true, may_split: true });
                } else if let Some(index) = cdt.undirected_edge(edge).data().data().index() {
                    segments[index].is_wall = true;
                }
            }
        }
        let before = cdt.num_vertices();
        let (low, high) = cdt
            .vertices()
            .map(|vertex| vertex.position())
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
                (low.min(DVec2::new(p.x, p.y)), high.max(DVec2::new(p.x, p.y)))
            });
        let far = 3.0 * (high - low).max_element();
        let corners: [DVec2; BOX] =
            [low - far, DVec2::new(high.x + far, low.y - far), high + far, DVec2::new(low.x - far, high.y + far)];
        for corner in corners {
            insert_near(cdt, corner, FixedVertexHandle::from_index(0))?;
        }
        let pieces = (0..segments.len() as u32).map(|segment| Piece { segment, inside: [false; 2] }).collect();
        let is_acute = (0..before).map(|vertex| is_acute(cdt, FixedVertexHandle::from_index(vertex))).collect();
        let mut prepared = Self {
            wanted,
            finest: low.abs().max(high.abs()).max_element() * FINEST,
            segments,
            pieces,
            on_segment: vec![NONE; cdt.num_vertices()],
            beside: Vec::new(),
            is_acute,
            edges: VecDeque::new(),
            triangles: BinaryHeap::new(),
            pushed: 0,
            reached: Reached { peeled, ..Reached::default() },
            memory: Vec::new(),
            cdt,
        };
        let inside = prepared.inside(exec)?;
        let sides: Vec<_> = prepared
            .cdt
            .undirected_edges()
            .filter(|edge| edge.is_constraint_edge())
            .map(|edge| {
                let edge = upward(edge.as_directed());
                let sides = [edge, edge.rev()].map(|side| inside[side.face().fix().index()]);
                (edge.as_undirected().data().data().index(), sides)
            })
            .collect();
        for (index, sides) in sides {
            if let Some(piece) = index.and_then(|index| prepared.pieces.get_mut(index)) {
                piece.inside = sides;
            }
        }
        Ok(prepared)
    }

    /// Which triangles are to be refined, by the number of the face.
    pub(crate) fn inside(&self, exec: &Exec) -> Result<Vec<bool>, ConvertError> {
        Ok(inside(self.cdt, exec, |edge| self.piece(edge).is_some_and(|piece| self.segment(piece).is_wall))?)
    }

    pub(crate) fn cdt(&self) -> &Cdt {
        self.cdt
    }

    /// For each added vertex, one not far from it that was there before, or a corner of the box.
    pub(crate) fn beside(&self) -> &[FixedVertexHandle] {
        &self.beside
    }

    fn piece(&self, edge: Edge<'_>) -> Option<Piece> {
        let index = edge.is_constraint_edge().then(|| edge.as_undirected().data().data().index());
        index.flatten().and_then(|index| self.pieces.get(index)).copied()
    }

    fn segment(&self, piece: Piece) -> Segment {
        self.segments[piece.segment as usize]
    }

    /// Whether the triangle to the left of a constraint edge is to be refined.
    fn is_inside_left(&self, edge: Edge<'_>) -> bool {
        let right = edge.from().index() > edge.to().index();
        self.piece(edge).is_some_and(|piece| piece.inside[usize::from(right)])
    }

    /// Refines as far as wanted and possible.
    pub(crate) fn run(&mut self, exec: &Exec) -> Result<Reached, ConvertError> {
        loop {
            let before = self.reached.added;
            self.sweep(exec)?;
            self.work_off(exec)?;
            // Triangles that changed elsewhere are found by another sweep; one that adds nothing is the last.
            if self.reached.out_of_vertices || self.reached.added == before {
                return Ok(self.reached);
            }
        }
    }

    /// Looks at everything.
    fn sweep(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        let inside = self.inside(exec)?;
        self.reached = Reached { at_small_angles: 0, blocked: 0, too_small: 0, ..self.reached };
        let edges: Vec<_> = self
            .cdt
            .undirected_edges()
            .filter(|edge| edge.is_constraint_edge())
            .map(|edge| edge.vertices().map(|vertex| vertex.fix()))
            .collect();
        self.edges.extend(edges);
        let faces: Vec<_> = self
            .cdt
            .inner_faces()
            .filter(|face| inside[face.fix().index()])
            .map(|face| face.vertices().map(|vertex| vertex.fix()))
            .collect();
        for face in faces {
            self.judge(face);
        }
        Ok(())
    }

    fn work_off(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        const BATCH: usize = 1024;
        for step in 0u64.. {
            if step % 64 == 0 {
                exec.check()?;
                exec.progress(f64::from(self.reached.added) / f64::from(self.wanted.most.max(1)));
            }
            if self.reached.added as usize >= BATCH * self.memory.len() {
                self.memory.push(exec.reserve(Triangulation::bytes(BATCH))?);
            }
            let spent = self.reached.added >= self.wanted.most;
            if let Some(ends) = self.edges.pop_front() {
                if self.is_encroached(ends) {
                    if spent {
                        self.reached.out_of_vertices = true;
                        return Ok(());
                    }
                    self.split(ends)?;
                }
            } else if let Some(Reverse((_, _, triangle))) = self.triangles.pop() {
                if self.is_there(triangle) {
                    if spent {
                        self.reached.out_of_vertices = true;
                        return Ok(());
                    }
                    self.improve(triangle)?;
                }
            } else {
                break;
            }
        }
        Ok(())
    }

    fn corners(&self, triangle: [FixedVertexHandle; 3]) -> [DVec2; 3] {
        triangle.map(|vertex| position(self.cdt, vertex))
    }

    /// Notes a triangle if it is not as wanted: the one with the smallest angle comes first.
    fn judge(&mut self, triangle: [FixedVertexHandle; 3]) {
        let shape = Shape::of(self.corners(triangle));
        if self.is_too_large(&shape) || self.is_too_sharp(&shape) {
            self.pushed += 1;
            self.triangles.push(Reverse((shape.sine_squared.to_bits(), self.pushed, triangle)));
        }
    }

    fn is_too_large(&self, shape: &Shape) -> bool {
        shape.side > self.wanted.side
    }

    fn is_too_sharp(&self, shape: &Shape) -> bool {
        shape.sine_squared < self.wanted.sine_squared
    }

    fn is_there(&self, [a, b, c]: [FixedVertexHandle; 3]) -> bool {
        let edge = self.cdt.get_edge_from_neighbors(a, b);
        edge.and_then(|edge| edge.opposite_vertex()).is_some_and(|vertex| vertex.fix() == c)
    }

    /// Whether a triangle to be refined beside an edge has its third corner within the circle on the edge.
    fn is_encroached(&self, [a, b]: [FixedVertexHandle; 2]) -> bool {
        let Some(edge) = self.cdt.get_edge_from_neighbors(a, b) else { return false };
        let Some(piece) = self.piece(edge).filter(|&piece| self.segment(piece).may_split) else { return false };
        let [p, q] = [a, b].map(|vertex| position(self.cdt, vertex));
        let within = |side: Edge<'_>| {
            let apex = side.opposite_vertex().filter(|_| self.is_inside_left(side));
            apex.is_some_and(|apex| is_within(position(self.cdt, apex.fix()), p, q))
        };
        piece.inside.contains(&true) && [edge, edge.rev()].into_iter().any(within)
    }

    /// Splits a piece of a segment; false if there is no number between its ends that will do.
    fn split(&mut self, [a, b]: [FixedVertexHandle; 2]) -> Result<bool, ConvertError> {
        let Some(edge) = self.cdt.get_edge_from_neighbors(a, b) else { return Ok(false) };
        let Some(piece) = self.piece(edge).filter(|&piece| self.segment(piece).may_split) else { return Ok(false) };
        let at = flushed(self.split_point([a, b], self.segment(piece)));
        let [p, q] = [a, b].map(|vertex| position(self.cdt, vertex));
        // Rounded, the point may lie beside the edge, but it must lie within the triangles at the edge's sides.
        let within = |side: Edge<'_>| {
            side.opposite_vertex().is_some_and(|apex| {
                let apex = position(self.cdt, apex.fix());
                let [from, to] = [side.from(), side.to()].map(|vertex| position(self.cdt, vertex.fix()));
                orient2d(to, apex, at).is_gt() && orient2d(apex, from, at).is_gt()
            })
        };
        if p.distance(q) <= self.finest || at == p || at == q || ![edge, edge.rev()].into_iter().all(within) {
            self.reached.too_small += 1;
            return Ok(false);
        }
        let (edge, lost) = (edge.as_undirected().fix(), PlaneError::Edge { edge: u64::from(piece.segment) });
        self.cdt.remove_constraint_edge(edge);
        let vertex = insert_near(self.cdt, at, a)?;
        if vertex.index() != self.on_segment.len() {
            return Err(lost.into());
        }
        self.on_segment.push(piece.segment);
        let is_upward = a.index() < b.index();
        for [from, to] in [[a, vertex], [vertex, b]] {
            let [part] = self.cdt.try_add_constraint(from, to)[..] else { return Err(lost.into()) };
            let [left, right] = piece.inside;
            let inside = if is_upward == (from.index() < to.index()) { [left, right] } else { [right, left] };
            *self.cdt.undirected_edge_data_mut(part.as_undirected()).data_mut() = Mark::new(self.pieces.len());
            self.pieces.push(Piece { inside, ..piece });
            self.edges.push_back([from, to]);
        }
        self.reached.on_edges += 1;
        self.added(vertex, a);
        Ok(true)
    }

    /// The middle of a piece; if one of its ends is where segments meet in a small angle, a point about there whose distance
    /// from that end is a power of two.
    fn split_point(&self, [a, b]: [FixedVertexHandle; 2], segment: Segment) -> DVec2 {
        let is_apex = |vertex: FixedVertexHandle| {
            segment.ends.contains(&vertex) && self.is_acute.get(vertex.index()).copied().unwrap_or(false)
        };
        let [p, q] = [a, b].map(|vertex| position(self.cdt, vertex));
        let (from, to) = match (is_apex(a), is_apex(b)) {
            (true, false) => (p, q),
            (false, true) => (q, p),
            _ => return p + (q - p) * 0.5,
        };
        let length = from.distance(to);
        // From a third of the length, without it, to two thirds.
        let shell = 2f64.powi(exponent_of(length * (2.0 / 3.0)));
        from + (to - from) * (shell / length)
    }

    /// Puts a vertex into the circumcentre of a triangle, or splits the edges that are in the way.
    fn improve(&mut self, triangle: [FixedVertexHandle; 3]) -> Result<(), ConvertError> {
        let corners = self.corners(triangle);
        let shape = Shape::of(corners);
        if !self.is_too_large(&shape) && self.is_at_small_angle(triangle, shape.shortest) {
            self.reached.at_small_angles += 1;
            return Ok(());
        }
        let center = circumcenter(corners).filter(|_| shape.shortest_squared.sqrt() > self.finest);
        let Some(center) = center else {
            self.reached.too_small += 1;
            return Ok(());
        };
        let Some((near, in_the_way)) = self.in_the_way(triangle, corners, center) else {
            self.reached.too_small += 1;
            return Ok(());
        };
        if in_the_way.is_empty() {
            let vertex = insert_near(self.cdt, center, near)?;
            if vertex.index() != self.on_segment.len() {
                self.reached.too_small += 1;
                return Ok(());
            }
            self.on_segment.push(NONE);
            self.added(vertex, near);
            return Ok(());
        }
        let may_split = |&[a, b]: &[FixedVertexHandle; 2]| {
            let piece = self.cdt.get_edge_from_neighbors(a, b).and_then(|edge| self.piece(edge));
            piece.is_some_and(|piece| self.segment(piece).may_split)
        };
        let may: Vec<_> = in_the_way.into_iter().filter(may_split).collect();
        if may.is_empty() {
            self.reached.blocked += 1;
            return Ok(());
        }
        let mut any = false;
        for ends in may {
            any |= self.reached.added < self.wanted.most && self.split(ends)?;
        }
        if any && self.is_there(triangle) {
            self.judge(triangle);
        }
        Ok(())
    }

    /// Whether the shortest side of a triangle joins two segments that meet in one end.
    fn is_at_small_angle(&self, triangle: [FixedVertexHandle; 3], shortest: usize) -> bool {
        let segment = |corner: usize| {
            let on = self.on_segment[triangle[corner % 3].index()];
            self.segments.get(on as usize).map(|segment| (on, segment.ends))
        };
        match (segment(shortest), segment(shortest + 1)) {
            (Some((one, ends)), Some((other, others))) => one != other && ends.iter().any(|end| others.contains(end)),
            _ => false,
        }
    }

    /// A vertex near the circumcentre of a triangle, and the constraint edge between the two, or else those that the centre is
    /// too near to; none at all if rounding hides where the centre lies.
    fn in_the_way(
        &self,
        triangle: [FixedVertexHandle; 3],
        corners: [DVec2; 3],
        center: DVec2,
    ) -> Option<(FixedVertexHandle, Vec<[FixedVertexHandle; 2]>)> {
        let ends = |edge: Edge<'_>| [edge.from().fix(), edge.to().fix()];
        let (hint, blocking) = self.walk(triangle, (corners[0] + corners[1] + corners[2]) / 3.0, center)?;
        if let Some(edge) = blocking {
            return Some((hint, vec![edge]));
        }
        let mut cavity = Vec::new();
        match locate(self.cdt, center, hint) {
            PositionInTriangulation::OnFace(face) => cavity.push(face),
            PositionInTriangulation::OnEdge(edge) => {
                let edge = self.cdt.directed_edge(edge);
                if edge.is_constraint_edge() {
                    return Some((hint, vec![ends(edge)]));
                }
                cavity.extend([edge, edge.rev()].into_iter().filter_map(|side| side.face().fix().as_inner()));
            }
            _ => return None,
        }
        let mut near = Vec::new();
        let mut next = 0;
        let mut found = false;
        while let Some(&face) = cavity.get(next) {
            next += 1;
            let face = self.cdt.face(face);
            found |= face.vertices().iter().all(|vertex| triangle.contains(&vertex.fix()));
            for edge in face.adjacent_edges() {
                let [p, q] = [edge.from(), edge.to()].map(|vertex| position(self.cdt, vertex.fix()));
                if edge.is_constraint_edge() {
                    if is_within(center, p, q) {
                        near.push(ends(edge));
                    }
                    continue;
                }
                let over = edge.rev();
                let (Some(face), Some(apex)) = (over.face().as_inner(), over.opposite_vertex()) else { continue };
                if !cavity.contains(&face.fix()) && in_circle(q, p, position(self.cdt, apex.fix()), center).is_gt() {
                    cavity.push(face.fix());
                }
            }
        }
        found.then_some((hint, near))
    }

    /// Goes straight from a place in a triangle to another place: a vertex of the triangle where that ends, and the constraint
    /// edge that ends it, if one does. None if rounding hides the way.
    fn walk(
        &self,
        [a, b, _]: [FixedVertexHandle; 3],
        from: DVec2,
        to: DVec2,
    ) -> Option<(FixedVertexHandle, Option<[FixedVertexHandle; 2]>)> {
        let ends = |edge: Edge<'_>| [edge.from().fix(), edge.to().fix()];
        let is_beyond = |edge: Edge<'_>| {
            let [p, q] = ends(edge).map(|vertex| position(self.cdt, vertex));
            orient2d(p, q, to).is_lt()
        };
        let is_left = |vertex: FixedVertexHandle| orient2d(from, to, position(self.cdt, vertex)).is_gt();
        let first = self.cdt.get_edge_from_neighbors(a, b)?;
        let sides = [first, first.next(), first.prev()];
        if !sides.into_iter().any(is_beyond) {
            return Some((a, None));
        }
        // The way leaves between a corner on its right and one on its left.
        let leaves = |&edge: &Edge<'_>| {
            let [right, left] = ends(edge).map(is_left);
            !right && left && is_beyond(edge)
        };
        let mut edge = sides.into_iter().find(leaves)?;
        for _ in 0..self.cdt.num_inner_faces() {
            if edge.is_constraint_edge() {
                return Some((edge.from().fix(), Some(ends(edge))));
            }
            let over = edge.rev();
            let apex = over.opposite_vertex()?.fix();
            edge = if is_left(apex) { over.next() } else { over.prev() };
            if !is_beyond(edge) {
                return Some((apex, None));
            }
        }
        None
    }

    /// Counts a new vertex, which lies near another one, and looks at the triangles and edges around it.
    fn added(&mut self, vertex: FixedVertexHandle, near: FixedVertexHandle) {
        self.reached.added += 1;
        let first = self.on_segment.len() - self.beside.len() - 1;
        self.beside
            .push(near.index().checked_sub(first).and_then(|added| self.beside.get(added)).copied().unwrap_or(near));
        let mut around: Vec<Edge<'_>> = Vec::new();
        if let Some(first) = self.cdt.vertex(vertex).out_edge() {
            let mut edge = first;
            loop {
                around.push(edge);
                edge = edge.ccw();
                if edge == first {
                    break;
                }
            }
        }
        let first = around.iter().position(|edge| edge.is_constraint_edge()).unwrap_or(0);
        around.rotate_left(first);
        let mut is_inside = true;
        let (mut faces, mut edges) = (Vec::new(), Vec::new());
        for edge in around {
            if edge.is_constraint_edge() {
                is_inside = self.is_inside_left(edge);
            }
            if let (true, Some(face)) = (is_inside, edge.face().as_inner()) {
                faces.push(face.vertices().map(|vertex| vertex.fix()));
                let across = edge.next();
                if across.is_constraint_edge() {
                    edges.push([across.from().fix(), across.to().fix()]);
                }
            }
        }
        faces.into_iter().for_each(|face| self.judge(face));
        self.edges.extend(edges);
    }
}

/// The edge in the direction that rises from the vertex of smaller index.
fn upward(edge: Edge<'_>) -> Edge<'_> {
    if edge.from().index() < edge.to().index() { edge } else { edge.rev() }
}

/// Whether a point lies within the circle that has `p` and `q` as its diameter.
fn is_within(point: DVec2, p: DVec2, q: DVec2) -> bool {
    (p - point).dot(q - point) < 0.0
}

/// Whether two neighbouring constraint edges leave a vertex in less than 60 degrees.
fn is_acute(cdt: &Cdt, vertex: FixedVertexHandle) -> bool {
    let Some(first) = cdt.vertex(vertex).out_edge() else { return false };
    let at = position(cdt, vertex);
    let mut directions = Vec::new();
    let mut edge = first;
    loop {
        if edge.is_constraint_edge() {
            directions.push(position(cdt, edge.to().fix()) - at);
        }
        edge = edge.ccw();
        if edge == first {
            break;
        }
    }
    let count = directions.len();
    count > 1
        && (0..count).any(|k| {
            let (a, b) = (directions[k], directions[(k + 1) % count]);
            a.perp_dot(b) > 0.0 && a.dot(b) > 0.5 * a.length() * b.length()
        })
}
