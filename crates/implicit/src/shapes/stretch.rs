//! How much an affine map stretches.

use shapeloom_core::{Affine, AffineClass};

/// The least and the largest factor by which a map stretches lengths: its singular values. A similarity has its scale twice, to the bit.
pub(crate) fn stretches(map: &Affine) -> (f64, f64) {
    match map.class(1e-12) {
        AffineClass::Rigid => return (1.0, 1.0),
        AffineClass::Similarity { scale } => return (scale, scale),
        AffineClass::Singular | AffineClass::General => {}
    }
    let columns = [map.linear.x_axis, map.linear.y_axis, map.linear.z_axis];
    let size = columns.iter().map(|column| column.abs().max_element()).fold(0.0, f64::max);
    if !(size > 0.0 && size.is_finite()) {
        return (0.0, size);
    }
    let columns = columns.map(|column| column / size);
    let mut square = [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[i].dot(columns[j])));
    // Jacobi's rotations: quadratic convergence, so eight sweeps are more than enough for three rows.
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut square, p, q);
        }
    }
    let values = [square[0][0], square[1][1], square[2][2]].map(|value| value.max(0.0).sqrt() * size);
    let least = values.into_iter().fold(f64::INFINITY, f64::min);
    // Room for the rounding of the products, so that what is multiplied by it stays a bound.
    (least * (1.0 - 1e-12), values.into_iter().fold(0.0, f64::max))
}

/// Turns the entry at row p, column q to 0.
fn rotate(matrix: &mut [[f64; 3]; 3], p: usize, q: usize) {
    let across = matrix[p][q];
    if across == 0.0 {
        return;
    }
    let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * across);
    let tangent = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
    let sine = tangent * cosine;
    for row in matrix.iter_mut() {
        (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
    }
    let (first, second) = (matrix[p], matrix[q]);
    matrix[p] = [0, 1, 2].map(|k| cosine * first[k] - sine * second[k]);
    matrix[q] = [0, 1, 2].map(|k| sine * first[k] + cosine * second[k]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::AxisAngle;
    use shapeloom_core::glam::DVec3;

    #[test]
    fn turned_scales_are_found_again() {
        let turn = |angle| Affine::from_rotation(AxisAngle::new(DVec3::new(1.0, 2.0, -0.5), angle).unwrap());
        let map = turn(0.7) * Affine::from_scale(DVec3::new(3.0, 0.2, 1.5)) * turn(-1.9);
        let (least, most) = stretches(&map);
        assert!((least - 0.2).abs() < 1e-11 && (most - 3.0).abs() < 1e-11, "{least} {most}");
        assert_eq!(stretches(&turn(2.0)), (1.0, 1.0));
    }
}
