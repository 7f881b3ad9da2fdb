//! Segments that can be seen.

use shapeloom::core::glam::DVec3;
use shapeloom::render::SceneMesh;

/// A thin octahedron around a segment.
pub fn rod(a: DVec3, b: DVec3, radius: f64, color: [f32; 3]) -> SceneMesh {
    let along = (b - a).normalize();
    let (u, v) = along.any_orthonormal_pair();
    let (middle, ends) = ((a + b) / 2.0, (b - a) / 2.0 + along * radius);
    let corners = [u, v, -u, -v].map(|side| middle + side * radius);
    let positions = [&corners[..], &[middle + ends, middle - ends]].concat();
    let triangles = (0..4).flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]).collect();
    SceneMesh { color, ..SceneMesh::new(positions, triangles) }
}
