//! Positions in single precision about a local origin.

use shapeloom_core::Aabb;
use shapeloom_core::VectorSpace;
use shapeloom_core::glam::DVec3;

/// Where to put points in single precision, and what it costs.
#[derive(Debug, PartialEq)]
pub(super) struct SinglePrecision {
    pub origin: DVec3,
    /// The largest distance between a point and what a reader that computes in double precision gets.
    pub rounding: f64,
}

/// How far from the origin, in multiples of the largest extent, coordinates may lie before they get an origin of their
/// own. Up to here at most two bits of 24 are gained, which is not worth a node that is not plain.
const FAR: f64 = 4.0;

/// The origin about which points are rounded to single precision. It is 0 where that is exact or where the points lie
/// near it; else it is the centre of their box, rounded to a single-precision multiple of a power of two so that every
/// reader gets it exactly, if this makes the rounding smaller.
///
/// # Errors
/// The index of a point whose coordinates single precision cannot hold.
pub(super) fn single_precision(points: &[DVec3]) -> Result<SinglePrecision, usize> {
    let plain = rounded(points, DVec3::ZERO)?;
    let bounds = Aabb::from_points(points.iter().copied());
    let (extent, reach) = (bounds.size().max_element(), bounds.min.abs().max(bounds.max.abs()).max_element());
    if plain.rounding == 0.0 || reach <= FAR * extent {
        return Ok(plain);
    }
    let center = bounds.center().to_array().map(|coordinate| few_bits(coordinate, extent));
    match rounded(points, DVec3::from_array(center)) {
        Ok(local) if local.rounding < plain.rounding => Ok(local),
        _ => Ok(plain),
    }
}

/// `coordinate` as a single-precision multiple of a power of two of about a sixteenth of `extent`.
fn few_bits(coordinate: f64, extent: f64) -> f64 {
    let exponent_alone = 0x7ff0_0000_0000_0000;
    let step = f64::from_bits((extent / 16.0).to_bits() & exponent_alone);
    let coarse = (coordinate / step).round() * step;
    let coarse = if coarse.is_finite() { coarse } else { coordinate };
    f64::from(coarse as f32)
}

/// Points in single precision about an origin.
pub(super) fn about(points: &[DVec3], origin: DVec3) -> Vec<f32> {
    points.iter().flat_map(|&point| (point - origin).as_vec3().to_array()).collect()
}

fn rounded(points: &[DVec3], origin: DVec3) -> Result<SinglePrecision, usize> {
    let mut rounding = 0.0f64;
    for (index, &point) in points.iter().enumerate() {
        let local = (point - origin).as_vec3();
        if !local.is_finite() {
            return Err(index);
        }
        // Not by squares, which vanish for tiny shapes.
        let error = VectorSpace::length(local.as_dvec3() + origin - point);
        // The length itself is rounded.
        rounding = rounding.max(if error > 0.0 { error * (1.0 + 4.0 * f64::EPSILON) } else { 0.0 });
    }
    Ok(SinglePrecision { origin, rounding })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cluster(at: DVec3) -> Vec<DVec3> {
        (0..50)
            .map(|i| at + DVec3::new(f64::from(i) * 0.1, (f64::from(i) * 0.7).sin(), 1.0 / f64::from(i + 3)))
            .collect()
    }

    #[test]
    fn plain_files_stay_plain() {
        let near = single_precision(&cluster(DVec3::new(3.0, 0.0, -7.0))).unwrap();
        assert_eq!(near.origin, DVec3::ZERO);
        assert!(near.rounding > 0.0 && near.rounding < 1e-6);
        // Whole numbers are exact however far away.
        let far = [DVec3::new(5e6, 1.0, 0.0), DVec3::new(5e6, 2.0, 0.0)];
        assert_eq!(single_precision(&far).unwrap(), SinglePrecision { origin: DVec3::ZERO, rounding: 0.0 });
    }

    #[test]
    fn far_points_get_an_origin_that_single_precision_holds() {
        let points = cluster(DVec3::new(5e6, -4.1e6, 12.0));
        let far = single_precision(&points).unwrap();
        assert!(far.origin.distance(points[0]) < 10.0);
        assert_eq!(far.origin.as_vec3().as_dvec3(), far.origin);
        assert!(far.rounding < 1e-6, "{}", far.rounding);
        for (point, local) in points.iter().zip(about(&points, far.origin).chunks(3)) {
            let back = far.origin + DVec3::new(f64::from(local[0]), f64::from(local[1]), f64::from(local[2]));
            assert!(back.distance(*point) <= far.rounding);
        }
    }

    #[test]
    fn lone_and_huge_points_are_handled() {
        let lone = single_precision(&[DVec3::splat(0.1)]).unwrap();
        assert!(lone.rounding < 1e-8);
        assert_eq!(single_precision(&[DVec3::ZERO, DVec3::splat(1e39)]), Err(1));
        assert_eq!(single_precision(&[]).unwrap().rounding, 0.0);
    }
}
