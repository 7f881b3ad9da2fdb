//! Where a polygon mesh meets itself.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, ConvertError, Exec, OverBudget, Reservation, Stop};
use shapeloom_mesh::{Column, Domain, PolyMesh, TriangulatePolygons, Values};
use shapeloom_spatial::BvhError;

use super::equal_faces::Groups;
use super::search::each_meeting;
use super::tally::{Tally, add_equal_faces};
use super::triangle::Points;
use super::{PairKind, SelfIntersections};
use crate::cycle::same_rotation;
use crate::equal_positions::equal_positions;
use crate::segments::collinear;
use crate::{JudgeError, Scaled};

/// Finds every two polygons of a mesh that meet in more than the corners and the sides that they share.
///
/// The polygons are cut into triangles by [`TriangulatePolygons`], and these are decided exactly as by
/// [`self_intersections`](super::self_intersections). Two polygons make one pair, of the strongest kind of their
/// triangles; a polygon is not compared with itself. Polygons with the same ring of corners are coincident however they
/// are cut. Numbers are those of the polygons.
///
/// Where a polygon is not flat, the answer is about the triangles that it was cut into. A side that lies exactly on the
/// diagonal along which another polygon was cut, with the same ends, counts as shared.
///
/// Cost: as for the triangles. Memory: besides theirs, 48 bytes for each two triangles that meet.
///
/// # Errors
/// As [`self_intersections`](super::self_intersections), or more triangles than element numbers.
pub fn self_intersections_of_polygons(
    mesh: &PolyMesh,
    limit: usize,
    exec: &Exec,
) -> Result<SelfIntersections, JudgeError> {
    exec.check()?;
    let (vertices, wedges) = (mesh.positions().len() as u64, mesh.wedge_vertices().len() as u64);
    let _memory = exec.reserve(vertices.saturating_mul(72).saturating_add(wedges.saturating_mul(60)))?;
    let positions = Scaled::new(mesh.positions())?.positions;
    exec.check()?;
    let first = equal_positions(&positions);
    let rings: Vec<u32> = mesh.wedge_vertices().iter().map(|&vertex| first[vertex as usize]).collect();
    let ring = |face: u32| &rings[mesh.wedges(face as usize)];
    let groups = Groups::of_polygons(mesh.face_count() as u32, ring);
    exec.check()?;
    let (corners, owners) = triangles(mesh, &groups, &first, exec)?;

    let mut tally = Tally::new(limit, exec);
    let turned = |first: u32, face: u32| {
        !same_rotation(ring(first), ring(face))
            && has_area(ring(first).iter().map(|&corner| positions[corner as usize]))
    };
    add_equal_faces(&mut tally, &groups, turned, exec)?;
    let mut found = Found::new(exec);
    each_meeting(
        (&positions, &corners),
        256,
        exec,
        |a, b| owners[a as usize] != owners[b as usize],
        || Found::new(exec),
        |found, triangles, kind| {
            let [a, b] = triangles.map(|triangle| owners[triangle as usize]);
            // Different polygons that share a triangle overlap, or are in contact.
            let area = || Points(&positions).triangle(corners[triangles[0] as usize]).seen_along.is_some();
            let kind = match kind {
                PairKind::Duplicate if area() => PairKind::Overlap,
                PairKind::Coincident => PairKind::Contact,
                other => other,
            };
            Ok(found.push(([a.min(b), a.max(b)], kind))?)
        },
        |part| Ok(part.pairs.into_iter().try_for_each(|pair| found.push(pair))?),
    )?;
    found.pairs.sort_unstable();
    // The strongest kind comes first.
    for (i, pair) in found.pairs.chunk_by(|a, b| a.0 == b.0).map(|same| same[0]).enumerate() {
        if i % 4096 == 0 {
            exec.check()?;
        }
        let ([a, b], kind) = pair;
        tally.add_turned([groups.get(a), groups.get(b)], kind, turned)?;
    }
    Ok(tally.finish())
}

/// Whether not all corners lie on one line.
fn has_area(mut corners: impl Iterator<Item = DVec3>) -> bool {
    let Some(first) = corners.next() else { return false };
    let Some(other) = corners.find(|&corner| corner != first) else { return false };
    corners.any(|corner| !collinear(first, other, corner))
}

/// The triangles of one polygon of each group, with the group of each.
fn triangles(
    mesh: &PolyMesh,
    groups: &Groups,
    first: &[u32],
    exec: &Exec,
) -> Result<(Vec<[u32; 3]>, Vec<u32>), JudgeError> {
    let too_many = JudgeError::Bvh(BvhError::TooMany { found: mesh.triangle_count() });
    let faces: Vec<&[u32]> = (0..groups.len() as u32).map(|group| mesh.face(groups.get(group)[0] as usize)).collect();
    let lone = PolyMesh::from_faces(mesh.positions().to_vec(), &faces);
    let labels = Column::labels("group", (0..groups.len() as u32).collect());
    let labelled = lone.ok().and_then(|mut lone| lone.insert_attribute(Domain::Face, labels).ok().map(|()| lone));
    let cut = TriangulatePolygons::new().convert_with(&labelled.ok_or(too_many)?, exec);
    let cut = cut.map_err(|error: ConvertError| {
        let stop = error.narrow::<Stop>().copied().map(JudgeError::Stop);
        stop.or_else(|| error.narrow::<OverBudget>().copied().map(JudgeError::OverBudget)).unwrap_or(too_many)
    })?;
    let corners = cut.value.triangles().iter().map(|triangle| triangle.map(|vertex| first[vertex as usize])).collect();
    match cut.value.attribute(Domain::Face, "group").map(Column::values) {
        Some(Values::U32(owners)) => Ok((corners, owners.clone())),
        _ => Err(too_many),
    }
}

/// Pairs of groups that meet, once for each two of their triangles.
struct Found<'a> {
    pairs: Vec<([u32; 2], PairKind)>,
    exec: &'a Exec,
    _memory: Option<Reservation>,
}

impl<'a> Found<'a> {
    fn new(exec: &'a Exec) -> Self {
        Self { pairs: Vec::new(), exec, _memory: None }
    }

    fn push(&mut self, pair: ([u32; 2], PairKind)) -> Result<(), OverBudget> {
        if self.pairs.len() == self.pairs.capacity() {
            let wanted = self.pairs.len().saturating_mul(2).max(64);
            let memory = self.exec.reserve_elements(wanted as u64, size_of_val(&pair))?;
            self.pairs.reserve_exact(wanted - self.pairs.len());
            self._memory = Some(memory);
        }
        self.pairs.push(pair);
        Ok(())
    }
}
