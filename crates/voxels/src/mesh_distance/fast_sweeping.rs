//! Distances beyond a band: the fast sweeping method.

use shapeloom_core::{ConvertError, Exec};

use crate::waves::Sweep;

/// A value above every distance in cells.
pub(super) const FAR: f32 = 1e30;

/// Samples of the rows that are visited in one go.
const CHUNK: usize = 1 << 12;

/// No new value is nearer than this to the smallest neighbour: three equal ones give 1/√3.
const LEAST_STEP: f32 = 0.577;

/// Fills in distances, in cells, where magnitudes are [`FAR`]: the smallest solution of the upwind equations for |∇d| = 1
/// (Zhao 2005, A fast sweeping method for eikonal equations), swept once in each of the eight orders. Magnitudes up to `band` stay, and
/// what is filled in is known to be no less. Signs stay with their samples.
///
/// First order: the error is some tenths of a cell near the band and grows with the distance, about as h log(1/h). Cost: eight times
/// some nanoseconds a sample.
pub(super) fn sweep(values: &mut [f32], dimensions: [u32; 3], band: f32, exec: &Exec) -> Result<(), ConvertError> {
    let [columns, rows, slabs] = dimensions.map(|count| count as usize);
    for order in 0..8u32 {
        let exec = exec.part(f64::from(order) / 8.0, f64::from(order + 1) / 8.0);
        let sweep = Sweep { counts: [rows, slabs], backward: [order & 2 != 0, order & 4 != 0] };
        sweep.run(values.chunks_mut(columns), (CHUNK / columns).max(1), &exec, |_, row, beside| {
            // The smaller of both neighbours along y, and along z.
            let [along_y, along_z] = [0, 1].map(|axis| {
                let mut least = vec![FAR; columns];
                least_of(&mut least, [beside.before[axis], beside.after[axis]]);
                least
            });
            if order & 1 == 0 {
                sweep_row(row, &along_y, &along_z, band, 0..columns);
            } else {
                sweep_row(row, &along_y, &along_z, band, (0..columns).rev());
            }
            Ok(())
        })?;
    }
    Ok(())
}

/// The smaller magnitude of two rows beside one, at each place.
fn least_of(least: &mut [f32], beside: [Option<&&mut [f32]>; 2]) {
    least.fill(FAR);
    for row in beside.into_iter().flatten() {
        for (least, value) in least.iter_mut().zip(row.iter()) {
            let value = value.abs();
            *least = if value < *least { value } else { *least };
        }
    }
}

fn sweep_row(row: &mut [f32], along_y: &[f32], along_z: &[f32], band: f32, order: impl Iterator<Item = usize>) {
    let last = row.len() - 1;
    for i in order {
        let here = row[i].abs();
        let (before, after) =
            (if i > 0 { row[i - 1].abs() } else { FAR }, if i < last { row[i + 1].abs() } else { FAR });
        let along_x = before.min(after);
        if here <= band || along_x.min(along_y[i]).min(along_z[i]) + LEAST_STEP >= here {
            continue;
        }
        let found = solve([along_x, along_y[i], along_z[i]]).max(band);
        if found < here {
            row[i] = found.copysign(row[i]);
        }
    }
}

/// The solution of Σ max(0, d − aᵢ)² = 1: over the smallest neighbour alone, over two, or over all three.
fn solve([a, b, c]: [f32; 3]) -> f32 {
    let (a, b) = (a.min(b), a.max(b));
    let (b, c) = (b.min(c), b.max(c));
    let (a, b) = (a.min(b), a.max(b));
    let one = a + 1.0;
    if one <= b {
        return one;
    }
    let gap = b - a;
    let two = 0.5 * (a + b + (2.0 - gap * gap).max(0.0).sqrt());
    if two <= c {
        return two;
    }
    // Relative to the smallest, so that large numbers do not cancel.
    let (p, q) = (b - a, c - a);
    let sum = p + q;
    a + (sum + (sum * sum - 3.0 * (p * p + q * q - 1.0)).max(0.0).sqrt()) / 3.0
}
