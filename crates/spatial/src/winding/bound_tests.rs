//! The proven bounds, held against brute force in many configurations.

use std::f64::consts::PI;

use glam::DVec3;
use shapeloom_core::Exec;

use super::cluster::Cluster;
use super::far::Node;
use super::near::WIDTH;
use super::reference::turns_of;
use super::{WindingTree, generalized_winding_number};
use crate::fixtures::{Draws, bumpy_ball};

fn clusters(draws: &mut Draws, kind: usize) -> Vec<[DVec3; 3]> {
    let (positions, triangles) = match kind {
        0 => draws.soup(1, |draws, _| draws.point()),
        1 => draws.soup(7, |draws, _| draws.point()),
        // Flat and facing one way.
        2 => draws.soup(40, |draws, _| draws.point() * DVec3::new(1.0, 1.0, 0.0)),
        // One needle far from a heap of small ones: the centre is far from the middle.
        3 => draws.soup(30, |draws, i| draws.point() * if i < 3 { DVec3::ONE } else { DVec3::splat(0.05) }),
        _ => bumpy_ball(5, DVec3::new(0.2, -0.1, 0.3), 0.6, 0.3),
    };
    let turn = |triangle: [u32; 3]| {
        let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
        if kind == 2 && (b - a).cross(c - a).z < 0.0 { [a, c, b] } else { [a, b, c] }
    };
    triangles.iter().map(|&triangle| turn(triangle)).collect()
}

fn exact(triangles: &[[DVec3; 3]], query: DVec3) -> f64 {
    triangles.iter().map(|corners| turns_of(corners, query).0).sum::<f64>() * 4.0 * PI
}

/// The cluster of all, made of the clusters of pairs, of fours and so on: what the tree does.
fn merged(triangles: &[[DVec3; 3]]) -> Cluster {
    let mut parts: Vec<Cluster> = triangles.chunks(2).map(|pair| Cluster::of_triangles(pair, DVec3::ZERO)).collect();
    while parts.len() > 1 {
        parts = parts.chunks(2).map(Cluster::of_clusters).collect();
    }
    parts[0]
}

#[test]
fn moments_and_radii_of_merged_clusters_are_those_of_their_triangles() {
    let mut draws = Draws::new(4);
    for kind in 0..5 {
        let triangles = clusters(&mut draws, kind);
        let (direct, merged) = (Cluster::of_triangles(&triangles, DVec3::ZERO), merged(&triangles));
        assert!((direct.center - merged.center).length() < 1e-6);
        for (a, b) in [
            (direct.quadrupole().to_vec(), merged.quadrupole().to_vec()),
            (direct.octupole().to_vec(), merged.octupole().to_vec()),
        ] {
            assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-5 * (1.0 + direct.area)), "{kind}: {a:?} {b:?}");
        }
        assert!((direct.square - merged.square).abs() < 1e-5 * direct.square);
        assert!(merged.cube >= direct.cube * 0.9 && merged.cube <= direct.cube * 3.0, "{kind}");
        let farthest = triangles.iter().flatten().map(|p| p.distance(merged.center)).fold(0.0, f64::max);
        assert!(merged.radius >= farthest && merged.radius <= 2.5 * farthest);
    }
}

/// Every cluster, distance and direction: the error is within the bound. Prints nothing; the least ratio is asserted,
/// so that the bound stays as tight as the page says.
#[test]
fn no_cluster_is_wrong_by_more_than_its_bound() {
    let mut draws = Draws::new(5);
    let mut tightest = 0.0f64;
    for kind in 0..5 {
        for _ in 0..8 {
            let triangles = clusters(&mut draws, kind);
            for cluster in [Cluster::of_triangles(&triangles, DVec3::ZERO), merged(&triangles)] {
                let node = Node::of(&[cluster]);
                for i in 0..100 {
                    let distance = cluster.radius * (1.4 + 0.01 * f64::from(i * i));
                    let query = cluster.center + draws.point().normalize() * distance;
                    let reach = query.abs().max_element();
                    let (out, open) = node.far_within(query.into(), reach, f64::INFINITY);
                    assert_eq!(open & 1, 0);
                    let error = (out[0][0] - exact(&triangles, query)).abs();
                    assert!(error <= out[1][0] + out[2][0], "{kind} {i}: {error} {out:?}");
                    tightest = tightest.max((error - out[2][0]) / out[1][0]);
                    assert!((1..WIDTH).all(|lane| out[0][lane] == 0.0 && out[1][lane] == 0.0 && out[2][lane] == 0.0));
                }
            }
        }
    }
    assert!(tightest > 0.1, "the bound is never within a factor of ten: {tightest}");
}

/// A thousand radii away truncation is nothing: what is left is the single precision of the moments.
#[test]
fn rounding_is_held_where_truncation_is_nothing() {
    let mut draws = Draws::new(12);
    let mut beyond_truncation = 0;
    for _ in 0..200 {
        let triangles = clusters(&mut draws, 0);
        let cluster = Cluster::of_triangles(&triangles, DVec3::ZERO);
        let query = cluster.center + draws.point().normalize() * (1000.0 * cluster.radius);
        let (out, _) = Node::of(&[cluster]).far_within(query.into(), query.abs().max_element(), f64::INFINITY);
        let error = (out[0][0] - exact(&triangles, query)).abs();
        // The reference itself is wrong by a few 1e-16.
        assert!(error <= out[1][0] + out[2][0] + 1e-15, "{error} {out:?}");
        beyond_truncation += u32::from(error > 2.0 * out[1][0] + 1e-15);
    }
    assert!(beyond_truncation > 50, "{beyond_truncation}");
}

/// A tiny triangle that looks along its offset from a far centre comes close to what the bound allows.
#[test]
fn the_bound_is_nearly_reached() {
    let small = |at: DVec3, size: f64| {
        let (x, y) = (DVec3::Z * size, DVec3::Y * size);
        [at, at + y, at + x]
    };
    // Two equally large ones keep the centre in the middle; both look outward, so that the term of degree four adds up.
    let [a, b, c] = small(-DVec3::X, 1e-3);
    let triangles = [small(DVec3::X, 1e-3), [a, c, b]];
    let cluster = Cluster::of_triangles(&triangles, DVec3::ZERO);
    let node = Node::of(&[cluster]);
    let query = cluster.center + DVec3::X * 3.0;
    let (out, _) = node.far_within(query.into(), 3.0, f64::INFINITY);
    let error = (out[0][0] - exact(&triangles, query)).abs();
    assert!(error <= out[1][0] && error > 0.6 * out[1][0], "{error} {out:?}");
    assert_eq!(node.far(query.as_vec3().into(), [0.0; 3], 2.0).1, 0);
}

#[test]
fn errors_shrink_with_the_cube_of_the_distance_over_the_radius() {
    let mut draws = Draws::new(6);
    for kind in [1, 3] {
        let triangles = clusters(&mut draws, kind);
        let cluster = merged(&triangles);
        let node = Node::of(&[cluster]);
        let worst = |ratio: f64| {
            let mut draws = Draws::new(60);
            let mut worst = 0.0f64;
            for _ in 0..60 {
                let query = cluster.center + draws.point().normalize() * cluster.radius * ratio;
                let high = query.as_vec3();
                let low = (query - high.as_dvec3()).as_vec3();
                let found = f64::from(node.far(high.into(), low.into(), 1.0).0[0]);
                // Times the square of the distance: a share of the area.
                worst = worst.max((found - exact(&triangles, query)).abs() * ratio * ratio);
            }
            worst
        };
        let shrinks = worst(4.0) / worst(16.0);
        assert!((40.0..120.0).contains(&shrinks), "{kind}: {shrinks}, expected about 4³ and more");
    }
}

/// Whole trees at many tolerances, against the definition: soups, shells, and both moved far away.
#[test]
fn no_tree_is_wrong_by_more_than_its_bound() {
    let mut draws = Draws::new(9);
    let exec = Exec::default();
    let soup = draws.soup(700, |draws, _| draws.point());
    let heap = draws.soup(700, |draws, i| {
        let center = DVec3::new((i / 3 % 5) as f64, (i / 15 % 3) as f64, 0.0);
        center + draws.point() * 0.02
    });
    let (mut checks, mut used) = (0, 0.0);
    for (positions, triangles) in
        [soup, heap, bumpy_ball(24, DVec3::ZERO, 1.0, 0.2), bumpy_ball(9, DVec3::ONE, 1.0, 0.9)]
    {
        for offset in [DVec3::ZERO, DVec3::new(5e6, -3e6, 1e6)] {
            let positions: Vec<DVec3> = positions.iter().map(|&p| p + offset).collect();
            let tree = WindingTree::build(&positions, &triangles, &exec).unwrap();
            for i in 0..120 {
                let corner = positions[draws.next() as usize % positions.len()];
                let query = match i % 4 {
                    0 => offset + draws.point() * 5.0,
                    1 => corner,
                    2 => corner + draws.point() * 1e-3,
                    _ => corner + draws.point() * 0.3,
                };
                let exact = generalized_winding_number(&positions, &triangles, query, &exec).unwrap();
                let blocks = tree.winding_number_exact(query);
                assert!((blocks.value - exact.value).abs() <= blocks.bound + exact.bound, "{blocks:?} {exact:?}");
                for tolerance in [2.0, 0.3, 1e-2, 1e-4, 0.0] {
                    let found = tree.winding_number_within(query, tolerance);
                    let error = (found.value - exact.value).abs();
                    assert!(error <= found.bound + exact.bound, "{query} {tolerance}: {found:?} {exact:?}");
                    assert!(found.bound <= tolerance.max(2.0 * blocks.bound), "{tolerance}: {found:?} {blocks:?}");
                    checks += 1;
                    used += error / found.bound.max(f64::MIN_POSITIVE);
                }
            }
        }
    }
    assert!(used / f64::from(checks) > 1e-4, "the bounds are loose beyond use");
}
