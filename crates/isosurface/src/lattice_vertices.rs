//! Vertices on crossed edges of a lattice.

use shapeloom_core::glam::{DMat3, DVec3};

use crate::edge_batch::EdgeBatch;
use crate::{Inside, Lattice, Level};

/// Where a lattice is, and how normals are mapped from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    pub(crate) origin: DVec3,
    pub(crate) steps: [DVec3; 3],
    /// Maps gradients with respect to lattice coordinates to outward normals, but for their length.
    pub(crate) normals: DMat3,
    pub(crate) level: Level,
    /// Whether all samples are finite and not large, as far as they were read.
    tame: bool,
    /// The layers of outside samples around the lattice.
    pub(crate) margin: usize,
}

impl Site {
    pub(crate) fn new(lattice: &Lattice, level: Level, margin: usize, tame: bool) -> Self {
        let linear = lattice.placement().linear;
        // The adjugate's direction alone matters; scaled first, so that it neither overflows nor vanishes.
        let size = lattice.spacing().max_element();
        let scaled = linear * (1.0 / size);
        let outward = if level.inside == Inside::Below { 1.0 } else { -1.0 };
        let normals = scaled.inverse().transpose() * outward;
        Self { origin: lattice.placement().translation, steps: lattice.steps(), normals, level, tame, margin }
    }

    /// The place of lattice coordinates. It depends on their values alone, so that two crossings at one sample coincide.
    #[inline(always)]
    pub(crate) fn place(&self, x: f64, y: f64, z: f64) -> [f64; 3] {
        let [along_x, along_y, along_z] = self.steps;
        (((self.origin + along_z * z) + along_y * y) + along_x * x).to_array()
    }

    /// The outward normal for a gradient, or for a direction from inside to outside where there is none.
    #[inline(always)]
    pub(crate) fn normal(&self, gradient: DVec3, otherwise: DVec3) -> [f64; 3] {
        let unit = |gradient: DVec3| {
            let largest = gradient.abs().max_element();
            (self.normals * (gradient * (1.0 / largest))).try_normalize()
        };
        let side = if self.level.inside == Inside::Below { 1.0 } else { -1.0 };
        let found = unit(gradient).or_else(|| unit(otherwise * side));
        found.unwrap_or(DVec3::Z).to_array()
    }
}

/// Samples of neighbouring slabs, from the one before a layer of cells to the one behind it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Samples<'a> {
    /// The slabs at `k - 1`, `k`, `k + 1`, `k + 2`, where they are; those at the ends only for gradients.
    pub(crate) slabs: [Option<&'a [f32]>; 4],
    pub(crate) columns: usize,
    pub(crate) rows: usize,
}

impl<'a> Samples<'a> {
    /// A row of samples: of the slab `k` or, above, `k + 1`, without the margin.
    #[inline(always)]
    fn row(&self, j: usize, above: usize) -> Option<&'a [f32]> {
        if j >= self.rows {
            return None;
        }
        self.slabs[1 + above]?.get(j * self.columns..(j + 1) * self.columns)
    }

    /// A sample of the slab `k` or, above, `k + 1`.
    pub(crate) fn get(&self, i: usize, j: usize, above: usize) -> Option<f32> {
        self.row(j, above)?.get(i).copied()
    }

    /// A row of samples and those around it.
    #[inline(always)]
    fn around(&self, j: usize, above: usize) -> Option<RowAround<'a>> {
        let own = self.row(j, above)?;
        let beside = [j.checked_sub(1).and_then(|j| self.row(j, above)), self.row(j + 1, above)];
        let slabs = [above.checked_sub(1), Some(above + 1)].map(|at| match at {
            Some(at) => self.row(j, at),
            // The slab before the one that rows are counted from.
            None => self.slabs[0]?.get(j * self.columns..(j + 1) * self.columns),
        });
        Some(RowAround::new(own, [beside, slabs]))
    }

    /// The gradient at a sample with respect to lattice coordinates, by central differences, at the border by one-sided ones.
    pub(crate) fn gradient(&self, i: usize, j: usize, above: usize) -> DVec3 {
        self.around(j, above).map_or(DVec3::ZERO, |around| DVec3::from(around.gradient(i)))
    }
}

/// A row of samples with those next to it: itself where there is none.
#[derive(Clone, Copy, Debug)]
struct RowAround<'a> {
    own: &'a [f32],
    /// Before and behind along `y`, then along `z`.
    beside: [[&'a [f32]; 2]; 2],
    /// What differences along these are multiplied by: a half, or one at the border.
    factors: [f64; 2],
}

impl<'a> RowAround<'a> {
    #[inline(always)]
    fn new(own: &'a [f32], beside: [[Option<&'a [f32]>; 2]; 2]) -> Self {
        let factor = |[low, high]: [Option<&[f32]>; 2]| if low.is_some() && high.is_some() { 0.5 } else { 1.0 };
        let [y, z] = beside;
        let rows = |[low, high]: [Option<&'a [f32]>; 2]| [low.unwrap_or(own), high.unwrap_or(own)];
        Self { own, beside: [rows(y), rows(z)], factors: [factor(y), factor(z)] }
    }

    /// The gradient at a sample by differences.
    #[inline(always)]
    fn gradient(&self, i: usize) -> [f64; 3] {
        let last = self.own.len() - 1;
        let factor = if i > 0 && i < last { 0.5 } else { 1.0 };
        let slope = |low: f32, high: f32, factor: f64| (f64::from(high) - f64::from(low)) * factor;
        let [[y0, y1], [z0, z1]] = self.beside;
        [
            slope(self.own[i.saturating_sub(1)], self.own[(i + 1).min(last)], factor),
            slope(y0[i], y1[i], self.factors[0]),
            slope(z0[i], z1[i], self.factors[1]),
        ]
    }
}

/// A row of edges in one direction, by the words that say which are crossed.
pub(crate) struct EdgeRow<'a> {
    /// The samples at the start of the edges.
    pub(crate) own: &'a [u64],
    /// The row of the samples at their end.
    pub(crate) other: &'a [u64],
    /// How many samples a row has.
    pub(crate) columns: usize,
}

/// The bits below `count` in word `w`.
#[inline(always)]
pub(crate) fn bits_below(count: usize, w: usize) -> u64 {
    match count.saturating_sub(64 * w) {
        0 => 0,
        left @ 1..64 => (1 << left) - 1,
        _ => u64::MAX,
    }
}

/// The word in which each bit is the next one of a row.
#[inline(always)]
pub(crate) fn next_bits(row: &[u64], w: usize) -> u64 {
    row[w] >> 1 | if w + 1 < row.len() { row[w + 1] << 63 } else { 0 }
}

impl EdgeRow<'_> {
    /// Which of 64 edges are crossed.
    #[inline(always)]
    pub(crate) fn crossed(&self, direction: u8, w: usize) -> u64 {
        match direction & 1 {
            0 => self.own[w] ^ self.other[w],
            _ => (self.own[w] ^ next_bits(self.other, w)) & bits_below(self.columns - 1, w),
        }
    }

    #[inline(always)]
    pub(crate) fn count(&self, direction: u8) -> u32 {
        let mut count = 0;
        for w in 0..self.own.len() {
            count += self.crossed(direction, w).count_ones();
        }
        count
    }

    /// Adds the vertices of a row of edges that start at samples `(.., j, k)`, counted with the margin.
    #[inline(always)]
    pub(crate) fn vertices<const DIRECTION: u8>(
        &self,
        samples: &Samples<'_>,
        [j, k]: [usize; 2],
        vertices: &mut Vertices<'_>,
    ) {
        let [dx, dy, dz] = [0, 1, 2].map(|axis| usize::from(DIRECTION >> axis & 1));
        let (site, margin) = (vertices.site, vertices.site.margin);
        // Rows of the margin are beyond every row of samples, also below 0.
        let (row, slab) = (j.wrapping_sub(margin), k.wrapping_sub(margin));
        let from = samples.row(row, 0).unwrap_or(&[]);
        let to = samples.row(row.wrapping_add(dy), dz).unwrap_or(&[]);
        let around = match vertices.normals.is_some() {
            true => samples.around(row, 0).zip(samples.around(row.wrapping_add(dy), dz)),
            false => None,
        };
        for first in (0..self.own.len()).step_by(WORDS) {
            let mut count = 0;
            for w in first..(first + WORDS).min(self.own.len()) {
                let mut crossed = self.crossed(DIRECTION, w);
                let end = count + crossed.count_ones() as usize;
                // Most words have few: these are written without asking how many there are, which would be guessed wrong.
                for _ in 0..SURE {
                    vertices.places[count] = 64 * w + crossed.trailing_zeros() as usize;
                    crossed &= crossed.wrapping_sub(1);
                    count += 1;
                }
                while crossed != 0 {
                    vertices.places[count] = 64 * w + crossed.trailing_zeros() as usize;
                    crossed &= crossed - 1;
                    count += 1;
                }
                count = end;
            }
            for at in 0..count {
                let i = vertices.places[at];
                let starts_inside = self.own[i / 64] >> (i % 64) & 1 == 1;
                let column = i.wrapping_sub(margin);
                match (from.get(column), to.get(column.wrapping_add(dx))) {
                    (Some(&a), Some(&b)) if site.tame => {
                        // Not by `map`: closures are not compiled for the wider vectors of the caller.
                        #[allow(clippy::manual_map)]
                        let gradients = match &around {
                            Some((start, end)) => Some([start.gradient(column), end.gradient(column + dx)]),
                            None => None,
                        };
                        vertices.batch.add([a, b], [column, row, slab], DIRECTION, starts_inside, gradients);
                    }
                    ends => vertices.add_own(ends, samples, [column, row, slab], DIRECTION, starts_inside),
                }
                if vertices.batch.is_full() {
                    vertices.flush();
                }
            }
        }
    }
}

/// How many words of edges are looked at together.
const WORDS: usize = 4;

/// So many edges of each word are written down in any case: few have more.
const SURE: usize = 4;

/// Room for the places of all of them.
pub(crate) const PLACES: usize = 64 * WORDS + SURE;

/// Where vertices go to, and those that are on the way.
pub(crate) struct Vertices<'a> {
    pub(crate) site: &'a Site,
    pub(crate) batch: Box<EdgeBatch>,
    /// Places of crossed edges in some words of a row.
    pub(crate) places: [usize; PLACES],
    /// The number of the vertex at the start of `positions`.
    pub(crate) first: u32,
    pub(crate) positions: &'a mut Vec<[f64; 3]>,
    pub(crate) normals: Option<&'a mut Vec<[f64; 3]>>,
}

impl Vertices<'_> {
    /// Writes the vertices that are on the way.
    pub(crate) fn flush(&mut self) {
        self.batch.flush(self.site, self.positions, self.normals.as_deref_mut());
    }

    /// Makes room for vertices that are written later.
    pub(crate) fn skip(&mut self, count: u32) {
        for _ in 0..count {
            self.batch.add_own([0.0; 3], [0.0; 3]);
            if self.batch.is_full() {
                self.flush();
            }
        }
    }

    /// Adds the vertex of an edge by itself: to the margin, or between samples that may be anything.
    #[cold]
    fn add_own(
        &mut self,
        ends: (Option<&f32>, Option<&f32>),
        samples: &Samples<'_>,
        [column, row, slab]: [usize; 3],
        direction: u8,
        starts_inside: bool,
    ) {
        let site = self.site;
        let [dx, dy, dz] = [0, 1, 2].map(|axis| usize::from(direction >> axis & 1));
        let (position, gradient) = if let (Some(&a), Some(&b)) = ends {
            let part = site.level.crossing(a, b);
            let along = |from: usize, step: usize| if step == 1 { from as f64 + part } else { from as f64 };
            let position = site.place(along(column, dx), along(row, dy), along(slab, dz));
            let mut gradient = DVec3::ZERO;
            if self.normals.is_some() {
                let start = samples.gradient(column, row, 0);
                let end = samples.gradient(column + dx, row + dy, dz);
                gradient = start + (end - start) * part;
            }
            (position, gradient)
        } else {
            // Of an edge to the margin the end that is inside.
            let [x, y, z] = match starts_inside {
                true => [column, row, slab],
                false => [column.wrapping_add(dx), row.wrapping_add(dy), slab.wrapping_add(dz)],
            };
            (site.place(x as f64, y as f64, z as f64), DVec3::ZERO)
        };
        let mut normal = [0.0; 3];
        if self.normals.is_some() {
            let along = DVec3::new(dx as f64, dy as f64, dz as f64);
            normal = site.normal(gradient, if starts_inside { along } else { -along });
        }
        self.batch.add_own(position, normal);
    }

    /// Writes a vertex inside a cell, for which room was made.
    pub(crate) fn write_inner(&mut self, samples: &Samples<'_>, cell: [usize; 3], number: u32, [x, y, z]: [f64; 3]) {
        let margin = self.site.margin as f64;
        let at = (number - self.first) as usize;
        let [i, j, k] = cell.map(|start| start as f64 - margin);
        self.positions[at] = self.site.place(i + x, j + y, k + z);
        let Some(normals) = self.normals.as_deref_mut() else { return };
        let [i, j] = [cell[0], cell[1]].map(|start| start.wrapping_sub(self.site.margin));
        let corners = (0..8usize).filter_map(|corner| {
            let (column, row) = (i.wrapping_add(corner & 1), j.wrapping_add(corner >> 1 & 1));
            samples.get(column, row, corner >> 2)?;
            let part = |bit: usize, x: f64| if corner >> bit & 1 == 1 { x } else { 1.0 - x };
            Some(samples.gradient(column, row, corner >> 2) * (part(0, x) * part(1, y) * part(2, z)))
        });
        normals[at] = self.site.normal(corners.sum(), DVec3::Z);
    }
}
