//! Distances from samples to a triangle, eight at a time.

use shapeloom_core::glam::DVec3;

/// How many samples are looked at together.
pub(super) const LANES: usize = 8;

/// Triangles beyond this many cells are measured in double precision alone: their squares would leave single precision.
const LARGE: f64 = 65536.0;

/// A triangle in a frame of its own: the longest side from `(0, 0)` to `(length, 0)`, the third corner above it.
///
/// All three sides and the plane are then well described whatever the shape: a needle or a triangle without area has small numbers, not
/// unsafe ones.
pub(super) struct Frame {
    origin: DVec3,
    axes: [DVec3; 3],
    length: f64,
    apex: [f64; 2],
    /// Over the squared lengths of the sides, 0 for sides of no length.
    inverse: [f64; 3],
    /// How large triangle and surroundings are.
    pub size: f64,
}

impl Frame {
    #[inline(always)]
    pub fn new(corners: &[DVec3; 3], reach: f64) -> Self {
        let [a, b, c] = *corners;
        let sides = [(b - a).length_squared(), (c - b).length_squared(), (a - c).length_squared()];
        // The longest side first.
        let (a, b, c) = if sides[0] >= sides[1] && sides[0] >= sides[2] {
            (a, b, c)
        } else if sides[1] >= sides[2] {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let (along, aside) = (b - a, c - a);
        let length = along.length();
        let u = if length > 0.0 { along / length } else { DVec3::X };
        let across = aside - u * aside.dot(u);
        // Twice is enough: what is left along `u` is rounding of the first time.
        let across = across - u * across.dot(u);
        let height = across.length();
        let v = if height > 0.0 { across / height } else { u.any_orthonormal_vector() };
        let w = u.cross(v);
        let apex = [aside.dot(u), height];
        let inverse_of = |x: f64, y: f64| {
            let squared = x * x + y * y;
            if squared > 0.0 { 1.0 / squared } else { 0.0 }
        };
        let inverse = [inverse_of(length, 0.0), inverse_of(apex[0] - length, height), inverse_of(apex[0], height)];
        Self { origin: a, axes: [u, v, w], length, apex, inverse, size: length + 2.0 * reach + 4.0 }
    }

    /// The squared distance of a place, in double precision: exact up to some 1e-15 of the triangle's size and the distance.
    #[inline(always)]
    pub fn distance_squared(&self, place: DVec3) -> f64 {
        let from = place - self.origin;
        let [u, v, w] = self.axes.map(|axis| axis.dot(from));
        let plane = w * w;
        let [cu, cv] = self.apex;
        let (eu, ev) = (cu - self.length, cv);
        let (pu, pv) = (u - self.length, v);
        if v > 0.0 && eu * pv - ev * pu > 0.0 && cv * u - cu * v > 0.0 {
            return plane;
        }
        let square = |x: f64, y: f64| x * x + y * y;
        let first = square(u - u.clamp(0.0, self.length), v);
        let t = ((pu * eu + pv * ev) * self.inverse[1]).clamp(0.0, 1.0);
        let second = square(pu - t * eu, pv - t * ev);
        let t = ((u * cu + v * cv) * self.inverse[2]).clamp(0.0, 1.0);
        let third = square(u - t * cu, v - t * cv);
        plane + first.min(second).min(third)
    }

    /// The box of the frame around all that the triangle reaches, for rows that begin at `base`.
    #[inline(always)]
    pub fn reach_box(&self, base: DVec3, reach: f64) -> ReachBox {
        let from = base - self.origin;
        // A little wider than it is, for rounding.
        let reach = reach + self.size * 1e-12;
        ReachBox {
            is_large: self.length > 4.0,
            start: self.axes.map(|axis| axis.dot(from)),
            steps: self.axes,
            low: [-reach; 3],
            high: [self.length + reach, self.apex[1] + reach, reach],
        }
    }

    /// The same in single precision, for places about `base`.
    #[inline(always)]
    pub fn rough(&self, base: DVec3, reach: f64) -> Rough {
        let from = base - self.origin;
        let start = self.axes.map(|axis| axis.dot(from) as f32);
        let steps = self.axes.map(|axis| axis.as_vec3().to_array());
        // Each coordinate has a few roundings of 2^-24 of the size, and so has each difference of them.
        let error = self.size * 2f64.powi(-20);
        Rough {
            start,
            steps,
            length: self.length as f32,
            apex: self.apex.map(|x| x as f32),
            inverse: [self.inverse[1] as f32, self.inverse[2] as f32],
            slack: (2.0 * error * (reach + error + 1.0)) as f32,
            all: self.size > LARGE,
        }
    }
}

/// All that a triangle reaches, as a box along the axes of its frame.
pub(super) struct ReachBox {
    is_large: bool,
    start: [f64; 3],
    steps: [DVec3; 3],
    low: [f64; 3],
    high: [f64; 3],
}

impl ReachBox {
    /// The part of a row in the box; small triangles are not worth it.
    #[inline(always)]
    pub fn cut(&self, y: f64, z: f64, (mut from, mut to): (f64, f64)) -> (f64, f64) {
        if !self.is_large {
            return (from, to);
        }
        for axis in 0..3 {
            let step = self.steps[axis];
            let at = self.start[axis] + step.y * y + step.z * z;
            let (low, high) = (self.low[axis] - at, self.high[axis] - at);
            // Where the row hardly moves along the axis, all of it or nothing.
            if step.x.abs() < 1e-6 {
                let (a, b) = (step.x * from, step.x * to);
                if (a < low && b < low) || (a > high && b > high) {
                    return (1.0, 0.0);
                }
                continue;
            }
            let (a, b) = (low / step.x, high / step.x);
            from = from.max(a.min(b));
            to = to.min(a.max(b));
        }
        (from, to)
    }
}

/// A triangle's frame in single precision.
pub(super) struct Rough {
    start: [f32; 3],
    /// What the coordinates in the frame gain with a step along each axis: `steps[frame axis][lattice axis]`.
    steps: [[f32; 3]; 3],
    length: f32,
    apex: [f32; 2],
    inverse: [f32; 2],
    /// No squared distance within reach is larger than the true one by more than this.
    slack: f32,
    /// Whether single precision tells nothing.
    all: bool,
}

impl Rough {
    /// Which of the samples `(x + lane, y, z)` may be nearer than the squared distances that they have, a bit each.
    #[inline(always)]
    pub fn may_be_nearer(&self, [x, y, z]: [f32; 3], known: &[f32; LANES]) -> u32 {
        if self.all {
            return (1 << LANES) - 1;
        }
        let row = |axis: usize| {
            let step = &self.steps[axis];
            self.start[axis] + (step[1] * y + step[2] * z)
        };
        let (u0, v0, w0) = (row(0), row(1), row(2));
        let [cu, cv] = self.apex;
        let (eu, ev) = (cu - self.length, cv);
        let mut squared = [0f32; LANES];
        for (lane, squared) in squared.iter_mut().enumerate() {
            let x = x + lane as f32;
            let u = u0 + self.steps[0][0] * x;
            let v = v0 + self.steps[1][0] * x;
            let w = w0 + self.steps[2][0] * x;
            let pu = u - self.length;
            let du = u - clamp(u, self.length);
            let first = du * du + v * v;
            let t = clamp((pu * eu + v * ev) * self.inverse[0], 1.0);
            let (du, dv) = (pu - t * eu, v - t * ev);
            let second = du * du + dv * dv;
            let t = clamp((u * cu + v * cv) * self.inverse[1], 1.0);
            let (du, dv) = (u - t * cu, v - t * cv);
            let third = du * du + dv * dv;
            let least = smaller(smaller(first, second), third);
            let inside = (v > 0.0) & (eu * v - ev * pu > 0.0) & (cv * u - cu * v > 0.0);
            *squared = w * w + if inside { 0.0 } else { least };
        }
        let mut bits = 0u32;
        for lane in 0..LANES {
            bits |= u32::from(squared[lane] < known[lane] + self.slack) << lane;
        }
        bits
    }
}

/// Between 0 and `most`, as one instruction each.
#[inline(always)]
fn clamp(x: f32, most: f32) -> f32 {
    let x = if x > 0.0 { x } else { 0.0 };
    if x < most { x } else { most }
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
