//! Straight pieces of a surface between samples.

use shapeloom_core::glam::DVec3;
use shapeloom_isosurface::Level;

/// Six tetrahedra around the diagonal of a cell, by the corners' bits (Kuhn 1960). Neighbouring cells cut their common
/// face alike.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 1, 5, 7], [0, 2, 3, 7], [0, 2, 6, 7], [0, 4, 5, 7], [0, 4, 6, 7]];

/// How many triangles a cell has, by which of its corners are inside.
pub(super) fn count(inside: [bool; 8]) -> usize {
    let of = |tetrahedron: &[usize; 4]| match tetrahedron.iter().filter(|&&corner| inside[corner]).count() {
        0 | 4 => 0,
        2 => 2,
        _ => 1,
    };
    TETRAHEDRA.iter().map(of).sum()
}

/// Calls `emit` for each triangle of the surface in a cell, by marching tetrahedra. Orientation is not kept.
pub(super) fn for_each_piece(samples: &[f32; 8], corners: &[DVec3; 8], level: Level, mut emit: impl FnMut([DVec3; 3])) {
    let inside = samples.map(|sample| level.holds(sample));
    let cross = |a: usize, b: usize| corners[a].lerp(corners[b], level.crossing(samples[a], samples[b]));
    for tetrahedron in TETRAHEDRA {
        let [mut one, mut other] = [([0; 4], 0), ([0; 4], 0)];
        for corner in tetrahedron {
            let (list, count) = if inside[corner] { &mut one } else { &mut other };
            list[*count] = corner;
            *count += 1;
        }
        let ((a, count_a), (b, count_b)) = (one, other);
        match (count_a, count_b) {
            (1, 3) => emit([cross(a[0], b[0]), cross(a[0], b[1]), cross(a[0], b[2])]),
            (3, 1) => emit([cross(a[0], b[0]), cross(a[1], b[0]), cross(a[2], b[0])]),
            (2, 2) => {
                let ring = [cross(a[0], b[0]), cross(a[0], b[1]), cross(a[1], b[1]), cross(a[1], b[0])];
                emit([ring[0], ring[1], ring[2]]);
                emit([ring[0], ring[2], ring[3]]);
            }
            _ => {}
        }
    }
}

fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    // A segment without length has no t.
    if t.is_nan() { p.distance_squared(a) } else { p.distance_squared(a + along * t) }
}

/// The squared distance of a point from a triangle, which may be a segment or a point.
pub(super) fn distance_squared(p: DVec3, [a, b, c]: &[DVec3; 3]) -> f64 {
    let (ab, ac, ap) = (*b - *a, *c - *a, p - *a);
    let normal = ab.cross(ac);
    let area = normal.length_squared();
    if area > 0.0 {
        let v = ap.cross(ac).dot(normal);
        let w = ab.cross(ap).dot(normal);
        if v >= 0.0 && w >= 0.0 && v + w <= area {
            let height = ap.dot(normal);
            return height * height / area;
        }
    }
    to_segment(p, *a, *b).min(to_segment(p, *b, *c)).min(to_segment(p, *c, *a))
}
