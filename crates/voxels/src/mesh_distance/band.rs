//! Squared distances in a narrow band, a block of slabs at a time.

use multiversion::multiversion;
use shapeloom_core::glam::DVec3;

use super::in_cells::InCells;
use super::near_triangle::{Frame, LANES};

/// Samples of a block of slabs, with room to look at eight at once.
pub(super) struct Block {
    /// Squared distances in cells, rounded; at least the limit where nothing is near.
    pub squared: Vec<f32>,
    /// From one row to the next.
    pub stride: usize,
    pub columns: u32,
    pub rows: u32,
    pub first_slab: u32,
    pub slabs: u32,
}

impl Block {
    /// How many samples a block has room for.
    pub fn room([columns, rows]: [u32; 2], slabs: u32) -> u64 {
        Self::stride(columns) as u64 * u64::from(rows) * u64::from(slabs)
    }

    fn stride(columns: u32) -> usize {
        (columns as usize).max(LANES)
    }

    /// A block where nothing is near.
    pub fn new([columns, rows]: [u32; 2], first_slab: u32, slabs: u32, limit: f32) -> Self {
        let stride = Self::stride(columns);
        let squared = vec![limit; stride * rows as usize * slabs as usize];
        Self { squared, stride, columns, rows, first_slab, slabs }
    }

    /// The row of samples `(_, j, k)`.
    pub fn row(&self, j: u32, k: u32) -> &[f32] {
        let start = ((k - self.first_slab) as usize * self.rows as usize + j as usize) * self.stride;
        &self.squared[start..start + self.columns as usize]
    }
}

/// Lowers the squared distances of a block to those of some triangles, within `reach` cells of each.
///
/// For each triangle rows of samples near it are looked at in single precision, eight samples at a time; those that may be nearer than
/// before are measured in double precision. The result is the minimum over all triangles, rounded once: no order matters.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn lower(block: &mut Block, mesh: &InCells<'_>, triangles: &[u32], reach: f64) {
    for &triangle in triangles {
        lower_by(block, &mesh.corners(triangle), reach);
    }
}

#[inline(always)]
fn lower_by(block: &mut Block, corners: &[DVec3; 3], reach: f64) {
    let [a, b, c] = *corners;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let center = (low + high) * 0.5;
    let (first_slab, last_slab) = (f64::from(block.first_slab), f64::from(block.first_slab + block.slabs - 1));
    let top = DVec3::new(f64::from(block.columns - 1), f64::from(block.rows - 1), last_slab);
    let start = (low - reach).ceil().max(DVec3::new(0.0, 0.0, first_slab));
    let end = (high + reach).floor().min(top);
    if !(start.cmple(end).all()) {
        return;
    }
    let frame = Frame::new(corners, reach);
    let rough = frame.rough(start, reach);
    let radius = [a, b, c].map(|p| p.distance_squared(center)).into_iter().fold(0.0, f64::max).sqrt() + reach;
    let ball = Ball { center: center - start, squared: radius * radius * (1.0 + 1e-9) };
    let reach_box = frame.reach_box(start, reach);
    let (rows, slabs) = ((end.y - start.y) as u32, (end.z - start.z) as u32);
    let (last, most) = (end.x - start.x, block.stride as u32 - LANES as u32);
    let (first_column, first_row) = (start.x as u32, start.y as u32);
    let first_slab = start.z as u32 - block.first_slab;
    for k in 0..=slabs {
        for j in 0..=rows {
            let (y, z) = (f64::from(j), f64::from(k));
            let Some((from, to)) = ball.cut(y, z) else { continue };
            let (from, to) = reach_box.cut(y, z, (from.max(0.0), to.min(last)));
            let (from, to) = (from.ceil(), to.floor());
            if from > to {
                continue;
            }
            let row = ((first_slab + k) as usize * block.rows as usize + (first_row + j) as usize) * block.stride;
            let mut x = (from as u32 + first_column).min(most);
            let stop = to as u32 + first_column;
            while x <= stop {
                // A window at the end of a row begins earlier.
                let window = x.min(most);
                let at = row + window as usize;
                let Some(known) =
                    block.squared.get_mut(at..at + LANES).and_then(|part| part.as_chunks_mut().0.first_mut())
                else {
                    return;
                };
                let local = f64::from(window) - f64::from(first_column);
                let mut bits = rough.may_be_nearer([local as f32, j as f32, k as f32], known);
                while bits != 0 {
                    let lane = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let place = start + DVec3::new(local + lane as f64, y, z);
                    let squared = frame.distance_squared(place) as f32;
                    if squared < known[lane] {
                        known[lane] = squared;
                    }
                }
                x = window + LANES as u32;
            }
        }
    }
}

/// A ball around a triangle and all that it reaches.
struct Ball {
    center: DVec3,
    squared: f64,
}

impl Ball {
    /// The part of a row in the ball.
    #[inline(always)]
    fn cut(&self, y: f64, z: f64) -> Option<(f64, f64)> {
        let (dy, dz) = (y - self.center.y, z - self.center.z);
        let left = self.squared - (dy * dy + dz * dz);
        if left < 0.0 {
            return None;
        }
        let half = left.sqrt();
        Some((self.center.x - half, self.center.x + half))
    }
}
