//! Tests of the tessellation as a whole.

use std::collections::HashMap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{CancelFlag, Category, Convert, Curve, Deviation, Exec, Surface, Threads};
use shapeloom_mesh::{Domain, NORMAL, TEXCOORD, TriMesh, face_normals};

use super::TessellatePatches;
use crate::{BezierCurve, BezierPatch, BezierSurface, PatchSide, TessellationError};

/// Newell's teapot, with u along the rows of the table.
pub(crate) fn teapot() -> BezierSurface {
    let text = include_str!("../../../../data/teapot.bpt");
    let mut numbers = text.split_ascii_whitespace().map(|word| word.parse::<f64>().unwrap());
    let count = numbers.next().unwrap() as usize;
    let patches = (0..count).map(|_| {
        assert_eq!((numbers.next(), numbers.next()), (Some(3.0), Some(3.0)));
        let mut coordinate = || numbers.next().unwrap();
        let control = (0..16).map(|_| DVec3::new(coordinate(), coordinate(), coordinate())).collect();
        BezierPatch::try_new(3, 3, control).unwrap()
    });
    BezierSurface::new(patches.collect())
}

/// How often each edge is used, by direction: +1 for a rising and -1 for a falling pair of vertices.
fn edge_uses(mesh: &TriMesh) -> HashMap<(u32, u32), (u32, i32)> {
    let mut uses = HashMap::new();
    for triangle in mesh.triangles() {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            let entry: &mut (u32, i32) = uses.entry((a.min(b), a.max(b))).or_default();
            entry.0 += 1;
            entry.1 += if a < b { 1 } else { -1 };
        }
    }
    uses
}

fn closest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = |p: DVec3, q: DVec3| (q - p).cross(normal);
    let outside = |from: DVec3, to: DVec3| (p - from).dot(inside(from, to)) > 0.0;
    let segment = |from: DVec3, to: DVec3| {
        let along = to - from;
        let t = ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        p.distance(from + along * t)
    };
    if normal == DVec3::ZERO || outside(a, b) || outside(b, c) || outside(c, a) {
        segment(a, b).min(segment(b, c)).min(segment(c, a))
    } else {
        (p - a).dot(normal.normalize()).abs()
    }
}

/// The largest distance found from the surface's samples to the triangles of their patch, and from points of the
/// triangles to the surface, by patch.
fn measure(surface: &BezierSurface, mesh: &TriMesh) -> Vec<f64> {
    let patches = mesh.attribute(Domain::Face, "patch").unwrap();
    let mut of_patch = vec![Vec::new(); surface.patches.len()];
    for face in 0..mesh.triangles().len() {
        of_patch[patches.number(face, 0) as usize].push(face);
    }
    let uv = mesh.attribute(Domain::Wedge, TEXCOORD).unwrap();
    let mut worst = vec![0.0f64; surface.patches.len()];
    for (index, patch) in surface.patches.iter().enumerate() {
        let triangles: Vec<[DVec3; 3]> = of_patch[index].iter().map(|&face| mesh.corners(face)).collect();
        const SAMPLES: u32 = 48;
        for sample in 0..=SAMPLES * (SAMPLES + 2) {
            let (i, j) = (sample % (SAMPLES + 1), sample / (SAMPLES + 1));
            let p = patch.point(f64::from(i) / f64::from(SAMPLES), f64::from(j) / f64::from(SAMPLES));
            let nearest = triangles.iter().map(|&t| closest_on_triangle(p, t)).fold(f64::INFINITY, f64::min);
            worst[index] = worst[index].max(nearest);
        }
        for &face in &of_patch[index] {
            for weights in [[1.0 / 3.0; 3], [0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]] {
                let corners = mesh.corners(face);
                let p: DVec3 = (0..3).map(|k| corners[k] * weights[k]).sum();
                let at = |axis: usize| (0..3).map(|k| uv.number(face * 3 + k, axis) * weights[k]).sum::<f64>();
                worst[index] = worst[index].max(distance_to_patch(patch, p, [at(0), at(1)]));
            }
        }
    }
    worst
}

/// The distance from a point to a patch by Gauss-Newton steps from a near parameter: no less than the true one.
fn distance_to_patch(patch: &BezierPatch, p: DVec3, [mut u, mut v]: [f64; 2]) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..12 {
        let jet = patch.jet(u, v);
        let away = jet.point - p;
        best = best.min(away.length());
        let (a, b, c) = (jet.du.length_squared(), jet.du.dot(jet.dv), jet.dv.length_squared());
        let (e, f) = (away.dot(jet.du), away.dot(jet.dv));
        let determinant = a * c - b * b;
        if determinant.abs() < 1e-14 * (a * c).max(1e-300) {
            break;
        }
        u = (u - (c * e - b * f) / determinant).clamp(0.0, 1.0);
        v = (v - (a * f - b * e) / determinant).clamp(0.0, 1.0);
    }
    best
}

#[test]
fn the_teapot_meets_its_certificate_and_that_its_tolerance() {
    let surface = teapot();
    for tolerance in [0.05, 0.008] {
        let converted = TessellatePatches::new(tolerance).convert(&surface).unwrap();
        let Deviation::AtMost(bound) = converted.report.deviation else { panic!("a bound") };
        assert!(bound <= tolerance);
        let measured = measure(&surface, &converted.value);
        let certificates = &converted.report.certificates;
        let mut ratios = Vec::new();
        for (patch, (&certificate, &measured)) in certificates.iter().zip(&measured).enumerate() {
            assert!(measured <= certificate, "patch {patch}: {measured} {certificate}");
            ratios.push(certificate / measured);
        }
        let whole = bound / measured.iter().copied().fold(0.0, f64::max);
        ratios.sort_by(f64::total_cmp);
        // Coarse tessellations of the knob and the bottom, where the parameter accelerates most, are just above 4.
        let above = ratios.iter().filter(|&&ratio| ratio > 4.0).count();
        assert!(above <= if tolerance > 0.01 { 4 } else { 0 }, "{tolerance}: {ratios:?}");
        let median = ratios[ratios.len() / 2];
        assert!(whole <= 4.0 && median <= 4.0, "{whole} {median}");
    }
}

#[test]
fn shared_sides_meet_without_cracks_and_nothing_is_degenerate() {
    let mesh = TessellatePatches::new(0.008).convert(&teapot()).unwrap().value;
    let uses = edge_uses(&mesh);
    assert!(uses.values().all(|&(count, balance)| count <= 2 && (count < 2 || balance == 0)));
    assert!(face_normals(&mesh).iter().all(|normal| *normal != DVec3::ZERO));
    // No vertex is there twice, so a crack would need two vertices apart on one side; the border shows there is none:
    // its length is that of the sides that only one patch has.
    let mut positions: Vec<_> = mesh.positions().iter().map(|p| p.to_array().map(f64::to_bits)).collect();
    positions.sort_unstable();
    assert!(positions.windows(2).all(|pair| pair[0] != pair[1]));
    let border: f64 = border_length(&mesh);
    let surface = teapot();
    let sides: Vec<_> = surface.patches.iter().flat_map(|patch| PatchSide::ALL.map(|side| patch.side(side))).collect();
    let key = |curve: &BezierCurve<DVec3>| {
        let forward: Vec<_> =
            curve.control_points().iter().map(|p| (*p + DVec3::ZERO).to_array().map(f64::to_bits)).collect();
        let backward = forward.iter().rev().copied().collect();
        forward.min(backward)
    };
    let keys: Vec<_> = sides.iter().map(key).collect();
    let alone = sides.iter().zip(&keys).filter(|(_, own)| keys.iter().filter(|other| other == own).count() == 1);
    let length: f64 = alone
        .map(|(curve, _)| {
            let at = |k: u32| curve.point(f64::from(k) / 1000.0);
            (0..1000).map(|k| at(k).distance(at(k + 1))).sum::<f64>()
        })
        .sum();
    assert!((border / length - 1.0).abs() < 0.01, "{border} {length}");
}

fn border_length(mesh: &TriMesh) -> f64 {
    edge_uses(mesh)
        .iter()
        .filter(|(_, (count, _))| *count == 1)
        .map(|(&(a, b), _)| mesh.positions()[a as usize].distance(mesh.positions()[b as usize]))
        .sum()
}

#[test]
fn normals_point_to_the_front_and_are_unit() {
    let mesh = TessellatePatches::new(0.008).convert(&teapot()).unwrap().value;
    let normals = mesh.attribute(Domain::Wedge, NORMAL).unwrap();
    let facets = face_normals(&mesh);
    for wedge in 0..mesh.triangles().len() * 3 {
        let normal = normals.vector(wedge);
        assert!((normal.length() - 1.0).abs() < 1e-12);
        // The lip of the spout turns by a right angle within a few facets.
        assert!(normal.dot(facets[wedge / 3]) > 0.4, "wedge {wedge}: {normal} {}", facets[wedge / 3]);
    }
    // Outward: the body encloses a positive volume although its openings are not closed.
    assert!(mesh.volume() > 10.0);
}

/// A graph over the unit square with straight sides, for which one segment is enough, and a bulge inside.
fn bulge(height: f64) -> BezierPatch {
    let control = (0..9).map(|k| {
        let (i, j) = (k % 3, k / 3);
        DVec3::new(f64::from(i) / 2.0, f64::from(j) / 2.0, if i == 1 && j == 1 { height } else { 0.0 })
    });
    BezierPatch::try_new(2, 2, control.collect()).unwrap()
}

#[test]
fn straight_sides_stay_certified_beside_a_bulge() {
    let surface = BezierSurface::new(vec![bulge(1.0)]);
    let converted = TessellatePatches::new(1e-3).convert(&surface).unwrap();
    let Deviation::AtMost(bound) = converted.report.deviation else { panic!("a bound") };
    let measured = measure(&surface, &converted.value)[0];
    assert!(measured <= bound && bound <= 1e-3, "{measured} {bound}");
}

#[test]
fn neighbours_of_different_fineness_use_the_same_vertices() {
    // A bulge beside a flat patch of another degree, which alone needs two triangles.
    let flat = [(1.0, 0.0), (2.0, 0.0), (1.0, 0.5), (2.0, 0.5), (1.0, 1.0), (2.0, 1.0)];
    let flat = BezierPatch::try_new(1, 2, flat.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec()).unwrap();
    let mesh = TessellatePatches::new(1e-3).convert(&BezierSurface::new(vec![bulge(1.0), flat])).unwrap().value;
    assert!(edge_uses(&mesh).values().all(|&(count, _)| count <= 2));
    // The border is the outline of the 2 × 1 rectangle: no crack inside.
    assert!((border_length(&mesh) - 6.0).abs() < 1e-12);
}

/// A closed surface of one patch: its left and right sides are one seam, its bottom and top are poles.
fn seam_and_poles() -> BezierPatch {
    let ring = [(1.0, 0.0), (1.0, 2.0), (-3.0, 2.0), (-3.0, -2.0), (1.0, -2.0), (1.0, 0.0)];
    let rows = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let net = rows.iter().flat_map(|&(r, z)| ring.map(|(x, y)| DVec3::new(r * (x + 1.0), r * y, z)));
    BezierPatch::try_new(5, 3, net.collect()).unwrap()
}

#[test]
fn seams_and_poles_close() {
    for tolerance in [1e6, 10.0, 0.05, 0.002] {
        let surface = BezierSurface::new(vec![seam_and_poles()]);
        let converted = TessellatePatches::new(tolerance).convert(&surface).unwrap();
        let mesh = &converted.value;
        let uses = edge_uses(mesh);
        // However coarse, it encloses something.
        let least = if tolerance > 1.0 { 1e-6 } else { 1.0 };
        assert!(mesh.volume().abs() > least, "{tolerance}: {}", mesh.volume());
        assert!(uses.values().all(|&(count, balance)| count == 2 && balance == 0), "{tolerance}");
        let euler = mesh.positions().len() as i64 - uses.len() as i64 + mesh.triangles().len() as i64;
        assert_eq!(euler, 2, "{tolerance}");
        assert!(face_normals(mesh).iter().all(|normal| *normal != DVec3::ZERO), "{tolerance}");
        assert_eq!(converted.report.find("poles"), Some(2.0));
    }
}

/// A leaf between two poles, and a corner where two sides collapse into one point.
#[test]
fn patches_with_several_poles_keep_triangles_at_any_tolerance() {
    let leaf = [(0.0, 0.0), (1.0, -1.0), (2.0, 0.0), (0.0, 0.0), (1.0, 1.0), (2.0, 0.0)];
    let leaf = BezierPatch::try_new(2, 1, leaf.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec()).unwrap();
    let corner =
        [(0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0), (1.0, 0.2), (2.0, 0.0), (0.0, 0.0), (0.2, 1.0), (2.0, 2.0)];
    let corner = BezierPatch::try_new(2, 2, corner.map(|(x, y)| DVec3::new(x, y, x * y)).to_vec()).unwrap();
    for patch in [leaf, corner] {
        let surface = BezierSurface::new(vec![patch]);
        for tolerance in [1e3, 0.1, 0.01] {
            let converted = TessellatePatches::new(tolerance).convert(&surface).unwrap();
            let Deviation::AtMost(bound) = converted.report.deviation else { panic!("a bound at {tolerance}") };
            assert!(!converted.value.triangles().is_empty());
            assert!(measure(&surface, &converted.value)[0] <= bound && bound <= tolerance, "{tolerance}");
        }
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let surface = teapot();
    let exec = Exec::default().with_threads(Threads::Sequential);
    let alone = TessellatePatches::new(0.02).convert_with(&surface, &exec).unwrap();
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| TessellatePatches::new(0.02).convert(&surface).unwrap());
        assert!(found == alone, "{threads}");
    }
}

#[test]
fn impossible_requests_are_refused() {
    let surface = teapot();
    let category = |tolerance: f64, exec: &Exec| {
        TessellatePatches::new(tolerance).convert_with(&surface, exec).unwrap_err().category()
    };
    let exec = Exec::default();
    for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(category(tolerance, &exec), Category::Usage);
    }
    assert_eq!(category(1e-300, &exec), Category::Failed);
    assert_eq!(category(1e-12, &exec), Category::OverLimit);
    assert_eq!(category(0.01, &Exec::default().with_memory(1 << 20)), Category::OverLimit);
    let flag = CancelFlag::default();
    flag.cancel();
    assert_eq!(category(0.01, &Exec::default().with_cancel(&flag)), Category::Cancelled);
    let few = TessellatePatches { max_segments: 2, ..TessellatePatches::new(0.01) };
    assert!(matches!(few.convert(&surface).unwrap_err().narrow(), Some(TessellationError::TooManySegments { .. })));
}

#[test]
fn degenerate_surfaces_give_no_panic() {
    let empty = TessellatePatches::new(0.1).convert(&BezierSurface::default()).unwrap();
    assert_eq!((empty.value.triangles().len(), empty.report.deviation), (0, Deviation::Exact));
    let point = BezierPatch::try_new(3, 3, vec![DVec3::ONE; 16]).unwrap();
    let line = BezierPatch::try_new(3, 3, (0..16).map(|k| DVec3::X * f64::from(k % 4)).collect()).unwrap();
    let single = BezierPatch::try_new(0, 0, vec![DVec3::Y]).unwrap();
    for patch in [point, line, single] {
        let converted = TessellatePatches::new(0.1).convert(&BezierSurface::new(vec![patch])).unwrap();
        assert!(converted.value.triangles().len() <= 8);
        // Without a triangle there is nothing that the bound could be about.
        let nothing = converted.value.triangles().is_empty();
        assert_eq!(nothing, converted.report.deviation == Deviation::Unknown);
    }
    let huge = (0..16).map(|k| DVec3::new(f64::from(k % 4), f64::from(k / 4), f64::from(k * k)) * 1e300).collect();
    let huge = BezierPatch::try_new(3, 3, huge).unwrap();
    assert!(TessellatePatches::new(1e299).convert(&BezierSurface::new(vec![huge])).is_ok());
}

/// Squares of lengths vanish below 1e-154 and overflow above 1e154: the bound must not go with them.
#[test]
fn the_bound_scales_with_the_surface_where_squares_do_not() {
    let saddle = |scale: f64| {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE].map(|corner| corner * scale);
        BezierSurface::new(vec![BezierPatch::try_new(1, 1, corners.to_vec()).unwrap()])
    };
    let unit = TessellatePatches::new(1e-3).convert(&saddle(1.0)).unwrap();
    for scale in [1e-200, 1e-170, 1e-155, 1e155, 1e200, 1e290] {
        let converted = TessellatePatches::new(1e-3 * scale).convert(&saddle(scale)).unwrap();
        assert_eq!(converted.value.triangles().len(), unit.value.triangles().len(), "{scale}");
        let ratio = converted.report.certificates[0] / (unit.report.certificates[0] * scale);
        assert!((ratio - 1.0).abs() < 1e-9, "{scale}: {ratio}");
    }
    assert!(TessellatePatches::new(1e-311).convert(&saddle(1e-308)).is_err());
    let corners = [-1.7e308, 1.7e308, 1.7e308, -1.7e308].map(DVec3::splat);
    let opposite = BezierSurface::new(vec![BezierPatch::try_new(1, 1, corners.to_vec()).unwrap()]);
    let error = TessellatePatches::new(1e307).convert(&opposite).unwrap_err();
    assert_eq!(error.diagnostic().code(), "E-tessellation-overflow");
}

/// A piece of a patch of high degree takes milliseconds: polls must follow the work.
#[test]
fn patches_of_high_degree_poll_often() {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering};
    let net = (0..41 * 41).map(|k| DVec3::new(f64::from(k % 41), f64::from(k / 41), f64::from(k * 7919 % 13)));
    let surface = BezierSurface::new(vec![BezierPatch::try_new(40, 40, net.collect()).unwrap()]);
    let polls = Arc::new(AtomicU64::new(0));
    let counter = Arc::clone(&polls);
    let exec = Exec::default().with_watch(move || {
        counter.fetch_add(1, Ordering::Relaxed);
        None
    });
    let converted = TessellatePatches::new(20.0).convert_with(&surface, &exec).unwrap();
    // A piece is about 0.8 million multiplications, so a poll for every two pieces or so.
    let triangles = converted.value.triangles().len() as u64;
    assert!(8 * polls.load(Ordering::Relaxed) > triangles, "{polls:?} {triangles}");
}
