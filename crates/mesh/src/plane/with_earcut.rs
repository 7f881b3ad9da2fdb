//! Regions cut by earcut, checked.

use std::cmp::Ordering;
use std::ops::Range;

use earcut::Earcut;
use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::orient2d;
use shapeloom_core::{ConvertError, Converted, Exec};

use super::planar_region::PlanarRegion;
use super::scale::Scale;
use super::sheet::Sheet;
use super::simple_loops::are_simple;
use crate::TriMesh;

/// Beyond this the other way is faster (measured on stars, spirals and combs), and earcut, which cannot be stopped, may take
/// seconds.
const MOST_POINTS: usize = 1 << 12;

/// Cuts a region by earcut; none if loops cross or touch, decided exactly, or if its result does not hold: all triangles must
/// turn the same way by exact signs, and together have the area of the region.
pub(crate) fn with_earcut(
    region: &PlanarRegion,
    sheet: &Sheet<'_>,
    exec: &Exec,
) -> Result<Option<Converted<TriMesh>>, ConvertError> {
    let count = region.points().len();
    if count > MOST_POINTS {
        return Ok(None);
    }
    let _memory = exec.reserve_elements(count as u64, 320)?;
    exec.check()?;
    let flat: Vec<DVec2> = region.points().iter().map(|&point| sheet.projection.flat(point)).collect();
    let scale = Scale::of_points(&flat);
    let (flat, vanished): (Vec<DVec2>, Vec<bool>) = flat.into_iter().map(|point| scale.apply(point)).unzip();
    if vanished.contains(&true) {
        return Ok(None);
    }
    let loops: Vec<Range<usize>> = region.ranges().filter(|range| !range.is_empty()).collect();
    if !are_simple(&flat, &loops, exec)? {
        return Ok(None);
    }
    let Some(nesting) = nesting(&flat, &loops, exec)? else { return Ok(None) };
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    let mut clipper = Earcut::new();
    for (outer, nest) in nesting.iter().enumerate().filter(|(_, nest)| nest.depth % 2 == 0) {
        exec.check()?;
        let mut members: Vec<u32> = loops[outer].clone().map(|point| point as u32).collect();
        let mut holes: Vec<u32> = Vec::new();
        for &hole in &nest.children {
            holes.push(members.len() as u32);
            members.extend(loops[hole].clone().map(|point| point as u32));
        }
        let mut corners: Vec<u32> = Vec::new();
        clipper.earcut(members.iter().map(|&point| flat[point as usize].to_array()), &holes, &mut corners);
        triangles.extend(corners.as_chunks::<3>().0.iter().map(|t| t.map(|corner| members[corner as usize])));
    }
    let signed = |(range, nest): (&Range<usize>, &Nest)| {
        let area = twice_area(&flat[range.clone()]).abs();
        if nest.depth % 2 == 0 { area } else { -area }
    };
    let wanted: f64 = loops.iter().zip(&nesting).map(signed).sum();
    let turn = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| flat[corner as usize]);
        (orient2d(a, b, c), (b - a).perp_dot(c - a).abs())
    };
    let Some(side) = triangles.first().map(|triangle| turn(triangle).0) else { return Ok(None) };
    let mut found = 0.0;
    for (index, triangle) in triangles.iter_mut().enumerate() {
        if index % 4096 == 0 {
            exec.check()?;
        }
        let (turn, area) = turn(triangle);
        if turn != side || turn == Ordering::Equal {
            return Ok(None);
        }
        found += area;
        if side == Ordering::Less {
            triangle.swap(1, 2);
        }
    }
    // Far more than the rounding of sums, far less than what a missing triangle would make.
    if (found - wanted).abs() > 1e-9 * wanted {
        return Ok(None);
    }
    sheet.of_triangles(triangles).map(Some)
}

/// How deep a loop lies within others, and the loops that lie in it with no other between.
#[derive(Clone, Debug, Default)]
struct Nest {
    depth: u32,
    children: Vec<usize>,
}

/// Which loops lie in which, for loops that neither cross nor touch; none if one lies on the border of another.
fn nesting(flat: &[DVec2], loops: &[Range<usize>], exec: &Exec) -> Result<Option<Vec<Nest>>, ConvertError> {
    let boxes: Vec<[DVec2; 2]> = loops
        .iter()
        .map(|range| {
            let corners = &flat[range.clone()];
            let first = corners[0];
            corners.iter().fold([first, first], |[low, high], &corner| [low.min(corner), high.max(corner)])
        })
        .collect();
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); loops.len()];
    for (inner, range) in loops.iter().enumerate() {
        for (outer, other) in loops.iter().enumerate() {
            let [low, high] = boxes[outer];
            let may = outer != inner && low.cmple(boxes[inner][0]).all() && high.cmpge(boxes[inner][1]).all();
            if !may {
                continue;
            }
            exec.check()?;
            match range.clone().find_map(|corner| is_inside(flat[corner], &flat[other.clone()])) {
                Some(true) => around[inner].push(outer),
                Some(false) => {}
                None => return Ok(None),
            }
        }
    }
    let mut nesting: Vec<Nest> =
        around.iter().map(|around| Nest { depth: around.len() as u32, children: Vec::new() }).collect();
    for (inner, around) in around.iter().enumerate() {
        if let Some(&parent) = around.iter().find(|&&outer| nesting[outer].depth + 1 == nesting[inner].depth) {
            nesting[parent].children.push(inner);
        }
    }
    Ok(Some(nesting))
}

/// Whether a point lies inside a loop, by exact signs; none on its border.
fn is_inside(point: DVec2, corners: &[DVec2]) -> Option<bool> {
    let mut inside = false;
    for (k, &from) in corners.iter().enumerate() {
        let to = corners[(k + 1) % corners.len()];
        let turn = orient2d(from, to, point);
        let within = from.min(to).cmple(point).all() && from.max(to).cmpge(point).all();
        if turn == Ordering::Equal && within {
            return None;
        }
        // Half-open in y, so that a corner at the height of the point counts once.
        if (from.y <= point.y) != (to.y <= point.y) {
            inside ^= (turn == Ordering::Greater) == (from.y < to.y);
        }
    }
    Some(inside)
}

/// Twice the signed area of a loop.
fn twice_area(corners: &[DVec2]) -> f64 {
    let first = corners.first().copied().unwrap_or_default();
    corners.windows(2).map(|pair| (pair[0] - first).perp_dot(pair[1] - first)).sum()
}
