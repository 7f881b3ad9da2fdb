//! Points that planes come near.

use shapeloom_core::glam::{DMat3, DVec3};

/// The point for which the sum of squared values of `normal · (x - point)` is smallest, and of those that are alike nearest to
/// `center`: directions in which a singular value is at most `threshold` times the largest do not count.
pub(crate) fn least_squares(planes: impl Iterator<Item = (DVec3, DVec3)>, center: DVec3, threshold: f64) -> DVec3 {
    let mut matrix = DMat3::ZERO;
    let mut right = DVec3::ZERO;
    for (normal, point) in planes {
        matrix += DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        right += normal * normal.dot(point - center);
    }
    let (values, vectors) = eigen(matrix);
    let largest = values.into_iter().fold(0.0, f64::max);
    let mut found = center;
    for (value, vector) in values.into_iter().zip([vectors.x_axis, vectors.y_axis, vectors.z_axis]) {
        // Eigenvalues are squares of singular values.
        if value > threshold * threshold * largest {
            found += vector * (vector.dot(right) / value);
        }
    }
    if found.is_finite() { found } else { center }
}

/// Eigenvalues and vectors of a symmetric matrix, by Jacobi's rotations.
fn eigen(matrix: DMat3) -> ([f64; 3], DMat3) {
    let mut a = matrix.to_cols_array_2d();
    let mut vectors = DMat3::IDENTITY.to_cols_array_2d();
    // It converges quadratically: six sweeps are more than ever needed.
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for rows in [&mut a, &mut vectors] {
                let (x, y) = (DVec3::from(rows[p]), DVec3::from(rows[q]));
                (rows[p], rows[q]) = ((x * c - y * s).to_array(), (x * s + y * c).to_array());
            }
            (a[p][q], a[q][p]) = (0.0, 0.0);
        }
    }
    ([a[0][0], a[1][1], a[2][2]], DMat3::from_cols_array_2d(&vectors))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_planes_meet_in_a_point_and_two_in_its_nearest() {
        let corner = DVec3::new(0.3, 0.6, 0.2);
        let center = DVec3::splat(0.5);
        let normals = [DVec3::new(1.0, 0.2, -0.1), DVec3::new(0.1, 1.0, 0.3), DVec3::new(-0.2, 0.1, 1.0)];
        let slide = |normal: DVec3, k: f64| corner + normal.any_orthogonal_vector() * k;
        let planes = |count: usize| normals.into_iter().take(count).map(move |normal| (normal, slide(normal, 0.7)));
        assert!(least_squares(planes(3), center, 0.1).distance(corner) < 1e-14);
        // On both planes, and moved from the centre across their line alone.
        let near = least_squares(planes(2), center, 0.1);
        assert!((0..2).all(|k| normals[k].dot(near - corner).abs() < 1e-14));
        assert!((near - center).dot(normals[0].cross(normals[1])).abs() < 1e-14);
        // No plane, or one as often as one likes.
        assert_eq!(least_squares(planes(0), center, 0.1), center);
        let flat = least_squares((0..9).map(|k| (DVec3::X, DVec3::new(0.25, f64::from(k), 3.0))), center, 0.1);
        assert!(flat.distance(DVec3::new(0.25, 0.5, 0.5)) < 1e-15);
    }

    /// Planes that nearly agree are one plane: their corner far away does not count.
    #[test]
    fn small_singular_values_do_not_count() {
        let planes = |tilt: f64| {
            [DVec3::new(1.0, tilt, 0.0), DVec3::new(1.0, -tilt, 0.0)]
                .map(|normal| (normal, DVec3::new(0.0, 5.0 * tilt, 0.0)))
        };
        let far = least_squares(planes(0.05).into_iter(), DVec3::ZERO, 1e-6);
        assert!((far.y - 0.25).abs() < 1e-12, "{far}");
        assert!(least_squares(planes(0.05).into_iter(), DVec3::ZERO, 0.1).y.abs() < 1e-12);
    }
}
