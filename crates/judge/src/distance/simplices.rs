//! What distances are measured between.

use std::borrow::Cow;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Exec};
use shapeloom_mesh::{GeometricGraph, PointCloud, Polyline, TriMesh};

use super::SimplexCells;
use crate::JudgeError;

/// Triangles, segments and points, by the corners of triangles: `[a, b, b]` is the segment from `a` to `b`, `[p, p, p]`
/// the point `p`. Triangles without area count as what they are.
///
/// Positions that no triangle names may be anything and count for nothing.
#[derive(Clone, Debug)]
pub struct Simplices<'a> {
    /// Corners, in model units.
    pub positions: Cow<'a, [DVec3]>,
    /// Indices into the positions.
    pub triangles: Cow<'a, [[u32; 3]]>,
}

impl<'a> Simplices<'a> {
    /// Triangles by index triples into positions.
    pub fn new(positions: impl Into<Cow<'a, [DVec3]>>, triangles: impl Into<Cow<'a, [[u32; 3]]>>) -> Self {
        Self { positions: positions.into(), triangles: triangles.into() }
    }

    /// Each position as a point.
    pub fn points(positions: impl Into<Cow<'a, [DVec3]>>) -> Self {
        let positions = positions.into();
        let triangles: Vec<[u32; 3]> = (0..positions.len() as u32).map(|point| [point; 3]).collect();
        Self { positions, triangles: triangles.into() }
    }

    /// Segments between pairs of positions.
    pub fn segments(positions: impl Into<Cow<'a, [DVec3]>>, segments: &[[u32; 2]]) -> Self {
        let triangles: Vec<[u32; 3]> = segments.iter().map(|&[a, b]| [a, b, b]).collect();
        Self { positions: positions.into(), triangles: triangles.into() }
    }

    /// The shape as about `count` cells, at least one for each element, for [`distance_from_samples`](super::distance_from_samples).
    ///
    /// # Errors
    /// As [`SimplexCells::new`].
    pub fn cells(&self, count: u32, exec: &Exec) -> Result<SimplexCells<'_>, JudgeError> {
        SimplexCells::new(self, count, exec)
    }

    /// The box around all that is named; empty without triangles. Indices out of range are passed over.
    pub fn bounds(&self) -> Aabb {
        let corners = self.triangles.iter().flatten();
        Aabb::from_points(corners.filter_map(|&corner| self.positions.get(corner as usize).copied()))
    }
}

impl<'a> From<&'a TriMesh> for Simplices<'a> {
    fn from(mesh: &'a TriMesh) -> Self {
        Self::new(mesh.positions(), mesh.triangles())
    }
}

impl<'a> From<&'a PointCloud> for Simplices<'a> {
    fn from(cloud: &'a PointCloud) -> Self {
        Self::points(cloud.positions())
    }
}

impl<'a> From<&'a GeometricGraph> for Simplices<'a> {
    fn from(graph: &'a GeometricGraph) -> Self {
        Self::segments(graph.positions(), graph.edges())
    }
}

impl<'a> From<&'a Polyline> for Simplices<'a> {
    /// The segments; a polyline of one point is that point.
    fn from(line: &'a Polyline) -> Self {
        let count = line.points().len() as u32;
        if count == 1 {
            return Self::points(line.points());
        }
        let mut segments: Vec<[u32; 2]> = (1..count).map(|end| [end - 1, end]).collect();
        if line.is_closed() && count > 1 {
            segments.push([count - 1, 0]);
        }
        Self::segments(line.points(), &segments)
    }
}
