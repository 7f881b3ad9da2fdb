//! How far quadrilaterals are from flat.

use shapeloom_core::glam::DVec3;

use crate::{Blend, Column, MeshError, PolyMesh, TransformRule, Values};

/// The customary name of the largest distance of a face's corners from its mean plane.
pub const PLANARITY: &str = "planarity";

/// How far four points are from a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QuadPlanarity {
    /// The distance between the lines through the diagonals, with the sign of the tetrahedron of the corners in order.
    /// Zero for four points in a plane, and where the diagonals are parallel or without length.
    pub between_diagonals: f64,
    /// The same over half the sum of the diagonals' lengths: a number without units, 0 for a flat quadrilateral.
    pub relative: f64,
}

impl QuadPlanarity {
    /// The measures of a quadrilateral by its corners in order.
    pub fn of([a, b, c, d]: [DVec3; 4]) -> Self {
        let (first, second) = (c - a, d - b);
        // Of length 1, so that products of tiny and of huge lengths are still numbers.
        let normal = unit(first).cross(unit(second)).normalize_or_zero();
        let between_diagonals = normal.dot(b - a);
        let mean = (first.length() + second.length()) / 2.0;
        let relative = if mean > 0.0 { between_diagonals.abs() / mean } else { 0.0 };
        Self { between_diagonals, relative }
    }

    /// The largest distance of a corner from the mean plane, which is parallel to both diagonals and half way between
    /// them: all four corners are equally far.
    pub fn from_plane(&self) -> f64 {
        self.between_diagonals.abs() / 2.0
    }
}

fn unit(vector: DVec3) -> DVec3 {
    let size = vector.abs().max_element();
    if size > 0.0 { (vector / size).normalize_or_zero() } else { DVec3::ZERO }
}

/// A column for the faces of a mesh: how far each face's corners are from its mean plane, in model units, by
/// [`PolyMesh::planarity`].
///
/// # Errors
/// None for a mesh that was checked.
pub fn planarity_column(mesh: &PolyMesh) -> Result<Column, MeshError> {
    let values = (0..mesh.face_count()).map(|face| mesh.planarity(face)).collect();
    let column = Column::try_new(PLANARITY, 1, Values::F64(values))?;
    Ok(column.with_blend(Blend::Linear).with_transform(TransformRule::None))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cell of z = a·x·y with sides p and q.
    #[test]
    fn a_saddle_has_its_closed_form() {
        for (a, p, q) in [(1.0f64, 1.0f64, 1.0f64), (-0.3, 2.0, 0.5), (10.0, 1.0, 3.0)] {
            let at = |x: f64, y: f64| DVec3::new(x, y, a * x * y);
            for (x, y) in [(0.0, 0.0), (1.0, -2.0)] {
                let corners = [at(x, y), at(x + p, y), at(x + p, y + q), at(x, y + q)];
                let found = QuadPlanarity::of(corners);
                let (first, second) = (corners[2] - corners[0], corners[3] - corners[1]);
                // The diagonals are over each other in the middle of the cell, a·p·q/2 apart along z.
                let wanted = -a * p * q / 2.0 * (2.0 * p * q) / first.cross(second).length();
                assert!((found.between_diagonals - wanted).abs() < 1e-14, "{found:?} {wanted}");
                let mesh = PolyMesh::from_faces(corners.to_vec(), &[[0, 1, 2, 3]]).unwrap();
                assert!((mesh.planarity(0) - found.from_plane()).abs() < 1e-14);
                assert_eq!(planarity_column(&mesh).unwrap().number(0, 0), mesh.planarity(0));
            }
        }
        // The unit cell of z = x·y: 1/√6.
        let unit = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y];
        assert!((QuadPlanarity::of(unit).between_diagonals.abs() - 1.0 / 6f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn flat_and_degenerate_quadrilaterals_are_flat() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::new(3.0, 2.0, 0.0), DVec3::Y];
        assert_eq!(QuadPlanarity::of(flat).between_diagonals, 0.0);
        for points in [[DVec3::ONE; 4], [DVec3::ZERO, DVec3::X, DVec3::X * 2.0, DVec3::X * 3.0]] {
            assert_eq!(QuadPlanarity::of(points), QuadPlanarity::default());
        }
        for size in [1e-300, 1e-9, 1e150] {
            let bent = [DVec3::ZERO, DVec3::X, DVec3::ONE, DVec3::Y].map(|corner| corner * size);
            let found = QuadPlanarity::of(bent);
            assert!((found.between_diagonals.abs() / size * 6f64.sqrt() - 1.0).abs() < 1e-14, "{size} {found:?}");
        }
    }
}
