//! What the converters of this folder are held to, by exact arithmetic that shares nothing with them.

mod constrained;
mod cramped;
mod located;
mod refined;
mod regions;
mod scattered;

use std::collections::HashMap;

use shapeloom_core::Findings;
use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::orient2d;

use crate::TriMesh;

/// Numbers that look random, the same in every run.
pub(super) struct Dice(pub(super) u64);

impl Dice {
    pub(super) fn next(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }

    /// From -bound to bound.
    pub(super) fn whole(&mut self, bound: u64) -> f64 {
        self.next(2 * bound + 1) as f64 - bound as f64
    }

    pub(super) fn unit(&mut self) -> f64 {
        self.next(1 << 30) as f64 / f64::from(1 << 30)
    }
}

pub(super) fn flat(mesh: &TriMesh) -> Vec<DVec2> {
    mesh.positions().iter().map(|position| position.truncate()).collect()
}

/// Every edge with the triangles at it, and their third corners.
pub(super) fn edges(mesh: &TriMesh) -> HashMap<[u32; 2], Vec<u32>> {
    let mut edges: HashMap<[u32; 2], Vec<u32>> = HashMap::new();
    for &[a, b, c] in mesh.triangles() {
        for (from, to, apex) in [(a, b, c), (b, c, a), (c, a, b)] {
            edges.entry([from.min(to), from.max(to)]).or_default().push(apex);
        }
    }
    edges
}

/// Checks that no triangle is turned over or flat, that edges have two triangles at most, and returns how many edges have
/// one.
pub(super) fn is_sound(mesh: &TriMesh) -> usize {
    let at = flat(mesh);
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|vertex| at[vertex as usize]);
        assert!(orient2d(a, b, c).is_gt(), "{triangle:?}: {a} {b} {c}");
    }
    let edges = edges(mesh);
    assert!(edges.values().all(|apexes| apexes.len() <= 2));
    edges.values().filter(|apexes| apexes.len() == 1).count()
}

/// Twice the area of triangles between whole numbers, exactly.
pub(super) fn twice_area(mesh: &TriMesh) -> i128 {
    let whole = |p: DVec3| [p.x as i128, p.y as i128];
    let turn = |[a, b, c]: [[i128; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let corners = |triangle: &[u32; 3]| triangle.map(|vertex| whole(mesh.positions()[vertex as usize]));
    mesh.triangles().iter().map(|triangle| turn(corners(triangle))).sum()
}

pub(super) fn count_of(findings: &Findings, code: &str) -> u64 {
    findings.iter().find(|finding| finding.code == code).map_or(0, |finding| finding.count)
}

pub(super) fn raised(points: &[DVec2]) -> Vec<DVec3> {
    points.iter().map(|point| point.extend(0.0)).collect()
}
