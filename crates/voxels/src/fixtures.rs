//! Shapes and numbers for tests.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, Exec};
use shapeloom_mesh::primitives::{Cylinder, Platonic, Solid, Torus};
use shapeloom_mesh::{TriMesh, TriangulatePolygons};

/// A small generator of numbers that look random (SplitMix64).
pub(crate) struct Dice(pub u64);

impl Dice {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn point(&mut self) -> DVec3 {
        DVec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// A box along the axes, faces outward.
pub(crate) fn block(low: DVec3, high: DVec3) -> TriMesh {
    let corner = |c: u32| DVec3::new(f64::from(c & 1), f64::from(c >> 1 & 1), f64::from(c >> 2));
    let positions = (0..8).map(|c| low + (high - low) * corner(c)).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh::try_new(positions, triangles).unwrap()
}

pub(crate) fn torus(segments: u32, sides: u32) -> TriMesh {
    let torus = Torus { segments, sides, ..Torus::new() }.mesh(&Exec::default()).unwrap().value;
    TriangulatePolygons::new().convert(&torus).unwrap().value
}

pub(crate) fn icosahedron() -> TriMesh {
    let solid = Platonic::new(Solid::Icosahedron).mesh(&Exec::default()).unwrap().value;
    TriangulatePolygons::new().convert(&solid).unwrap().value
}

pub(crate) fn cylinder() -> TriMesh {
    let solid = Cylinder { segments: 24, ..Cylinder::new() }.mesh(&Exec::default()).unwrap().value;
    TriangulatePolygons::new().convert(&solid).unwrap().value
}

/// The triangles of some meshes in one.
pub(crate) fn together(meshes: &[TriMesh]) -> TriMesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.positions());
        triangles.extend(mesh.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    TriMesh::try_new(positions, triangles).unwrap()
}

/// Some of the triangles.
pub(crate) fn some(mesh: &TriMesh, keep: impl Fn(usize) -> bool) -> TriMesh {
    let triangles =
        mesh.triangles().iter().enumerate().filter(|(i, _)| keep(*i)).map(|(_, triangle)| *triangle).collect();
    TriMesh::try_new(mesh.positions().to_vec(), triangles).unwrap()
}

/// Triangles at random.
pub(crate) fn soup(count: u32, size: f64, seed: u64) -> TriMesh {
    let mut dice = Dice(seed);
    let mut positions = Vec::new();
    for _ in 0..count {
        let center = dice.point();
        positions.extend([0; 3].map(|_| center + dice.point() * size));
    }
    let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    TriMesh::try_new(positions, triangles).unwrap()
}

/// The distance to a segment.
pub(crate) fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let squared = along.length_squared();
    let t = if squared > 0.0 { ((p - a).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + along * t)
}

/// The distance to the nearest of all triangles, by trying each.
pub(crate) fn brute_distance(mesh: &TriMesh, p: DVec3) -> f64 {
    let to_triangle = |[a, b, c]: [DVec3; 3]| {
        let normal = (b - a).cross(c - a);
        let left = |from: DVec3, to: DVec3| normal.cross(to - from).dot(p - from) >= 0.0;
        if normal.length_squared() > 0.0 && left(a, b) && left(b, c) && left(c, a) {
            return (p - a).dot(normal.normalize()).abs();
        }
        to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a))
    };
    (0..mesh.triangles().len()).map(|i| to_triangle(mesh.corners(i))).fold(f64::INFINITY, f64::min)
}
