//! Vertices on crossed edges of a lattice.

use shapeloom_core::glam::{DMat3, DVec3};

use crate::{Inside, Lattice, Level};

/// Where a lattice is, and how normals are mapped from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    origin: DVec3,
    steps: [DVec3; 3],
    /// Maps gradients with respect to lattice coordinates to outward normals, but for their length.
    normals: DMat3,
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

    /// The gradient at a sample with respect to lattice coordinates, by central differences, at the border by one-sided ones.
    #[inline(always)]
    pub(crate) fn gradient(&self, i: usize, j: usize, above: usize) -> DVec3 {
        let at = j * self.columns + i;
        let Some(slab) = self.slabs[1 + above] else { return DVec3::ZERO };
        let columns = self.columns;
        let own = slab[at];
        let x = difference(
            if i > 0 { Some(slab[at - 1]) } else { None },
            own,
            if i + 1 < columns { Some(slab[at + 1]) } else { None },
        );
        let y = difference(
            if j > 0 { Some(slab[at - columns]) } else { None },
            own,
            if j + 1 < self.rows { Some(slab[at + columns]) } else { None },
        );
        let [before, behind] = [self.slabs[above], self.slabs[2 + above]];
        let z = difference(before.map(|slab| slab[at]), own, behind.map(|slab| slab[at]));
        DVec3::new(x, y, z)
    }
}

/// The slope at the middle one of three samples, of which the first and the last may be missing.
#[inline(always)]
fn difference(low: Option<f32>, own: f32, high: Option<f32>) -> f64 {
    match (low, high) {
        (Some(low), Some(high)) => (f64::from(high) - f64::from(low)) * 0.5,
        (None, Some(high)) => f64::from(high) - f64::from(own),
        (Some(low), None) => f64::from(own) - f64::from(low),
        (None, None) => 0.0,
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

    /// Writes the vertices of a row of edges that start at samples `(.., j, k)`, counted with the margin.
    #[inline(always)]
    pub(crate) fn vertices<const DIRECTION: u8>(
        &self,
        site: &Site,
        samples: &Samples<'_>,
        [j, k]: [usize; 2],
        positions: &mut [[f64; 3]],
        mut normals: Option<&mut [[f64; 3]]>,
    ) {
        let [dx, dy, dz] = [0, 1, 2].map(|axis| usize::from(DIRECTION >> axis & 1));
        let margin = site.margin;
        // Rows of the margin are beyond every row of samples, also below 0.
        let (row, slab) = (j.wrapping_sub(margin), k.wrapping_sub(margin));
        let from = samples.row(row, 0).unwrap_or(&[]);
        let to = samples.row(row.wrapping_add(dy), dz).unwrap_or(&[]);
        let mut at = 0;
        for w in 0..self.own.len() {
            let mut crossed = self.crossed(DIRECTION, w);
            while crossed != 0 {
                let i = 64 * w + crossed.trailing_zeros() as usize;
                let starts_inside = self.own[w] >> (i % 64) & 1 == 1;
                crossed &= crossed - 1;
                let column = i.wrapping_sub(margin);
                let ends = (from.get(column), to.get(column.wrapping_add(dx)));
                let (position, gradient) = if let (Some(&a), Some(&b)) = ends {
                    let part = if site.tame { site.level.crossing_of_finite(a, b) } else { site.level.crossing(a, b) };
                    let x = if dx == 1 { column as f64 + part } else { column as f64 };
                    let y = if dy == 1 { row as f64 + part } else { row as f64 };
                    let z = if dz == 1 { slab as f64 + part } else { slab as f64 };
                    let position = site.place(x, y, z);
                    let mut gradient = DVec3::ZERO;
                    if normals.is_some() {
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
                positions[at] = position;
                if let Some(normals) = &mut normals {
                    let along = DVec3::new(dx as f64, dy as f64, dz as f64);
                    normals[at] = site.normal(gradient, if starts_inside { along } else { -along });
                }
                at += 1;
            }
        }
    }
}
