//! The largest difference between a triangle and the bilinear surface above it.

use super::lattice_delaunay::doubled_area;
use shapeloom_core::{Exec, Stop};

/// Heights over a lattice, times a power of two that keeps differences of differences finite.
pub(super) struct Heights<'a> {
    pub heights: &'a [f64],
    pub columns: u32,
    pub scale: f64,
}

/// Where a triangle is farthest from the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Farthest {
    /// How far, at any point of the triangle.
    pub error: f64,
    /// How far at the samples in it.
    pub at_samples: f64,
    /// The sample that is farthest.
    pub sample: [u32; 2],
    /// The lowest corner of the cell in which a slanted side is farthest.
    pub cell: [u32; 2],
}

impl Heights<'_> {
    pub(super) fn at(&self, x: u32, y: u32) -> f64 {
        self.heights[y as usize * self.columns as usize + x as usize] * self.scale
    }

    /// h00 − h10 − h01 + h11 of a cell: its surface is its twist times s·t, and something linear on each line s or t.
    pub(super) fn twist(&self, x: u32, y: u32) -> f64 {
        (self.at(x, y) - self.at(x + 1, y)) - (self.at(x, y + 1) - self.at(x + 1, y + 1))
    }

    /// The largest difference over a triangle between samples, which no sample of a hole may lie in.
    ///
    /// In the part of a triangle over one cell the difference is T·s·t plus something linear, which has no maximum or
    /// minimum inside. So the largest is on the border of that part: on a side of the cell, where it is linear, at an end,
    /// which is a sample or a point of a side of the triangle; else on a side of the triangle, where it is a quadratic.
    pub(super) fn farthest(&self, corners: [[u32; 2]; 3], exec: &Exec) -> Result<Farthest, Stop> {
        let mut found = self.over_samples(corners, exec)?;
        found.error = found.at_samples;
        let [a, b, c] = corners;
        for (p, q) in [(a, b), (b, c), (c, a)] {
            self.along_side(p, q, &mut found);
        }
        Ok(found)
    }

    fn over_samples(&self, corners: [[u32; 2]; 3], exec: &Exec) -> Result<Farthest, Stop> {
        let mut found = Farthest { sample: corners[0], ..Farthest::default() };
        let mut sorted = corners;
        sorted.sort_unstable_by_key(|corner| (corner[1], corner[0]));
        let [low, middle, high] = sorted;
        let area = doubled_area(corners[0], corners[1], corners[2]) as f64;
        let heights = corners.map(|[x, y]| self.at(x, y));
        // The triangle's height by weights that are whole numbers, so that slivers lose nothing.
        let plane = |p: [u32; 2]| {
            let [a, b, c] = corners;
            let weights = [doubled_area(b, c, p), doubled_area(c, a, p), doubled_area(a, b, p)];
            (heights[0] * weights[0] as f64 + heights[1] * weights[1] as f64 + heights[2] * weights[2] as f64) / area
        };
        let [u, v] = [1, 2].map(|i| {
            let [dx, dy] = [0, 1].map(|axis| f64::from(corners[i][axis]) - f64::from(corners[0][axis]));
            (dx, dy, heights[i] - heights[0])
        });
        let slope = (u.2 * v.1 - v.2 * u.1) / area;
        let mut since = 0;
        for y in low[1]..=high[1] {
            let rising = y < middle[1] || middle[1] == high[1];
            let bent = if rising { crossing(low, middle, y) } else { crossing(middle, high, y) };
            let ends = (crossing(low, high, y), bent);
            let (one, other) = if ends.0.0 <= ends.1.0 && ends.0.1 <= ends.1.1 { ends } else { (ends.1, ends.0) };
            // The first whole number not left of the one side, and the last not right of the other.
            let (from, to) = (one.1, other.0);
            if from > to {
                continue;
            }
            since += to - from;
            if since > 1 << 20 {
                exec.check()?;
                since = 0;
            }
            let start = y as usize * self.columns as usize;
            let row = &self.heights[start + from as usize..=start + to as usize];
            let left = plane([from, y]);
            let worst = worst_of_row(row, left, slope, self.scale);
            if worst > found.at_samples {
                let difference = |k: usize| (row[k] * self.scale - (left + slope * k as f64)).abs();
                let k = (0..row.len()).find(|&k| difference(k) >= worst).unwrap_or_default();
                found.at_samples = worst;
                found.sample = [from + k as u32, y];
            }
        }
        Ok(found)
    }

    /// The difference along a side of a triangle. Where it crosses lines of the grid the surface is linear between two
    /// samples; between two crossings it is the chord less T·Δx·Δy·τ(1 − τ), τ from 0 to 1.
    fn along_side(&self, p: [u32; 2], q: [u32; 2], found: &mut Farthest) {
        // The same from both ends, so that neighbours find the same.
        let (p, q) = if p <= q { (p, q) } else { (q, p) };
        let (width, height) = (q[0] - p[0], p[1].abs_diff(q[1]));
        if width == 0 || height == 0 {
            return;
        }
        let upward = q[1] > p[1];
        let (dx, dy) = (u64::from(width), u64::from(height));
        let (fx, fy) = (f64::from(width), f64::from(height));
        let (start, end) = (self.at(p[0], p[1]), self.at(q[0], q[1]));
        let chord = |part: f64| start + (end - start) * part;
        let row = |steps: u32| if upward { p[1] + steps } else { p[1] - steps };
        let (mut i, mut j) = (0, 0);
        let (mut entry, mut before) = ([0.0f64; 2], 0.0f64);
        while i < width && j < height {
            let (to_x, to_y) = (u64::from(i + 1) * dy, u64::from(j + 1) * dx);
            let (x, near, far) = (p[0] + i, row(j), row(j + 1));
            // Where the side leaves the cell, in parts of the cell, and the difference there.
            let (exit, after) = if to_x == to_y {
                ([1.0, 1.0], self.at(x + 1, far) - chord(f64::from(i + 1) / fx))
            } else if to_x < to_y {
                let within = (to_x - u64::from(j) * dx) as f64 / fx;
                let [a, b] = [near, far].map(|row| self.at(x + 1, row));
                ([1.0, within], a + (b - a) * within - chord(f64::from(i + 1) / fx))
            } else {
                let within = (to_y - u64::from(i) * dy) as f64 / fy;
                let [a, b] = [x, x + 1].map(|column| self.at(column, far));
                ([within, 1.0], a + (b - a) * within - chord(f64::from(j + 1) / fy))
            };
            let bend = (self.at(x, near) - self.at(x + 1, near) - (self.at(x, far) - self.at(x + 1, far)))
                * (exit[0] - entry[0])
                * (exit[1] - entry[1]);
            let rise = after - before;
            let mut worst = after.abs();
            if rise.abs() < bend.abs() {
                let place = 0.5 - rise / (2.0 * bend);
                worst = worst.max((before + rise * place - bend * place * (1.0 - place)).abs());
            }
            if worst > found.error {
                found.error = worst;
                found.cell = [x, near.min(far)];
            }
            i += u32::from(to_x <= to_y);
            j += u32::from(to_y <= to_x);
            entry = exit.map(|part| if part == 1.0 { 0.0 } else { part });
            before = after;
        }
    }
}

/// The whole numbers next to where a side is at a row: the last not right of it, and the first not left of it.
fn crossing(low: [u32; 2], high: [u32; 2], y: u32) -> (u32, u32) {
    let height = i64::from(high[1]) - i64::from(low[1]);
    let across = (i64::from(high[0]) - i64::from(low[0])) * (i64::from(y) - i64::from(low[1]));
    let floor = i64::from(low[0]) + across.div_euclid(height);
    (floor as u32, (floor + i64::from(across.rem_euclid(height) != 0)) as u32)
}

/// The largest difference in a row, eight at a time: a maximum does not depend on the order.
fn worst_of_row(row: &[f64], left: f64, slope: f64, scale: f64) -> f64 {
    let (blocks, rest) = row.as_chunks::<8>();
    let mut lanes = [0.0f64; 8];
    for (number, block) in blocks.iter().enumerate() {
        let first = (8 * number) as f64;
        for k in 0..8 {
            let difference = (block[k] * scale - (left + slope * (first + k as f64))).abs();
            lanes[k] = if difference > lanes[k] { difference } else { lanes[k] };
        }
    }
    let first = 8 * blocks.len();
    let rest = rest.iter().enumerate().map(|(k, height)| (height * scale - (left + slope * (first + k) as f64)).abs());
    lanes.into_iter().chain(rest).fold(0.0, f64::max)
}
