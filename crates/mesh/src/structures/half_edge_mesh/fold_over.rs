//! Whether an operator would turn a face over: what operators need to know of coordinates.

use shapeloom_core::glam::DVec3;

use super::{HalfEdgeMesh, Illegal, NONE};
use crate::structures::{EdgeId, FaceId, HalfEdgeId, VertexId};

/// Area, as a share of the square of a face's extent and for each corner, up to which it may come from rounding alone.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Legality in space, apart from the topological one: each of these answers only whether faces turn over, and expects
/// that the topological `can_` function said yes.
///
/// A face turns over when the cosine of the angle between its normals before and after is not above `min_cosine`: with
/// 0 it may turn by less than 90 degrees, with 0.5 by less than 60, below −1 by any angle; with NaN every face that an
/// operator changes turns over. A face without area is allowed to get some, or to
/// stay without; one with area must not lose it. Polygons have the normal of their Newell vector. Sizes from 1e-300 to
/// 1e300 are told rightly; where a position is not finite, every operator that would use it turns a face over.
///
/// `positions` has one for each vertex number; all panic where it is shorter. Cost: the corners of the faces around.
impl HalfEdgeMesh {
    /// Whether flipping an edge turns no face over: both new triangles must look to the side of their common vector
    /// area, which is that of the old two. In a plane that is so where the quadrilateral is strictly convex.
    ///
    /// # Errors
    /// No such inner edge between triangles, or the face that would turn over.
    pub fn flip_folds_over(&self, edge: EdgeId, positions: &[DVec3], min_cosine: f64) -> Result<(), Illegal> {
        self.one_each(positions);
        let [h, t] = self.inner_edge(edge)?;
        let [a, b, c, d] = [h, t, self.before(h), self.before(t)].map(|half| positions[self.start(half) as usize]);
        let whole = Direction::of([a, d, b, c].into_iter());
        let old = [[a, b, c], [b, a, d]].map(|corners| Direction::of(corners.into_iter()));
        let new = [[d, c, a], [c, d, b]].map(|corners| Direction::of(corners.into_iter()));
        let flat = |all: &[Direction]| all.iter().filter(|&&one| one == Direction::None).count();
        let mut spare = flat(&old);
        for (half, direction) in [h, t].into_iter().zip(new) {
            let flat_still = direction == Direction::None && spare > 0 && !min_cosine.is_nan();
            if flat_still {
                spare -= 1;
            } else if direction == Direction::None || !whole.admits(direction, min_cosine) || whole == Direction::None {
                return Err(Illegal::FoldsOver { face: FaceId(self.left(half)) });
            }
        }
        Ok(())
    }

    /// Whether collapsing a half-edge, with the vertex that stays moved `to` a place, turns no face over.
    ///
    /// # Errors
    /// No such half-edge, or the face that would turn over.
    pub fn collapse_folds_over(
        &self,
        half_edge: HalfEdgeId,
        positions: &[DVec3],
        to: DVec3,
        min_cosine: f64,
    ) -> Result<(), Illegal> {
        self.one_each(positions);
        self.known_half_edge(half_edge)?;
        let ends = [half_edge.0, half_edge.0 ^ 1].map(|half| self.start(half));
        for side in ends.iter().flat_map(|&end| self.fan(end)) {
            let face = self.left(side.0);
            let edge = half_edge.0 >> 1;
            // A polygon with both ends is looked at once; triangles vanish.
            let vanishes = side.0 >> 1 == edge && self.has_sides(side.0, 3);
            if face == NONE || vanishes || self.before(side.0) >> 1 == edge {
                continue;
            }
            let at = |half: HalfEdgeId| positions[self.start(half.0) as usize];
            // A polygon beside the edge has both ends; as one place twice they add nothing to its area.
            let moved = |half: HalfEdgeId| if ends.contains(&self.start(half.0)) { to } else { at(half) };
            let old = Direction::of(self.cycle(side.0).map(at));
            let new = Direction::of(self.cycle(side.0).map(moved));
            if !old.admits(new, min_cosine) {
                return Err(Illegal::FoldsOver { face: FaceId(face) });
            }
        }
        Ok(())
    }

    /// Whether splitting an edge, with the new vertex at a place, turns no face over.
    ///
    /// # Errors
    /// No such edge, or the face a part of which would turn over.
    pub fn split_edge_folds_over(
        &self,
        edge: EdgeId,
        positions: &[DVec3],
        at: DVec3,
        min_cosine: f64,
    ) -> Result<(), Illegal> {
        self.one_each(positions);
        self.known_edge(edge)?;
        for half in [2 * edge.0, 2 * edge.0 + 1].into_iter().filter(|&half| self.left(half) != NONE) {
            let place = |side: HalfEdgeId| positions[self.start(side.0) as usize];
            let old = Direction::of(self.cycle(half).map(place));
            let outline: Vec<DVec3> = self.cycle(half).map(place).collect();
            let good = if let &[a, b, c] = outline.as_slice() {
                [[a, at, c], [at, b, c]].into_iter().all(|part| old.admits(Direction::of(part.into_iter()), min_cosine))
            } else {
                let first = std::iter::once(outline[0]);
                let all = first.chain(std::iter::once(at)).chain(outline[1..].iter().copied());
                old.admits(Direction::of(all), min_cosine)
            };
            if !good {
                return Err(Illegal::FoldsOver { face: FaceId(self.left(half)) });
            }
        }
        Ok(())
    }

    /// Whether splitting a face, with the new vertex at a place, turns no part of it over.
    ///
    /// # Errors
    /// No such face, or the face itself.
    pub fn split_face_folds_over(
        &self,
        face: FaceId,
        positions: &[DVec3],
        at: DVec3,
        min_cosine: f64,
    ) -> Result<(), Illegal> {
        self.one_each(positions);
        self.known_face(face)?;
        let place = |half: u32| positions[self.start(half) as usize];
        let old = Direction::of(self.around_face(face).map(|side| place(side.0)));
        let part = |side: HalfEdgeId| Direction::of([place(side.0), place(side.0 ^ 1), at].into_iter());
        if self.around_face(face).all(|side| old.admits(part(side), min_cosine)) {
            Ok(())
        } else {
            Err(Illegal::FoldsOver { face })
        }
    }

    /// Whether removing a vertex turns no face over: each face around it must look to the side of the vector area of
    /// the hole's outline, and so must each of the triangles that fill it; none are given where it stays a polygon.
    ///
    /// # Errors
    /// No such vertex, or a face around it that would turn over; where a triangle would, the first face around it.
    pub(crate) fn removal_folds_over(
        &self,
        vertex: VertexId,
        positions: &[DVec3],
        ears: &[[u32; 3]],
        min_cosine: f64,
    ) -> Result<(), Illegal> {
        self.one_each(positions);
        self.known_vertex(vertex)?;
        let outline: Vec<DVec3> = self.hole_corners(vertex.0).iter().map(|&v| positions[v as usize]).collect();
        let whole = Direction::of(outline.iter().copied());
        let mut around = self.fan(vertex.0).map(|out| (out, self.left(out.0))).filter(|&(_, face)| face != NONE);
        let first = around.clone().next();
        let turned = around.find(|(out, _)| {
            let old = Direction::of(self.cycle(out.0).map(|side| positions[self.start(side.0) as usize]));
            !old.admits(whole, min_cosine)
        });
        let part = |ear: &[u32; 3]| Direction::of(ear.map(|i| outline[i as usize]).into_iter());
        let fills = || ears.iter().all(|ear| whole.admits(part(ear), min_cosine));
        // An ear is no part of one face: the first stands for all.
        match turned.or_else(|| first.filter(|_| !fills())) {
            Some((_, face)) => Err(Illegal::FoldsOver { face: FaceId(face) }),
            None => Ok(()),
        }
    }

    fn one_each(&self, positions: &[DVec3]) {
        let (found, expected) = (positions.len(), self.vertex_slots());
        assert!(found >= expected, "found {found} positions, expected one for each of {expected} vertices");
    }
}

/// Where an outline looks.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Direction {
    /// Along this unit vector.
    Along(DVec3),
    /// Nowhere: it has no area but what rounding may have given it.
    None,
    /// Not known: a position is not finite.
    Unknown,
}

impl Direction {
    fn of(outline: impl Iterator<Item = DVec3> + Clone) -> Self {
        let Some(first) = outline.clone().next() else { return Self::None };
        let spokes = outline.map(|corner| corner - first);
        let (mut size, mut count, mut finite) = (0.0f64, 0.0, true);
        for spoke in spokes.clone() {
            finite &= spoke.is_finite();
            size = size.max(spoke.abs().max_element());
            count += 1.0;
        }
        if !finite {
            return Self::Unknown;
        }
        if size == 0.0 {
            return Self::None;
        }
        // As large as one, so that products neither overflow nor vanish.
        let spokes = spokes.map(|spoke| spoke / size);
        let area: DVec3 = spokes.clone().zip(spokes.skip(1)).map(|(a, b)| a.cross(b)).sum();
        let length = area.length();
        if length <= ROUNDING * count { Self::None } else { Self::Along(area / length) }
    }

    /// Whether a face that looked here may come to look there.
    fn admits(self, new: Self, min_cosine: f64) -> bool {
        if min_cosine.is_nan() {
            return false;
        }
        match (self, new) {
            (Self::Unknown, _) | (_, Self::Unknown) => false,
            (Self::None, _) => true,
            (Self::Along(_), Self::None) => false,
            (Self::Along(old), Self::Along(new)) => old.dot(new) > min_cosine,
        }
    }
}
