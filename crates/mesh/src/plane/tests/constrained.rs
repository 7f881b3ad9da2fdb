//! Edges that must stay.

use shapeloom_core::Convert;
use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{in_circle, orient2d};

use super::{Dice, count_of, edges, flat, is_sound, raised};
use crate::{
    Column, ConstrainedDelaunay, Crossings, Domain, GeometricGraph, KeptTriangles, PlaneError, TriMesh, Values,
};

pub(super) fn graph(points: &[DVec2], edges: &[[u32; 2]]) -> GeometricGraph {
    GeometricGraph::try_new(raised(points), edges.to_vec()).unwrap()
}

/// Whether a point lies on a segment, exactly.
fn is_on(p: DVec2, [a, b]: [DVec2; 2]) -> bool {
    orient2d(a, b, p).is_eq() && a.min(b).cmple(p).all() && a.max(b).cmpge(p).all()
}

/// Whether two segments share more than an end, exactly.
fn cross([a, b]: [DVec2; 2], [u, v]: [DVec2; 2]) -> bool {
    let (one, other) = (orient2d(a, b, u).is_gt(), orient2d(a, b, v).is_gt());
    let none =
        [orient2d(a, b, u), orient2d(a, b, v), orient2d(u, v, a), orient2d(u, v, b)].iter().all(|turn| turn.is_ne());
    none && one != other && orient2d(u, v, a).is_gt() != orient2d(u, v, b).is_gt()
}

/// Checks that the triangulation is constrained Delaunay: an edge that is no part of a given one has the triangles at its
/// sides apart in circle; and that each given edge is a chain of edges.
fn is_constrained_delaunay(mesh: &TriMesh, at: &[DVec2], given: &[[DVec2; 2]]) {
    let all = edges(mesh);
    for (&[a, b], apexes) in &all {
        let [p, q] = [a, b].map(|vertex| at[vertex as usize]);
        let is_given = given.iter().any(|&segment| is_on(p, segment) && is_on(q, segment));
        if let (false, &[c, d]) = (is_given, &apexes[..]) {
            let [c, d] = [c, d].map(|vertex| at[vertex as usize]);
            let (c, d) = if orient2d(p, q, c).is_gt() { (c, d) } else { (d, c) };
            assert!(in_circle(p, q, c, d).is_le(), "{p} {q}");
        }
    }
    for &[a, b] in given.iter().filter(|[a, b]| a != b) {
        let mut on: Vec<(f64, u32)> = (0u32..)
            .zip(at)
            .filter(|&(_, &p)| is_on(p, [a, b]))
            .map(|(vertex, &p)| (p.distance_squared(a), vertex))
            .collect();
        on.sort_by(|one, other| one.0.total_cmp(&other.0));
        for pair in on.windows(2) {
            let (one, other) = (pair[0].1, pair[1].1);
            assert!(all.contains_key(&[one.min(other), one.max(other)]), "{a} {b}: no edge {one} {other}");
        }
    }
}

/// Random whole numbers, edges that do not cross but may touch vertices, overlap and repeat.
#[test]
fn given_edges_are_edges_and_the_rest_is_delaunay() {
    let mut dice = Dice(21);
    for round in 0..60 {
        let count = 8 + dice.next(50) as usize;
        let reach = [4, 30, 1000][round % 3];
        let mut points: Vec<DVec2> = Vec::new();
        while points.len() < count {
            let point = DVec2::new(dice.whole(reach), dice.whole(reach));
            if points.len() as u64 >= (2 * reach + 1).pow(2) / 2 || !points.contains(&point) {
                points.push(point);
            }
        }
        let mut given: Vec<[u32; 2]> = Vec::new();
        for _ in 0..4 * count {
            let edge = [dice.next(count as u64) as u32, dice.next(count as u64) as u32];
            let segment = |edge: [u32; 2]| edge.map(|end| points[end as usize]);
            if given.iter().all(|&other| !cross(segment(edge), segment(other))) {
                given.push(edge);
            }
        }
        let converted = ConstrainedDelaunay::new().convert(&graph(&points, &given)).unwrap();
        assert_eq!(converted.report.find("crossings"), None);
        let mesh = converted.value;
        let hull = is_sound(&mesh);
        let at = flat(&mesh);
        assert_eq!(mesh.triangles().len() + 2 + hull, 2 * at.len());
        let segments: Vec<[DVec2; 2]> = given.iter().map(|edge| edge.map(|end| points[end as usize])).collect();
        is_constrained_delaunay(&mesh, &at, &segments);
    }
}

/// Where edges cross at whole numbers nothing is rounded: the same as if the crossings had been given.
#[test]
fn crossings_at_whole_numbers_are_exact() {
    let mut points: Vec<DVec2> = Vec::new();
    let mut given: Vec<[u32; 2]> = Vec::new();
    for k in 0..6 {
        let (first, at) = (points.len() as u32, f64::from(k));
        points.extend([(at, -1.0), (at, 6.0), (-1.0, at), (6.0, at)].map(DVec2::from));
        given.extend([[first, first + 1], [first + 2, first + 3]]);
    }
    let converted = ConstrainedDelaunay::new().convert(&graph(&points, &given)).unwrap();
    assert_eq!(converted.report.find("crossings"), Some(36.0));
    assert_eq!(converted.report.find("crossing_vertices"), Some(36.0));
    assert_eq!(converted.report.find("crossing_rounding"), Some(0.0));
    assert_eq!(count_of(&converted.report.findings, "W-plane-crossing"), 36);
    let at = flat(&converted.value);
    assert_eq!(at.len(), 24 + 36);
    is_sound(&converted.value);
    let segments: Vec<[DVec2; 2]> = given.iter().map(|edge| edge.map(|end| points[end as usize])).collect();
    is_constrained_delaunay(&converted.value, &at, &segments);
    let enclosed = ConstrainedDelaunay { keep: KeptTriangles::Enclosed, ..ConstrainedDelaunay::new() };
    let cells = enclosed.convert(&graph(&points, &given)).unwrap().value;
    // The ends that stick out enclose nothing; of the 25 cells the outer ring of 16 and the middle are at odd depths.
    assert_eq!((cells.area(), cells.triangles().len()), (17.0, 34));
    let refuse = ConstrainedDelaunay { crossings: Crossings::Refuse, ..ConstrainedDelaunay::new() };
    let error = refuse.convert(&graph(&points, &given)).unwrap_err();
    assert_eq!(error.narrow(), Some(&PlaneError::Crossing { kind: "edges", edges: [0, 1], count: 36 }));
    assert!(error.to_string().starts_with("edges 0 and 1: found 36 crossings"), "{error}");
}

/// Long edges at random cross a few hundred times, near each other and near vertices: the triangulation stays sound, and
/// each edge is a chain of edges that strays from it by rounding alone.
#[test]
fn crossings_anywhere_leave_a_sound_triangulation() {
    let mut dice = Dice(77);
    for round in 0..12 {
        let reach = if round % 2 == 0 { 1.0 } else { 1e-8 };
        let place = |dice: &mut Dice| {
            // In odd rounds all edges nearly coincide.
            let (x, y) = (dice.unit(), dice.unit() * reach);
            DVec2::new(x, y + if reach < 1.0 { 0.3 * x } else { 0.0 })
        };
        let points: Vec<DVec2> = (0..60).map(|_| place(&mut dice)).collect();
        let given: Vec<[u32; 2]> = (0..30).map(|k| [2 * k, 2 * k + 1]).collect();
        let converted = ConstrainedDelaunay::new().convert(&graph(&points, &given)).unwrap();
        let hull = is_sound(&converted.value);
        let at = flat(&converted.value);
        assert_eq!(converted.value.triangles().len() + 2 + hull, 2 * at.len());
        let found = converted.report.find("crossings").unwrap();
        let wanted = (0..30)
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .filter(|&(i, j)| cross(given[i].map(|e| points[e as usize]), given[j].map(|e| points[e as usize])))
            .count();
        // Rounding may make pieces of near edges cross once more, or let two crossings fall on one vertex.
        assert!((found - wanted as f64).abs() <= 0.02 * wanted as f64, "{found} {wanted}");
        assert!(converted.report.find("crossing_rounding").unwrap() < 1e-14);
        let all = edges(&converted.value);
        for edge in &given {
            let [a, b] = edge.map(|end| points[end as usize]);
            let off = |p: DVec2| (b - a).perp_dot(p - a).abs() / a.distance(b);
            let near = |vertex: u32| off(at[vertex as usize]) < 1e-14;
            // Walk from one end to the other over edges that stay on the line.
            let (mut here, mut before) = (edge[0], u32::MAX);
            while here != edge[1] {
                let ahead = |v: u32| (at[v as usize] - at[here as usize]).dot(b - a) > 0.0;
                let next = all.keys().filter_map(|&[u, v]| {
                    let other = if u == here {
                        v
                    } else if v == here {
                        u
                    } else {
                        return None;
                    };
                    (other != before && near(other) && ahead(other)).then_some(other)
                });
                let nearest = next.min_by(|&u, &v| {
                    at[u as usize].distance(at[here as usize]).total_cmp(&at[v as usize].distance(at[here as usize]))
                });
                (before, here) = (here, nearest.expect("the chain goes on"));
            }
        }
    }
}

/// Dozens of edges that lie within a few units in the last place of one line, or reach from there to the smallest numbers, cross
/// and overlap: every crossing that is rounded would make others, without end. All stay within rounding of where they were.
#[test]
fn bundles_of_edges_within_rounding_come_to_an_end() {
    let mut dice = Dice(6);
    for round in 0..120u32 {
        let point = |dice: &mut Dice| match round % 4 {
            0 => {
                let x = dice.unit();
                DVec2::new(x, x / 3.0 + dice.next(5) as f64 * 2f64.powi(-53))
            }
            1 => {
                let x = dice.next(30) as f64 / 7.0;
                DVec2::new(x, x / 3.0 + dice.next(3) as f64 * 2f64.powi(-52))
            }
            2 => {
                let mut small = || dice.unit() * 10f64.powi(-(dice.next(80) as i32));
                DVec2::new(small(), small())
            }
            _ => DVec2::splat(1e6) + DVec2::new(dice.next(4) as f64, dice.next(9) as f64) * 2f64.powi(-33),
        };
        let points: Vec<DVec2> = (0..40).map(|_| point(&mut dice)).collect();
        let given: Vec<[u32; 2]> = (0..60).map(|_| [dice.next(40) as u32, dice.next(40) as u32]).collect();
        let converted = ConstrainedDelaunay::new().convert(&graph(&points, &given)).unwrap();
        is_sound(&converted.value);
        let reach = if round % 4 == 3 { 1e6 } else { 5.0 };
        for name in ["crossing_rounding", "led_through_rounding"] {
            let off = converted.report.find(name).unwrap_or(0.0);
            assert!(off <= reach * 2f64.powi(-44), "{round} {name}: {off}");
        }
    }
}

#[test]
fn edges_that_touch_overlap_or_are_nothing_are_told() {
    let points = [(0.0, 0.0), (8.0, 0.0), (4.0, 0.0), (2.0, 0.0), (0.0, 5.0), (8.0, 5.0), (0.0, 0.0)].map(DVec2::from);
    let given = [[0, 1], [3, 2], [2, 4], [5, 5], [0, 6], [1, 0]];
    let converted = ConstrainedDelaunay::new().convert(&graph(&points, &given)).unwrap();
    let findings = &converted.report.findings;
    // The first runs through 2 and 3; the second and the last lie on it.
    assert_eq!(count_of(findings, "W-plane-through"), 2);
    assert_eq!(count_of(findings, "W-plane-overlap"), 2);
    assert_eq!(count_of(findings, "W-plane-point"), 2);
    assert_eq!(count_of(findings, "W-plane-duplicate"), 1);
    assert_eq!(converted.report.find("constraint_edges"), Some(4.0));
    is_sound(&converted.value);
}

/// Heights and attributes at a crossing are half of one edge and half of the other.
#[test]
fn crossings_lie_between_both_edges() {
    let points = [(0.0, 0.0, 0.0), (4.0, 4.0, 4.0), (0.0, 2.0, 10.0), (2.0, 0.0, 20.0)].map(DVec3::from);
    let mut graph = GeometricGraph::try_new(points.to_vec(), vec![[0, 1], [2, 3]]).unwrap();
    let heat = Column::try_new("heat", 1, Values::F64(vec![0.0, 8.0, 1.0, 3.0])).unwrap();
    graph.insert_vertex_attribute(heat).unwrap();
    graph.insert_edge_attribute(Column::labels("road", vec![1, 2])).unwrap();
    let converted = ConstrainedDelaunay::new().convert(&graph).unwrap();
    assert_eq!(converted.value.positions()[4], DVec3::new(1.0, 1.0, 0.5 * 1.0 + 0.5 * 15.0));
    assert_eq!(converted.value.attribute(Domain::Vertex, "heat").unwrap().number(4, 0), 0.5 * 2.0 + 0.5 * 2.0);
    assert_eq!(converted.report.find("crossing_height_gap"), Some(14.0));
    assert!(converted.report.losses.iter().any(|loss| loss.what == "edge attribute \"road\""));
}

#[test]
fn what_edges_enclose_is_kept() {
    let square = |low: f64, high: f64| [(low, low), (high, low), (high, high), (low, high)].map(DVec2::from);
    let points = [square(0.0, 10.0), square(1.0, 9.0), square(2.0, 8.0), square(12.0, 14.0)].concat();
    let mut given: Vec<[u32; 2]> = Vec::new();
    for first in [0, 4, 8, 12] {
        given.extend((0..4).map(|k| [first + k, first + (k + 1) % 4]));
    }
    // A dead end, a chord between corners of the innermost square, and an edge outside.
    given.extend([[0, 4], [8, 10], [2, 12]]);
    let enclosed = ConstrainedDelaunay { keep: KeptTriangles::Enclosed, ..ConstrainedDelaunay::new() };
    let converted = enclosed.convert(&graph(&points, &given)).unwrap();
    assert_eq!(converted.value.area(), 100.0 - 64.0 + 36.0 + 4.0);
    assert_eq!(converted.value.positions().len(), 16);
    let open = enclosed.convert(&graph(&points, &given[..3])).unwrap();
    assert_eq!((open.value.triangles().len(), count_of(&open.report.findings, "W-plane-empty")), (0, 1));
    assert_eq!(count_of(&open.report.findings, "W-plane-outside"), 16);
}
