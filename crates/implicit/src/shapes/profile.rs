//! Distances to convex polygons in a plane.

use shapeloom_core::glam::DVec2;

use crate::operator::Binary;
use crate::program::Value;
use crate::program::builder::Builder;

/// The signed distance to a convex polygon, its corners counter-clockwise. Sides given in `open` do not count.
pub(super) fn convex_polygon(builder: &mut Builder, [u, v]: [Value; 2], corners: &[DVec2], open: &[usize]) -> Value {
    let mut planes = None;
    let mut nearest = None;
    for (i, &a) in corners.iter().enumerate() {
        let along = corners[(i + 1) % corners.len()] - a;
        let length = along.length();
        if open.contains(&i) || length == 0.0 {
            continue;
        }
        let linear = |builder: &mut Builder, slope: DVec2, offset: f64| {
            let first = builder.times(u, slope.x);
            let second = builder.times(v, slope.y);
            let sum = builder.add(first, second);
            builder.plus(sum, offset)
        };
        let unit = along / length;
        let normal = DVec2::new(unit.y, -unit.x);
        let plane = linear(builder, normal, -normal.dot(a));
        planes = Some(planes.map_or(plane, |most| builder.maximum(most, plane)));
        // Across the side the plane's distance; along it how far beyond its ends.
        let place = linear(builder, unit, -unit.dot(a));
        let within = builder.clamp(place, 0.0, length);
        let beyond = builder.subtract(place, within);
        let (across, beyond) = (builder.square(plane), builder.square(beyond));
        let square = builder.add(across, beyond);
        nearest = Some(nearest.map_or(square, |least| builder.minimum(least, square)));
    }
    let (Some(planes), Some(nearest)) = (planes, nearest) else {
        return builder.constant(f64::INFINITY);
    };
    let inside = builder.negative_part(planes);
    let distance = builder.square_root(nearest);
    let outside = builder.positive_part(planes);
    // The root counts only outside: where the first operand is 0, so is the result.
    let outside = builder.binary(Binary::And, outside, distance);
    builder.add(inside, outside)
}
