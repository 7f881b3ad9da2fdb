//! Vertices on many crossed edges at once.

use multiversion::multiversion;
use shapeloom_core::glam::DVec3;

use crate::lattice_vertices::Site;

/// How many edges are done at once: their numbers stay in the first-level cache.
pub(crate) const BATCH: usize = 128;

/// A vertex that is made by itself.
#[derive(Clone, Copy, Debug)]
struct Own {
    at: usize,
    position: [f64; 3],
    normal: [f64; 3],
}

/// Crossed edges between finite samples, in the order of their vertices.
#[derive(Debug)]
pub(crate) struct EdgeBatch {
    len: usize,
    /// The samples at the lower and the upper end.
    samples: [[f32; BATCH]; 2],
    /// The lower end, in lattice coordinates.
    from: [[i32; BATCH]; 3],
    /// The number of the edge's direction, negative where the lower end is outside.
    directions: [i32; BATCH],
    /// The gradients at the lower and the upper end.
    gradients: [[[f64; BATCH]; 3]; 2],
    positions: [[f64; BATCH]; 3],
    normals: [[f64; BATCH]; 3],
    /// Whether a gradient has given a normal.
    sloped: [bool; BATCH],
    own: Vec<Own>,
}

impl EdgeBatch {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self {
            len: 0,
            samples: [[0.0; BATCH]; 2],
            from: [[0; BATCH]; 3],
            directions: [0; BATCH],
            gradients: [[[0.0; BATCH]; 3]; 2],
            positions: [[0.0; BATCH]; 3],
            normals: [[0.0; BATCH]; 3],
            sloped: [false; BATCH],
            own: Vec::with_capacity(BATCH),
        })
    }

    pub(crate) fn is_full(&self) -> bool {
        self.len >= BATCH
    }

    /// Adds an edge between finite samples of which exactly one is inside; there must be room.
    #[inline(always)]
    pub(crate) fn add(
        &mut self,
        samples: [f32; 2],
        from: [usize; 3],
        direction: u8,
        starts_inside: bool,
        gradients: Option<[[f64; 3]; 2]>,
    ) {
        let at = self.len % BATCH;
        for (to, sample) in self.samples.iter_mut().zip(samples) {
            to[at] = sample;
        }
        for (to, from) in self.from.iter_mut().zip(from) {
            to[at] = from as i32;
        }
        self.directions[at] = if starts_inside { i32::from(direction) } else { -i32::from(direction) };
        if let Some(gradients) = gradients {
            for (to, slope) in self.gradients.as_flattened_mut().iter_mut().zip(gradients.as_flattened()) {
                to[at] = *slope;
            }
        }
        self.len += 1;
    }

    /// Adds a vertex that was made by itself; there must be room.
    pub(crate) fn add_own(&mut self, position: [f64; 3], normal: [f64; 3]) {
        self.own.push(Own { at: self.len % BATCH, position, normal });
        self.add([0.0, 1.0], [0; 3], 0, true, Some([[0.0; 3]; 2]));
    }

    /// Makes the vertices, and is empty again.
    pub(crate) fn flush(&mut self, site: &Site, positions: &mut Vec<[f64; 3]>, normals: Option<&mut Vec<[f64; 3]>>) {
        place(self, site, normals.is_some());
        let len = self.len.min(BATCH);
        let first = positions.len();
        let [x, y, z] = &self.positions;
        positions.extend(x.iter().zip(y).zip(z).take(len).map(|((&x, &y), &z)| [x, y, z]));
        if let Some(normals) = normals {
            let first = normals.len();
            let [x, y, z] = &self.normals;
            normals.extend(x.iter().zip(y).zip(z).take(len).map(|((&x, &y), &z)| [x, y, z]));
            for at in (0..len).filter(|&at| !self.sloped[at]) {
                let direction = self.directions[at];
                let along = DVec3::from([0, 1, 2].map(|axis| f64::from(direction.abs() >> axis & 1)));
                normals[first + at] = site.normal(DVec3::ZERO, if direction > 0 { along } else { -along });
            }
            for own in &self.own {
                normals[first + own.at] = own.normal;
            }
        }
        for own in &self.own {
            positions[first + own.at] = own.position;
        }
        self.own.clear();
        self.len = 0;
    }
}

/// Places the vertices, and finds their normals, by the formulas of [`Site`].
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn place(batch: &mut EdgeBatch, site: &Site, normals: bool) {
    let EdgeBatch { samples: [low, high], from, directions, gradients, positions, normals: found, sloped, .. } = batch;
    let iso = f64::from(site.level.iso);
    let mut parts = [0.0; BATCH];
    let [ax, ay, az] = site.steps;
    let o = site.origin;
    let [px, py, pz] = positions;
    for n in 0..BATCH {
        let (a, b) = (f64::from(low[n]), f64::from(high[n]));
        let part = (iso - a) / (b - a);
        parts[n] = part;
        let direction = directions[n].abs();
        let x = f64::from(from[0][n]) + f64::from(direction & 1) * part;
        let y = f64::from(from[1][n]) + f64::from(direction >> 1 & 1) * part;
        let z = f64::from(from[2][n]) + f64::from(direction >> 2) * part;
        px[n] = ((o.x + az.x * z) + ay.x * y) + ax.x * x;
        py[n] = ((o.y + az.y * z) + ay.y * y) + ax.y * x;
        pz[n] = ((o.z + az.z * z) + ay.z * y) + ax.z * x;
    }
    if !normals {
        return;
    }
    let [start, end] = gradients;
    let [nx, ny, nz] = found;
    let matrix = site.normals;
    let (mx, my, mz) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    for n in 0..BATCH {
        let mix = |axis: usize| start[axis][n] + (end[axis][n] - start[axis][n]) * parts[n];
        let (x, y, z) = (mix(0), mix(1), mix(2));
        let largest = x.abs().max(y.abs()).max(z.abs());
        let scale = 1.0 / largest;
        let (x, y, z) = (x * scale, y * scale, z * scale);
        let u = mx.x * x + my.x * y + mz.x * z;
        let v = mx.y * x + my.y * y + mz.y * z;
        let w = mx.z * x + my.z * y + mz.z * z;
        let by_length = 1.0 / (u * u + v * v + w * w).sqrt();
        sloped[n] = by_length > 0.0 && by_length < f64::INFINITY;
        nx[n] = u * by_length;
        ny[n] = v * by_length;
        nz[n] = w * by_length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Inside, Lattice, Level};
    use shapeloom_core::Affine;
    use shapeloom_core::glam::DMat3;

    /// Each vertex beside the formula of its line, computed here another way.
    #[test]
    fn vertices_lie_where_their_edges_reach_the_level() {
        let linear =
            DMat3::from_cols(DVec3::new(0.3, 0.1, 0.0), DVec3::new(-0.05, 0.4, 0.0), DVec3::new(0.0, 0.1, -0.5));
        let placement = Affine { linear, translation: DVec3::new(5.0, -3.0, 7.0) };
        let lattice = Lattice::try_new([1000; 3], placement).unwrap();
        let level = Level { iso: 0.25, inside: Inside::Above };
        let site = Site::new(&lattice, level, 0, true);
        let mut batch = EdgeBatch::new();
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        let mut expected = Vec::new();
        for n in 0..300usize {
            let direction = (n % 7 + 1) as u8;
            let along = DVec3::new(f64::from(direction & 1), f64::from(direction >> 1 & 1), f64::from(direction >> 2));
            let from = [n, 2 * n, 999 - n];
            if n % 50 == 49 {
                batch.add_own([n as f64; 3], [0.0, 0.0, 1.0]);
                expected.push((DVec3::splat(n as f64), DVec3::Z));
            } else {
                let rises = n % 3 == 0;
                let (low, high) = (0.25 - 0.01 * (n + 1) as f32, 0.75);
                let ends = if rises { [low, high] } else { [high, low] };
                let part = (0.25 - f64::from(ends[0])) / (f64::from(ends[1]) - f64::from(ends[0]));
                let at = placement.point(DVec3::from(from.map(|at| at as f64)) + along * part);
                // Every fifth has no slope: its normal is along the edge.
                let slopes = if n % 5 == 0 { [DVec3::ZERO; 2] } else { [DVec3::new(1.0, -0.5, n as f64), DVec3::ONE] };
                let slope = slopes[0] * (1.0 - part) + slopes[1] * part;
                let outward = if slope != DVec3::ZERO { -slope } else { along * if rises { -1.0 } else { 1.0 } };
                expected.push((at, placement.normal(outward)));
                batch.add(ends, from, direction, !rises, Some(slopes.map(|slope| slope.to_array())));
            }
            if batch.is_full() {
                batch.flush(&site, &mut positions, Some(&mut normals));
            }
        }
        batch.flush(&site, &mut positions, Some(&mut normals));
        assert_eq!((positions.len(), normals.len()), (300, 300));
        for (n, (position, normal)) in expected.into_iter().enumerate() {
            // Coordinates are below a thousand, normals of length 1.
            assert!((DVec3::from(positions[n]) - position).length() < 1e-12, "{n}: {:?} {position}", positions[n]);
            assert!((DVec3::from(normals[n]) - normal).length() < 1e-12, "{n}: {:?} {normal}", normals[n]);
        }
    }
}
