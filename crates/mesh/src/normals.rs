//! Normals of faces.

use shapeloom_core::glam::DVec3;

use crate::TriMesh;

/// The unit normal of a triangle; zero where its area is zero.
pub fn triangle_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac) = (b - a, c - a);
    // Scaling first keeps tiny and huge triangles from losing their normal to underflow and overflow.
    let size = ab.abs().max(ac.abs()).max_element();
    if size > 0.0 && size.is_finite() { (ab / size).cross(ac / size).normalize_or_zero() } else { DVec3::ZERO }
}

/// The unit normal of each triangle; zero where its area is zero.
pub fn face_normals(mesh: &TriMesh) -> Vec<DVec3> {
    (0..mesh.triangles().len()).map(|triangle| triangle_normal(mesh.corners(triangle))).collect()
}

/// The Newell vector of a closed outline: across the plane of a flat polygon, of length twice its area, concave or not.
pub fn newell_vector(outline: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let Some(first) = outline.clone().next() else {
        return DVec3::ZERO;
    };
    // Relative to the first corner, so that polygons far from the origin lose little.
    let spokes = outline.map(|corner| corner - first);
    spokes.clone().zip(spokes.skip(1)).map(|(a, b)| a.cross(b)).sum()
}

/// The length of a vector, also where its square is no number.
pub(crate) fn length(vector: DVec3) -> f64 {
    let size = vector.abs().max_element();
    if size > 0.0 { (vector / size).length() * size } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn concave_outline_gives_its_area() {
        // An L of three unit squares.
        let outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)];
        let corners = outline.map(|(x, y)| DVec3::new(f64::from(x), f64::from(y), 7.0));
        assert_eq!(newell_vector(corners.into_iter()), DVec3::new(0.0, 0.0, 6.0));
    }

    #[test]
    fn tiny_and_huge_triangles_have_normals() {
        for scale in [1e-200, 1.0, 1e200] {
            assert_eq!(triangle_normal([DVec3::ZERO, DVec3::X * scale, DVec3::Y * scale]), DVec3::Z);
        }
        assert_eq!(triangle_normal([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]), DVec3::ZERO);
        assert_eq!(triangle_normal([DVec3::NAN, DVec3::X, DVec3::Y]), DVec3::ZERO);
    }
}
