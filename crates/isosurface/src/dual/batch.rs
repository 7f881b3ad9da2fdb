//! The means of the crossings of many cells at once.

use multiversion::multiversion;
use shapeloom_core::glam::{DMat3, DVec3};

/// How many cells are done at once: their numbers stay in the first-level cache.
pub(super) const BATCH: usize = 128;

/// Cells with their samples, one array for each corner; smaller than the iso value is inside.
pub(super) struct Batch {
    pub(super) len: usize,
    pub(super) corners: [[f32; BATCH]; 8],
    /// Columns and rows of the cells.
    pub(super) cells: [[u32; BATCH]; 2],
    /// Each cell's place among the bits of its layer.
    pub(super) keys: [u64; BATCH],
    /// The means, in the cell from 0 to 1.
    pub(super) places: [[f32; BATCH]; 3],
    /// The gradients of the trilinear interpolants there.
    pub(super) gradients: [[f32; BATCH]; 3],
    /// Which corners are inside, a bit each.
    pub(super) insides: [u32; BATCH],
    /// The means in space.
    pub(super) positions: [[f64; BATCH]; 3],
    /// The directions of the gradients in space, where there is one.
    pub(super) normals: [[f64; BATCH]; 3],
    pub(super) sloped: [bool; BATCH],
}

impl Batch {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self {
            len: 0,
            corners: [[0.0; BATCH]; 8],
            cells: [[0; BATCH]; 2],
            keys: [0; BATCH],
            places: [[0.0; BATCH]; 3],
            gradients: [[0.0; BATCH]; 3],
            insides: [0; BATCH],
            positions: [[0.0; BATCH]; 3],
            normals: [[0.0; BATCH]; 3],
            sloped: [false; BATCH],
        })
    }
}

/// The mean of the crossings of each cell, and which corners are inside. A sample of +∞ is outside, and edges to it are crossed at
/// their other end.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
pub(super) fn means(corners: &[[f32; BATCH]; 8], iso: f32, places: &mut [[f32; BATCH]; 3], insides: &mut [u32; BATCH]) {
    let [x, y, z] = places;
    for n in 0..BATCH {
        let v = [
            corners[0][n],
            corners[1][n],
            corners[2][n],
            corners[3][n],
            corners[4][n],
            corners[5][n],
            corners[6][n],
            corners[7][n],
        ];
        let mut inside = 0;
        for (c, v) in v.iter().enumerate() {
            inside |= u32::from(*v < iso) << c;
        }
        // For each edge: whether it is crossed, and where if it is.
        let edge = |p: usize, q: usize| {
            let (a, b) = (v[p], v[q]);
            let part = (iso - a) / (b - a);
            // Not a number where the lower end is +∞.
            let part = if part >= 0.0 { part } else { 1.0 };
            if (a < iso) != (b < iso) { (1.0f32, part) } else { (0.0, 0.0) }
        };
        let along_x = [edge(0, 1), edge(2, 3), edge(4, 5), edge(6, 7)];
        let along_y = [edge(0, 2), edge(4, 6), edge(1, 3), edge(5, 7)];
        let along_z = [edge(0, 4), edge(1, 5), edge(2, 6), edge(3, 7)];
        let count = |edges: &[(f32, f32); 4]| (edges[0].0 + edges[1].0) + (edges[2].0 + edges[3].0);
        let parts = |edges: &[(f32, f32); 4]| (edges[0].1 + edges[1].1) + (edges[2].1 + edges[3].1);
        let all = count(&along_x) + count(&along_y) + count(&along_z);
        // Of the edges along the other two axes those at the far side add 1.
        x[n] = (parts(&along_x) + (along_y[2].0 + along_y[3].0) + (along_z[1].0 + along_z[3].0)) / all;
        y[n] = (parts(&along_y) + (along_z[2].0 + along_z[3].0) + (along_x[1].0 + along_x[3].0)) / all;
        z[n] = (parts(&along_z) + (along_x[2].0 + along_x[3].0) + (along_y[1].0 + along_y[3].0)) / all;
        insides[n] = inside;
    }
}

/// The gradient of each cell's trilinear interpolant, in cell units, at a place.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
pub(super) fn gradients(corners: &[[f32; BATCH]; 8], places: &[[f32; BATCH]; 3], gradients: &mut [[f32; BATCH]; 3]) {
    let [gx, gy, gz] = gradients;
    for n in 0..BATCH {
        let v = |c: usize| corners[c][n];
        let [x, y, z] = [places[0][n], places[1][n], places[2][n]];
        let mix = |a: f32, b: f32, part: f32| a + (b - a) * part;
        gx[n] = mix(mix(v(1) - v(0), v(3) - v(2), y), mix(v(5) - v(4), v(7) - v(6), y), z);
        gy[n] = mix(mix(v(2) - v(0), v(3) - v(1), x), mix(v(6) - v(4), v(7) - v(5), x), z);
        gz[n] = mix(mix(v(4) - v(0), v(5) - v(1), x), mix(v(6) - v(2), v(7) - v(3), x), y);
    }
}

/// Maps the means of cells whose first corner is at `from`, less columns and rows, by columns of a matrix and a translation.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
pub(super) fn place(batch: &mut Batch, from: DVec3, linear: &DMat3, translation: DVec3) {
    let Batch { cells: [columns, rows], places, positions: [px, py, pz], .. } = batch;
    let (ax, ay, az) = (linear.x_axis, linear.y_axis, linear.z_axis);
    for n in 0..BATCH {
        // Fewer than 2^31: they convert as signed numbers at once.
        let x = f64::from(columns[n] as i32) + from.x + f64::from(places[0][n]);
        let y = f64::from(rows[n] as i32) + from.y + f64::from(places[1][n]);
        let z = from.z + f64::from(places[2][n]);
        px[n] = ax.x * x + ay.x * y + az.x * z + translation.x;
        py[n] = ax.y * x + ay.y * y + az.y * z + translation.y;
        pz[n] = ax.z * x + ay.z * y + az.z * z + translation.z;
    }
}

/// Maps the gradients by a matrix, and makes them as long as 1.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
pub(super) fn directions(batch: &mut Batch, matrix: &DMat3) {
    let Batch { gradients, normals: [nx, ny, nz], sloped, .. } = batch;
    let (mx, my, mz) = (matrix.x_axis, matrix.y_axis, matrix.z_axis);
    for n in 0..BATCH {
        let [x, y, z] = [f64::from(gradients[0][n]), f64::from(gradients[1][n]), f64::from(gradients[2][n])];
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
