//! Sums at many points in single precision.

use std::cell::Cell;

use multiversion::multiversion;
use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;

use super::sum::Sum;
use super::term::{Fall, ROOM, Term};

/// How many points look for their terms together.
const GROUP: usize = 64;

/// How many points a term is added to at once: two registers of AVX. With more, terms reach too few of the points.
const LANES: usize = 16;

type Lanes = [f32; LANES];

/// A term relative to the origin of a batch. Exponentials are powers of 2 with the size in the exponent.
#[derive(Clone, Copy, Debug)]
struct Near {
    center: [f32; 3],
    scale: f32,
    /// The size; of exponentials its sign.
    size: f32,
    shift: f32,
    decay: f32,
    floor: f32,
}

/// Whether single precision holds the numbers of a term, with room for products.
pub(super) fn holds(term: &Term) -> bool {
    let within = |value: f64| value == 0.0 || (1e-36..1e37).contains(&value.abs());
    (1e-15..1e15).contains(&term.reach) && within(term.size) && within(term.floor)
}

impl Near {
    fn new(fall: Fall, term: &Term, origin: DVec3) -> Self {
        let to_powers_of_two = std::f64::consts::LOG2_E;
        let exponential = fall == Fall::Exponential;
        Self {
            center: (term.center - origin).to_array().map(|value| value as f32),
            scale: term.scale as f32,
            size: if exponential { term.size.signum() as f32 } else { term.size as f32 },
            shift: if exponential { (term.shift * to_powers_of_two + term.size.abs().log2()) as f32 } else { 0.0 },
            decay: (term.decay * to_powers_of_two) as f32,
            floor: term.floor as f32,
        }
    }
}

thread_local! {
    static NEAR: Cell<Vec<Near>> = const { Cell::new(Vec::new()) };
}

/// The values at points relative to an origin.
///
/// Terms that are left out at a point add nothing there, and the others are added in one order: the same bits however points are put
/// together.
pub(super) fn values(sum: &Sum, threshold: f32, origin: DVec3, points: [&[f32]; 3], out: &mut [f32]) {
    let mut near = NEAR.take();
    let mut start = 0;
    let mut group = GROUP;
    while start < out.len() {
        let count = group.min(out.len() - start);
        let part = points.map(|along| &along[start..start + count]);
        if !gather(sum, origin, part, &mut near) {
            // The points lie far apart.
            group = count.div_ceil(2);
            continue;
        }
        add_up(sum.fall(), &near, threshold, part, &mut out[start..start + count]);
        start += count;
        group = (2 * group).min(GROUP);
    }
    NEAR.set(near);
}

/// The terms that may reach any of the points; false where they are so many that fewer points should ask together.
fn gather(sum: &Sum, origin: DVec3, points: [&[f32]; 3], near: &mut Vec<Near>) -> bool {
    near.clear();
    let ends = points.map(bounds_of);
    let lo = DVec3::from_array(ends.map(|(lo, _)| f64::from(lo)));
    let hi = DVec3::from_array(ends.map(|(_, hi)| f64::from(hi)));
    // Room for the rounding of centres relative to the origin, and of the points themselves.
    let size = lo.abs().max(hi.abs()).max_element();
    let room = size * 1e-6 + origin.abs().max_element() * 1e-15;
    let region = Aabb { min: origin + lo, max: origin + hi }.padded(room);
    let count = points[0].len();
    let mut most = if count == 1 { usize::MAX } else { 64 + 32 * count };
    loop {
        near.clear();
        let all = sum.hierarchy().meeting(&region, |leaf| {
            for term in &sum.terms()[leaf] {
                if term.q_over(&region).0 < 1.0 + ROOM {
                    near.push(Near::new(sum.fall(), term, origin));
                }
            }
            near.len() <= most
        });
        if all {
            return true;
        }
        // Where many terms reach a single point, they are no sign of points that lie far apart.
        let first = origin + DVec3::from_array(points.map(|along| f64::from(along[0])));
        let mut around = 0;
        sum.hierarchy().around(first, |leaf| around += leaf.len());
        if 8 * around <= most {
            return false;
        }
        most = 8 * around;
    }
}

/// The smallest and the largest number; NaN are passed over.
#[inline(always)]
fn bounds_of(numbers: &[f32]) -> (f32, f32) {
    let (mut lo, mut hi) = (f32::INFINITY, f32::NEG_INFINITY);
    for &number in numbers {
        lo = if number < lo { number } else { lo };
        hi = if number > hi { number } else { hi };
    }
    (lo, hi)
}

#[multiversion(targets("x86_64+avx+avx2"))]
fn add_up(fall: Fall, near: &[Near], threshold: f32, points: [&[f32]; 3], out: &mut [f32]) {
    for start in (0..out.len()).step_by(LANES) {
        let count = LANES.min(out.len() - start);
        let mut lanes = [[0.0; LANES]; 3];
        for (lanes, along) in lanes.iter_mut().zip(points) {
            lanes[..count].copy_from_slice(&along[start..start + count]);
            // The rest of the lanes are computed and thrown away.
            lanes[count..].fill(along[start]);
        }
        let mut sums = [0.0; LANES];
        match fall {
            Fall::Exponential => add_all(near, &lanes, &mut sums, |term, q| {
                term.size * power_of_two(term.shift - term.decay * q) - term.floor
            }),
            Fall::Metaball => add_all(near, &lanes, &mut sums, |term, q| {
                let left = 1.0 - q.sqrt();
                let outer = 1.5 * left * left;
                term.size * if q <= 1.0 / 9.0 { 1.0 - 3.0 * q } else { outer }
            }),
            Fall::Soft => add_all(near, &lanes, &mut sums, |term, q| {
                let left = 1.0 - q;
                term.size * (left * left * (1.0 - (4.0 / 9.0) * q))
            }),
        }
        let [x, y, z] = lanes;
        for i in 0..LANES {
            let number = !(x[i].is_nan() || y[i].is_nan() || z[i].is_nan());
            sums[i] = if number { threshold - sums[i] } else { f32::NAN };
        }
        out[start..start + count].copy_from_slice(&sums[..count]);
    }
}

#[inline(always)]
fn add_all(near: &[Near], points: &[Lanes; 3], sums: &mut Lanes, value: impl Fn(&Near, f32) -> f32) {
    let ends = points.each_ref().map(|along| bounds_of(along));
    let [x, y, z] = points;
    for term in near {
        let [a, b, c] = term.center;
        // As in `Term::q_over`: no point has a smaller q.
        let gap = |(lo, hi): (f32, f32), center: f32| (lo - center).max(center - hi).max(0.0) * term.scale;
        let [u, v, w] = [gap(ends[0], a), gap(ends[1], b), gap(ends[2], c)];
        if (u * u + v * v) + w * w >= 1.0 {
            continue;
        }
        for i in 0..LANES {
            let [u, v, w] = [(x[i] - a) * term.scale, (y[i] - b) * term.scale, (z[i] - c) * term.scale];
            let q = (u * u + v * v) + w * w;
            let added = value(term, q);
            sums[i] += if q < 1.0 { added } else { 0.0 };
        }
    }
}

/// 2 to a power, off by at most 3e-7 of itself from -126 to 126, and the same bits on every machine; powers below count as -126.
///
/// The power is a whole number, which goes into the exponent's bits, and a rest of at most 1/2, whose power of two is a polynomial of
/// degree 5: the one with the smallest relative error (7.5e-8), found by reweighted least squares.
#[inline(always)]
fn power_of_two(power: f32) -> f32 {
    // Added to 1.5 · 2^23, the last bits of a number are its nearest whole number.
    const SHIFTER: f32 = 12_582_912.0;
    let power = if power > -126.0 { power } else { -126.0 };
    let shifted = power + SHIFTER;
    let rest = power - (shifted - SHIFTER);
    let exponent = shifted.to_bits().wrapping_add(127) << 23;
    let mut value = 0.001_327_647_2;
    value = value * rest + 0.009_675_541;
    value = value * rest + 0.055_507_13;
    value = value * rest + 0.240_221_2;
    value = value * rest + 0.693_146_94;
    value = value * rest + 1.000_000_1;
    value * f32::from_bits(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_within_their_bound() {
        let mut worst = 0.0_f64;
        for i in -1_260_000..1_260_000 {
            let power = i as f32 * 1e-4;
            let exact = f64::from(power).exp2();
            worst = worst.max((f64::from(power_of_two(power)) / exact - 1.0).abs());
        }
        assert!(worst < 3e-7, "{worst:e}");
        assert_eq!(power_of_two(f32::NEG_INFINITY), power_of_two(-126.0));
    }
}
