//! The Delaunay triangulation of points, on spade.

use std::panic::{AssertUnwindSafe, catch_unwind};

use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::orient2d;
use shapeloom_core::{ConvertError, Exec};
use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

use super::error::PlaneError;
use super::location::{locate, vertices_around};
use super::order::insertion_order;
use super::scale::Scale;
use crate::MeshError;

/// What an edge of the triangulation stands for: 0 for nothing, else one more than an index into a table. Counts on
/// constraint edges alone: edges that flip keep what they had.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Mark(u32);

impl Mark {
    pub(crate) fn new(index: usize) -> Self {
        Self(index as u32 + 1)
    }

    pub(crate) fn index(self) -> Option<usize> {
        (self.0 as usize).checked_sub(1)
    }
}

pub(crate) type Cdt = ConstrainedDelaunayTriangulation<Point2<f64>, (), Mark>;

/// Memory for each point, in bytes: an order of insertion, and in spade a vertex, three edges and two faces, with room to
/// grow by doubling.
const BYTES_A_POINT: usize = 480;

/// The Delaunay triangulation of points, in coordinates scaled by a power of two.
pub(crate) struct Triangulation {
    pub(crate) cdt: Cdt,
    pub(crate) scale: Scale,
    /// The vertex of each point. Points at the same place share one.
    pub(crate) vertex_of: Vec<u32>,
    /// The first of the points at the place of each vertex.
    pub(crate) point_of: Vec<u32>,
    /// The points of which a coordinate was too small beside the largest and was taken as 0: the first, and how many.
    pub(crate) vanished: Option<(u32, u64)>,
}

impl Triangulation {
    /// Triangulates finite points; none if they all lie on one line.
    ///
    /// Points are inserted one by one in an order that makes that fast, rather than in bulk: it can be stopped at any
    /// time, and is faster.
    pub(crate) fn new(points: &[DVec2], exec: &Exec) -> Result<Option<Self>, ConvertError> {
        if points.len() > 1 << 29 {
            return Err(MeshError::TooMany { kind: "points to triangulate", found: points.len() as u64 }.into());
        }
        exec.check()?;
        let scale = Scale::of_points(points);
        let mut vanished: Option<(u32, u64)> = None;
        let scaled: Vec<DVec2> = (0..)
            .zip(points)
            .map(|(index, &point)| {
                let (moved, lost) = scale.apply(point);
                if lost {
                    vanished.get_or_insert((index, 0)).1 += 1;
                }
                moved
            })
            .collect();
        let Some(first) = corner(&scaled, exec)? else { return Ok(None) };
        let order = insertion_order(&scaled, exec)?;
        let mut cdt = Cdt::with_capacity(scaled.len(), 3 * scaled.len(), 2 * scaled.len());
        let mut vertex_of = vec![u32::MAX; scaled.len()];
        let mut point_of: Vec<u32> = Vec::with_capacity(scaled.len());
        let all = first.into_iter().chain(order);
        for (done, index) in all.enumerate() {
            if done % 512 == 0 {
                exec.check()?;
                exec.progress(done as f64 / scaled.len() as f64);
            }
            let vertex = insert(&mut cdt, scaled[index as usize])?;
            match point_of.get_mut(vertex.index()) {
                Some(known) => *known = (*known).min(index),
                None => point_of.push(index),
            }
            vertex_of[index as usize] = vertex.index() as u32;
        }
        Ok(Some(Self { cdt, scale, vertex_of, point_of, vanished }))
    }

    /// What the triangulation of so many points needs at most.
    pub(crate) fn bytes(points: usize) -> u64 {
        (points as u64).saturating_mul(BYTES_A_POINT as u64)
    }
}

/// Inserts a position on the triangulation's own scale, where no edge must stay; one that is there already gives its vertex. It is
/// looked for from where the last one was inserted.
fn insert(cdt: &mut Cdt, at: DVec2) -> Result<FixedVertexHandle, MeshError> {
    cdt.insert(Point2::new(at.x, at.y)).map_err(|_| REFUSED)
}

/// The same where edges must stay, looked for from a vertex.
///
/// spade looks for it too, in a walk that may go round in a circle among edges that must stay, and then panics. From the
/// nearest corner of the triangle around it the walk is hardly more than a turn; should it fail all the same, that becomes an
/// error.
pub(crate) fn insert_near(
    cdt: &mut Cdt,
    at: DVec2,
    near: FixedVertexHandle,
) -> Result<FixedVertexHandle, ConvertError> {
    let around = vertices_around(cdt, locate(cdt, at, near)).into_iter();
    let distance = |&vertex: &FixedVertexHandle| position(cdt, vertex).distance_squared(at);
    let nearest = around.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(near);
    let place = Point2::new(at.x, at.y);
    match catch_unwind(AssertUnwindSafe(|| cdt.insert_with_hint(place, nearest))) {
        Ok(inserted) => Ok(inserted.map_err(|_| REFUSED)?),
        Err(_) => Err(PlaneError::Vertex { near: nearest.index() as u64 }.into()),
    }
}

const REFUSED: MeshError = MeshError::NotFinite { kind: "vertex of the triangulation", index: 0 };

pub(crate) fn position(cdt: &Cdt, vertex: FixedVertexHandle) -> DVec2 {
    let at = cdt.vertex(vertex).position();
    DVec2::new(at.x, at.y)
}

/// The first three points, in order, that are no line.
fn corner(points: &[DVec2], exec: &Exec) -> Result<Option<[u32; 3]>, ConvertError> {
    let Some(&a) = points.first() else { return Ok(None) };
    let Some(second) = points.iter().position(|&point| point != a) else { return Ok(None) };
    let b = points[second];
    for (chunk, part) in points.chunks(1 << 14).enumerate() {
        exec.check()?;
        if let Some(third) = part.iter().position(|&point| orient2d(a, b, point).is_ne()) {
            return Ok(Some([0, second as u32, (chunk << 14 | third) as u32]));
        }
    }
    Ok(None)
}
