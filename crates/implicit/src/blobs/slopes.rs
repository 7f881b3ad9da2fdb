//! How fast a sum changes at most.

use shapeloom_core::glam::DVec3;

use super::sum::Sum;

/// A number that no slope of the sum exceeds: the largest sum of the terms' own largest slopes over the cells of a coarse lattice, each
/// with the terms whose boxes meet it.
///
/// Terms are added at the corners of their ranges of cells and summed along the axes afterwards, so that the cost is linear in terms
/// and cells however large the terms are.
pub(super) fn largest_slope(sum: &Sum) -> f64 {
    let (terms, fall, bounds) = (sum.terms(), sum.fall(), sum.bounds());
    let all: f64 = terms.iter().map(|term| term.steepest(fall)).sum();
    // Room for the rounding of sums and differences.
    let room = all * f64::EPSILON * 8.0 * (terms.len() as f64 + 64.0);
    let size = bounds.size();
    if terms.len() < 3 || !size.is_finite() || size.min_element() <= 0.0 {
        return all + room;
    }
    let side = (2.0 * (terms.len() as f64).cbrt()).clamp(4.0, 48.0) as usize;
    let stride = side + 1;
    let mut cells = vec![0.0; stride * stride * stride];
    let cell = |at: DVec3, axis: usize| {
        let place = (at[axis] - bounds.min[axis]) / size[axis] * side as f64;
        // Rounding keeps the order: a point of a box has a cell between those of the box's corners.
        (place as usize).min(side - 1)
    };
    for term in terms {
        let own = term.bounds();
        let slope = term.steepest(fall);
        let from: [usize; 3] = std::array::from_fn(|axis| cell(own.min, axis));
        let to: [usize; 3] = std::array::from_fn(|axis| cell(own.max, axis) + 1);
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 1 { to[axis] } else { from[axis] };
            let sign = if (corner as u32).count_ones() % 2 == 1 { -slope } else { slope };
            cells[(pick(2) * stride + pick(1)) * stride + pick(0)] += sign;
        }
    }
    for step in [1, stride, stride * stride] {
        for at in 0..cells.len() {
            if at / step % stride > 0 {
                cells[at] += cells[at - step];
            }
        }
    }
    cells.into_iter().fold(0.0, f64::max).min(all) + room
}
