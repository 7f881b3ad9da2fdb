//! Ten million rays from inside closed meshes, aimed at what triangles share: none may slip out.

use std::f64::consts::TAU;

use glam::DVec3;
use shapeloom_core::{Exec, Ray, Rays};

use crate::TriangleBvh;
use crate::fixtures::{Draws, bumpy_ball};

const RAYS_A_SHAPE: usize = 1_430_000;

/// Sends rays at corners, at middles of sides and at other points of them, from eyes that `eye` draws inside.
fn assert_tight(
    name: &str,
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    mut eye: impl FnMut(&mut Draws) -> DVec3,
) -> usize {
    let exec = Exec::default();
    let bvh = TriangleBvh::build(positions, triangles, &exec).unwrap();
    let mut draws = Draws::new(77);
    let mut rays = Vec::with_capacity(RAYS_A_SHAPE);
    while rays.len() < RAYS_A_SHAPE {
        let from = eye(&mut draws);
        for _ in 0..50 {
            let triangle = triangles[draws.next() as usize % triangles.len()];
            let side = draws.next() as usize % 3;
            let [a, b] = [triangle[side], triangle[(side + 1) % 3]].map(|corner| positions[corner as usize]);
            let along = [0.0, 0.5, 0.5 + 0.5 * draws.signed()][draws.next() as usize % 3];
            rays.push(Ray::new(from, a + (b - a) * along - from).unwrap());
        }
    }
    let mut met = vec![false; rays.len()];
    bvh.any_hits(&rays, &mut met, &exec).unwrap();
    let leak = met.iter().position(|&met| !met);
    assert_eq!(leak, None, "{name}: {:?}", leak.map(|leak| rays[leak]));
    let some = &rays[..rays.len() / 10];
    let mut hits = vec![None; some.len()];
    bvh.first_hits(some, &mut hits, &exec).unwrap();
    assert!(hits.iter().all(Option::is_some), "{name}");
    rays.len()
}

/// A tube of radius 0.3 about the unit circle.
fn torus(around: u32, across: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (TAU * f64::from(i) / f64::from(around), TAU * f64::from(j) / f64::from(across));
            let radius = 1.0 + 0.3 * v.cos();
            positions.push(DVec3::new(radius * u.cos(), radius * u.sin(), 0.3 * v.sin()));
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    (positions, triangles)
}

/// Two cones over a circle: two corners that thousands of triangles share.
fn fan(valence: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut positions = vec![DVec3::Z, DVec3::NEG_Z];
    let mut triangles = Vec::new();
    for i in 0..valence {
        let turn = TAU * f64::from(i) / f64::from(valence);
        positions.push(DVec3::new(turn.cos(), turn.sin(), 0.01 * (7.0 * turn).sin()));
        let [a, b] = [2 + i, 2 + (i + 1) % valence];
        triangles.extend([[0, a, b], [1, b, a]]);
    }
    (positions, triangles)
}

#[test]
fn ten_million_rays_do_not_leak() {
    let near = |draws: &mut Draws| draws.point() * 0.2;
    let mut sent = 0;
    let (positions, triangles) = bumpy_ball(50, DVec3::ZERO, 1.0, 0.0);
    sent += assert_tight("sphere", &positions, &triangles, near);
    let (positions, triangles) = bumpy_ball(50, DVec3::ZERO, 1.0, 0.2);
    sent += assert_tight("bumpy ball", &positions, &triangles, near);
    for scale in [1e-9, 1e150] {
        let scaled: Vec<DVec3> = positions.iter().map(|&p| p * scale).collect();
        sent += assert_tight("scaled", &scaled, &triangles, |draws| draws.point() * 0.2 * scale);
    }
    let center = DVec3::new(5e6, -3e6, 4.2e6);
    let (positions, triangles) = bumpy_ball(50, center, 1.0, 0.1);
    sent += assert_tight("far away", &positions, &triangles, |draws| center + draws.point() * 0.2);
    let (positions, triangles) = torus(90, 40);
    sent += assert_tight("torus", &positions, &triangles, |draws| {
        let (sin, cos) = (TAU * draws.signed()).sin_cos();
        DVec3::new(cos, sin, 0.0) + draws.point() * 0.1
    });
    let (positions, triangles) = fan(5000);
    sent += assert_tight("fan", &positions, &triangles, near);
    assert!(sent >= 10_000_000, "{sent}");
}
