//! Distances beyond a band: the fast sweeping method.

use shapeloom_core::{Exec, Stop};

/// A value above every distance in cells.
pub(super) const FAR: f32 = 1e30;

/// Fills in distances, in cells, where magnitudes are [`FAR`]: the smallest solution of the upwind equations for |∇d| = 1
/// (Zhao 2005, A fast sweeping method for eikonal equations), swept once in each of the eight orders. All other values stay. What is
/// filled in is known to be no less than `least`. Signs stay with their samples.
///
/// First order: the error is some tenths of a cell near the band and grows with the distance, about as h log(1/h). Cost: eight times
/// some nanoseconds a sample, on one thread.
pub(super) fn sweep(values: &mut [f32], dimensions: [u32; 3], least: f32, exec: &Exec) -> Result<(), Stop> {
    let [columns, rows, slabs] = dimensions.map(|count| count as usize);
    let slab_len = columns * rows;
    let is_free: Vec<u64> = values
        .chunks(64)
        .map(|part| part.iter().enumerate().fold(0, |bits, (i, value)| bits | u64::from(value.abs() >= FAR) << i))
        .collect();
    // The smaller of both neighbours, along y and along z, for a row.
    let mut across = vec![[FAR; 2]; columns];
    for order in 0..8u32 {
        for step in 0..slabs {
            exec.check()?;
            exec.progress((order as f64 + step as f64 / slabs as f64) / 8.0);
            let k = if order & 4 == 0 { step } else { slabs - 1 - step };
            for step in 0..rows {
                let j = if order & 2 == 0 { step } else { rows - 1 - step };
                let start = k * slab_len + j * columns;
                if !any(&is_free, start, columns) {
                    continue;
                }
                for (i, near) in across.iter_mut().enumerate() {
                    let at = start + i;
                    let value = |exists: bool, at: usize| if exists { values[at].abs() } else { FAR };
                    let before = [value(j > 0, at.wrapping_sub(columns)), value(k > 0, at.wrapping_sub(slab_len))];
                    let after = [value(j + 1 < rows, at + columns), value(k + 1 < slabs, at + slab_len)];
                    *near = [before[0].min(after[0]), before[1].min(after[1])];
                }
                let row = &mut values[start..start + columns];
                for step in 0..columns {
                    let i = if order & 1 == 0 { step } else { columns - 1 - step };
                    let at = start + i;
                    if is_free[at / 64] >> (at % 64) & 1 == 0 {
                        continue;
                    }
                    let before = if i > 0 { row[i - 1].abs() } else { FAR };
                    let after = if i + 1 < columns { row[i + 1].abs() } else { FAR };
                    let found = solve([before.min(after), across[i][0], across[i][1]]).max(least);
                    if found < row[i].abs() {
                        row[i] = found.copysign(row[i]);
                    }
                }
            }
        }
    }
    Ok(())
}

/// Whether any of `count` bits from `start` on is set.
fn any(bits: &[u64], start: usize, count: usize) -> bool {
    let end = start + count;
    (start / 64..end.div_ceil(64)).any(|word| {
        let low = if word == start / 64 { u64::MAX << (start % 64) } else { u64::MAX };
        let high = if word == end / 64 { !(u64::MAX << (end % 64)) } else { u64::MAX };
        bits[word] & low & high != 0
    })
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
