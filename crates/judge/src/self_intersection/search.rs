//! The search for all pairs of triangles that meet.

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::{CHUNK, fill_chunks};
use shapeloom_core::{Exec, Stop};
use shapeloom_mesh::TriMesh;
use shapeloom_spatial::BoxPairs;

use super::equal_faces::Groups;
use super::pair::meeting;
use super::pair::turned_over;
use super::tally::{Tally, add_equal_faces};
use super::triangle::{Points, Triangle};
use super::{FacePair, PairKind, SelfIntersections};
use crate::equal_positions::equal_positions;
use crate::{JudgeError, Scaled};

/// Finds every two triangles of a mesh that meet in more than the corners and the side that they share, exactly: by signs
/// of determinants on the positions as they are, without any tolerance.
///
/// Corners are shared where positions are equal, so triangle soup is judged like the welded mesh. Of each class of pairs
/// the first `limit` are listed and all are counted; see [`PairKind`] for what is what. The result does not depend on
/// threads, nor, but for the numbers of the faces, on their order and on where each starts.
///
/// Pairs of boxes that meet are found by [`BoxPairs`] and decided one by one. Cost: about 0.7 seconds of CPU time for a
/// million triangles of a surface. Triangles with equal corners are counted, not enumerated, so thousands of copies cost
/// nothing; but where the boxes of n different triangles all overlap there are n²/2 pairs to decide, at two to fifteen
/// million a second: around a vertex of valence 5000 one second, or two if all lies flat; in a soup of 100,000 long
/// thin triangles a quarter of an hour. `exec` stops it at any time. Memory: some 250 bytes a triangle, and 24 bytes times
/// `limit` for each class and thread.
///
/// # Errors
/// Positions that are not finite or too fine beside the largest (see [`Scaled::new`]), too little memory, or the reason to
/// stop.
pub fn self_intersections(mesh: &TriMesh, limit: usize, exec: &Exec) -> Result<SelfIntersections, JudgeError> {
    exec.check()?;
    let (vertices, count) = (mesh.positions().len() as u64, mesh.triangles().len() as u64);
    let _memory = exec.reserve(vertices.saturating_mul(48).saturating_add(count.saturating_mul(40)))?;
    let positions = Scaled::new(mesh.positions())?.positions;
    exec.check()?;
    let first = equal_positions(&positions);
    exec.check()?;
    let corners: Vec<[u32; 3]> =
        mesh.triangles().iter().map(|triangle| triangle.map(|vertex| first[vertex as usize])).collect();
    let groups = Groups::of_triangles(&corners, positions.len());
    exec.check()?;
    let all = corners;
    let turned = |first: u32, face: u32| {
        let [first, face] = [first, face].map(|face| all[face as usize]);
        turned_over(first, face) && Points(&positions).triangle(first).seen_along.is_some()
    };
    let corners: Vec<[u32; 3]> = (0..groups.len() as u32).map(|group| all[groups.get(group)[0] as usize]).collect();

    let mut tally = Tally::new(limit, exec);
    add_equal_faces(&mut tally, &groups, turned, exec)?;
    each_meeting(
        (&positions, &corners),
        parts(limit),
        exec,
        |_, _| true,
        || Tally::new(limit, exec),
        |tally, [a, b], kind| Ok(tally.add_turned([groups.get(a), groups.get(b)], kind, turned)?),
        |part| Ok(tally.merge(part)?),
    )?;
    Ok(tally.finish())
}

/// How many lists may exist at a time: enough for the threads, in some 64 MB if the limit allows it.
fn parts(limit: usize) -> usize {
    let bytes = limit.saturating_mul(3 * 2 * size_of::<FacePair>()).max(1);
    ((64 << 20) / bytes).clamp(16, 512)
}

/// Calls `visit` for every two triangles that are `wanted` and meet. The corners have equal numbers where their positions are equal.
pub(super) fn each_meeting<T: Send>(
    (positions, corners): (&[DVec3], &[[u32; 3]]),
    parts: usize,
    exec: &Exec,
    wanted: impl Fn(u32, u32) -> bool + Sync,
    start: impl Fn() -> T + Sync,
    visit: impl Fn(&mut T, [u32; 2], PairKind) -> Result<(), JudgeError> + Sync,
    merge: impl FnMut(T) -> Result<(), JudgeError>,
) -> Result<(), JudgeError> {
    let points = Points(positions);
    let _memory = exec.reserve_elements(corners.len() as u64, size_of::<Triangle>())?;
    let mut triangles = vec![Triangle { corners: [0; 3], seen_along: None, level: None }; corners.len()];
    fill_chunks(exec, &mut triangles, CHUNK, |first, part| {
        part.iter_mut().zip(&corners[first..]).for_each(|(triangle, &corners)| *triangle = points.triangle(corners));
        Ok::<_, Stop>(())
    })?;
    let boxes = BoxPairs::build(corners.len() as u32, |i| points.bounds(corners[i as usize]), exec)?;
    let decide = |state: &mut T, a: u32, b: u32| {
        if !wanted(a, b) {
            return Ok(());
        }
        match meeting(points, &triangles[a as usize], &triangles[b as usize]) {
            Some(kind) => visit(state, [a, b], kind),
            None => Ok(()),
        }
    };
    boxes.visit(exec, parts, start, decide, merge)
}
