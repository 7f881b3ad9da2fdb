//! Loops with holes.

use shapeloom_core::Convert;
use shapeloom_core::glam::{DVec2, DVec3};

use super::{Dice, count_of, edges, flat, is_sound, raised, twice_area};
use crate::{
    Crossings, MeshError, PlanarRegion, PlaneError, PolyMesh, Polyline, RegionMethod, TriMesh, TriangulatePolygons,
    TriangulateRegion,
};

const METHODS: [RegionMethod; 2] = [RegionMethod::Delaunay, RegionMethod::Earcut];

fn by(method: RegionMethod) -> TriangulateRegion {
    TriangulateRegion { method, ..TriangulateRegion::new() }
}

fn region(loops: &[Vec<DVec2>]) -> PlanarRegion {
    let raised: Vec<Vec<DVec3>> = loops.iter().map(|points| raised(points)).collect();
    PlanarRegion::try_new(&raised).unwrap()
}

fn square(low: f64, high: f64) -> Vec<DVec2> {
    [(low, low), (high, low), (high, high), (low, high)].map(DVec2::from).to_vec()
}

/// Twice the area of a loop of whole numbers, exactly.
fn twice_loop(points: &[DVec2]) -> i128 {
    let whole = |p: DVec2| [p.x as i128, p.y as i128];
    let pair = |k: usize| (whole(points[k]), whole(points[(k + 1) % points.len()]));
    (0..points.len()).map(|k| pair(k).0[0] * pair(k).1[1] - pair(k).0[1] * pair(k).1[0]).sum()
}

/// Outlines of whole numbers: stars, spirals and combs.
fn outlines(count: usize) -> Vec<(&'static str, Vec<DVec2>)> {
    let mut dice = Dice(count as u64);
    let at = |radius: f64, k: usize, turns: f64| {
        let angle = turns * std::f64::consts::TAU * k as f64 / count as f64;
        (DVec2::from_angle(angle) * radius).round()
    };
    let star = (0..count).map(|k| at(1e9 * (0.2 + dice.unit()), k, 1.0)).collect();
    let half = count / 2;
    let arm = |k: usize, width: f64| at(1e9 * (0.1 + k as f64 / half as f64) - width, k, 10.0);
    let spiral = (0..half).map(|k| arm(k, 0.0)).chain((0..half).rev().map(|k| arm(k, 2e7))).collect();
    let tooth = |k: usize| DVec2::new(k as f64 * 1000.0, if k.is_multiple_of(2) { 1.0 } else { 1e7 });
    let comb = (0..count - 2).map(tooth).chain([DVec2::new(count as f64 * 1e3, 0.0), DVec2::ZERO]);
    // Counter-clockwise.
    let mut comb: Vec<DVec2> = comb.collect();
    comb.reverse();
    vec![("star", star), ("spiral", spiral), ("comb", comb)]
}

/// Both methods and ear clipping without new vertices agree on the area to the last unit, and none turns a triangle over.
#[test]
fn stars_spirals_and_combs_are_covered_exactly() {
    for (count, outlines) in [30, 301, 4000, 20_000].map(|count| (count, outlines(count))) {
        for (name, points) in outlines {
            let wanted = twice_loop(&points);
            for method in METHODS {
                let converted = by(method).convert(&region(std::slice::from_ref(&points))).unwrap();
                let other_way = u64::from(method == RegionMethod::Earcut && count > 4096);
                let findings = &converted.report.findings;
                assert_eq!(findings.iter().count() as u64, other_way, "{name} {count}: {findings:?}");
                assert_eq!(count_of(findings, "W-plane-earcut"), other_way, "{name} {count}");
                is_sound(&converted.value);
                assert_eq!(twice_area(&converted.value), wanted, "{name} {count} {method:?}");
                assert_eq!(converted.value.triangles().len(), points.len() - 2, "{name} {count} {method:?}");
            }
            let corners = (0..points.len() as u32).collect::<Vec<_>>();
            let face = PolyMesh::from_faces(raised(&points), &[corners]).unwrap();
            let ears = TriangulatePolygons::new().convert(&face).unwrap().value;
            assert_eq!(twice_area(&ears), wanted, "{name} {count}");
        }
    }
}

/// A point with holes inside and beside, by brute force over a lattice of points between whole numbers.
fn holds_even_odd(mesh: &TriMesh, loops: &[Vec<DVec2>]) {
    let high = loops.concat().into_iter().fold(DVec2::ZERO, DVec2::max);
    let at = flat(mesh);
    for k in 0..900 {
        // Off every line between whole numbers of this size.
        let p = DVec2::new(0.013 + f64::from(k % 30), 0.0171 + f64::from(k / 30)) * (high / 30.0);
        let crossed =
            |a: DVec2, b: DVec2| (a.y <= p.y) != (b.y <= p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y);
        let sides = |points: &Vec<DVec2>| {
            (0..points.len()).filter(|&k| crossed(points[k], points[(k + 1) % points.len()])).count()
        };
        let wanted = loops.iter().map(sides).sum::<usize>() % 2 == 1;
        let within = |triangle: &&[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| at[vertex as usize]);
            [(a, b), (b, c), (c, a)].iter().all(|(a, b)| (*b - *a).perp_dot(p - *a) > 0.0)
        };
        assert_eq!(mesh.triangles().iter().filter(within).count(), usize::from(wanted), "{p}");
    }
}

#[test]
fn holes_islands_and_neighbours_follow_the_even_odd_rule() {
    let diamond = [(5.0, 1.0), (9.0, 5.0), (5.0, 9.0), (1.0, 5.0)].map(DVec2::from).to_vec();
    let backward = |mut points: Vec<DVec2>| {
        points.reverse();
        points
    };
    let apart =
        vec![square(0.0, 20.0), backward(square(1.0, 19.0)), square(2.0, 18.0), square(3.0, 9.0), square(10.0, 12.0)];
    let beside = vec![square(0.0, 4.0), square(6.0, 9.0), square(1.0, 2.0), backward(square(7.0, 8.0))];
    let touching = vec![square(0.0, 10.0), diamond.clone(), square(5.0, 10.0)];
    let same_side = vec![
        square(0.0, 4.0),
        [(4.0, 0.0), (8.0, 0.0), (8.0, 4.0), (4.0, 4.0)].map(DVec2::from).to_vec(),
        [(0.0, 1.0), (2.0, 1.0), (2.0, 3.0), (0.0, 3.0)].map(DVec2::from).to_vec(),
    ];
    let crossing = vec![square(0.0, 10.0), square(4.0, 14.0), diamond];
    let twice = vec![square(0.0, 4.0), square(0.0, 4.0), square(5.0, 6.0)];
    let areas =
        [400.0 - 324.0 + 256.0 - 36.0 - 4.0, 16.0 + 9.0 - 1.0 - 1.0, f64::NAN, 16.0 + 16.0 - 4.0, f64::NAN, 1.0];
    for (loops, area) in [apart, beside, touching, same_side, crossing, twice].into_iter().zip(areas) {
        for method in METHODS {
            let converted = by(method).convert(&region(&loops)).unwrap();
            is_sound(&converted.value);
            holds_even_odd(&converted.value, &loops);
            assert!(area.is_nan() || converted.value.area() == area, "{} {area}", converted.value.area());
            // Every corner of the border is a vertex: sides have no corner in their middle on the other side.
            assert!(edges(&converted.value).values().all(|apexes| apexes.len() <= 2));
        }
    }
}

#[test]
fn random_loops_that_cross_follow_the_even_odd_rule() {
    let mut dice = Dice(5);
    for _ in 0..30 {
        let count = 3 + dice.next(12) as usize;
        let loops: Vec<Vec<DVec2>> = (0..1 + dice.next(3))
            .map(|_| (0..count).map(|_| DVec2::new(dice.next(64) as f64, dice.next(64) as f64)).collect())
            .collect();
        // Triangles face the side from which the largest loop runs counter-clockwise.
        let largest = loops.iter().map(|points| twice_loop(points)).max_by_key(|area| area.abs()).unwrap();
        let mesh = by(RegionMethod::Delaunay).convert(&region(&loops)).unwrap().value;
        let mesh = if largest < 0 { mesh.reversed() } else { mesh };
        is_sound(&mesh);
        holds_even_odd(&mesh, &loops);
    }
}

/// A pentagram: the tips have area, the middle, which is wound twice, has none.
#[test]
fn a_pentagram_keeps_its_tips_or_is_refused() {
    let star: Vec<DVec3> =
        (0..5).map(|k| DVec2::from_angle(f64::from(k) * 0.8 * std::f64::consts::PI).extend(0.0)).collect();
    let line = Polyline::new(star, true);
    for method in METHODS {
        let converted = by(method).convert(&line).unwrap();
        assert_eq!((converted.value.triangles().len(), converted.value.positions().len()), (5, 10));
        let tip = (36f64.to_radians().sin() * (1.0 - 2.0 * 18f64.to_radians().sin())).abs();
        let inner = 18f64.to_radians().sin() / 54f64.to_radians().sin();
        // Ten triangles from the centre of the decagon make the star; the pentagon in its middle is taken away.
        let whole = 10.0 * 0.5 * inner * 36f64.to_radians().sin();
        let middle = 2.5 * inner * inner * 72f64.to_radians().sin();
        assert!((converted.value.area() - (whole - middle)).abs() < 1e-14, "{tip}");
        assert_eq!(converted.report.find("crossings"), Some(5.0));
        assert!(converted.report.find("crossing_rounding").unwrap() < 1e-15);
        assert_eq!(count_of(&converted.report.findings, "W-plane-earcut") == 1, method == RegionMethod::Earcut);
        let refuse = TriangulateRegion { crossings: Crossings::Refuse, ..by(method) };
        let error = refuse.convert(&line).unwrap_err();
        assert_eq!(error.narrow(), Some(&PlaneError::Crossing { kind: "sides", edges: [0, 2], count: 5 }));
        assert!(error.to_string().contains("sides 0 and 2"), "{error}");
    }
}

#[test]
fn repeated_points_and_straight_runs_are_no_trouble() {
    let points = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.0), (3.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0)];
    // A spike that goes out and back the same way.
    let spike = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (9.0, 2.0), (4.0, 2.0), (4.0, 4.0), (0.0, 4.0)];
    for outline in [&points[..], &spike[..]] {
        let outline: Vec<DVec2> = outline.iter().copied().map(DVec2::from).collect();
        for method in METHODS {
            let converted = by(method).convert(&region(std::slice::from_ref(&outline))).unwrap();
            is_sound(&converted.value);
            assert_eq!(converted.value.area(), 16.0, "{method:?}");
        }
    }
    let delaunay = by(RegionMethod::Delaunay).convert(&region(&[points.map(DVec2::from).to_vec()])).unwrap();
    assert_eq!(delaunay.value.positions().len(), 6);
    assert_eq!(count_of(&delaunay.report.findings, "W-plane-duplicate"), 2);
}

#[test]
fn regions_in_space_face_their_side_and_tell_how_flat_they_are() {
    let (u, v) = (DVec3::new(0.0, 0.6, 0.8), DVec3::new(1.0, 0.0, 0.0));
    let outer = square(0.0, 8.0);
    let hole = square(2.0, 4.0);
    let lift = |points: &[DVec2]| points.iter().map(|p| u * p.x + v * p.y + DVec3::splat(100.0)).collect::<Vec<_>>();
    for turned in [false, true] {
        let mut loops = vec![lift(&outer), lift(&hole)];
        if turned {
            loops[0].reverse();
        }
        let converted = TriangulateRegion::new().convert(&PlanarRegion::try_new(&loops).unwrap()).unwrap();
        let normal = if turned { -u.cross(v) } else { u.cross(v) };
        assert!((converted.value.area() - 60.0).abs() < 1e-11);
        for triangle in 0..converted.value.triangles().len() {
            let [a, b, c] = converted.value.corners(triangle);
            assert!((b - a).cross(c - a).normalize().dot(normal) > 1.0 - 1e-9);
        }
        assert_eq!(converted.report.deviation, shapeloom_core::Deviation::Exact);
        loops[0][1] += normal * 0.5;
        let bent = TriangulateRegion::new().convert(&PlanarRegion::try_new(&loops).unwrap()).unwrap();
        let off = bent.report.find("planarity").unwrap();
        assert!(off > 0.1 && bent.report.deviation == shapeloom_core::Deviation::Estimated(off));
    }
}

#[test]
fn odd_loops_are_told_and_never_panic() {
    for points in [vec![], vec![DVec3::ONE], vec![DVec3::ONE; 7], (0..9).map(|k| DVec3::ONE * f64::from(k)).collect()] {
        for method in METHODS {
            let converted = by(method).convert(&Polyline::new(points.clone(), true)).unwrap();
            assert!(converted.value.triangles().is_empty());
            assert_eq!(count_of(&converted.report.findings, "W-plane-collinear"), u64::from(!points.is_empty()));
        }
    }
    let open = Polyline::new(raised(&square(0.0, 3.0)), false);
    let converted = TriangulateRegion::new().convert(&open).unwrap();
    assert_eq!((converted.value.area(), count_of(&converted.report.findings, "W-plane-open")), (9.0, 1));
    let odd = PlanarRegion::try_new(&[[DVec3::ZERO, DVec3::X, DVec3::NAN]]).unwrap();
    let error = TriangulateRegion::new().convert(&odd).unwrap_err();
    assert_eq!(error.narrow(), Some(&MeshError::NotFinite { kind: "point", index: 2 }));
    for size in [1e-300, 1e-9, 1e150, 2f64.powi(1020)] {
        let loops = [square(0.0, 8.0 * size), square(size, 2.0 * size), square(3.0 * size, 5.0 * size)];
        for method in METHODS {
            let converted = by(method).convert(&region(&loops)).unwrap();
            assert!(converted.report.findings.is_empty() && converted.value.triangles().len() == 14, "{size}");
        }
    }
}
