//! Sweeps over the rows of a lattice, in waves of rows that do not touch.

use shapeloom_core::parallel::fill_chunks;
use shapeloom_core::{ConvertError, Exec};

/// The rows beside one in the other two directions, where there are any: those that came before it in the sweep, and
/// those that come after.
pub(crate) struct Beside<'a, T> {
    pub before: [Option<&'a T>; 2],
    pub after: [Option<&'a T>; 2],
}

/// The order in which a sweep visits the rows of a lattice.
#[derive(Clone, Copy)]
pub(crate) struct Sweep {
    /// How many rows a slab has, and how many slabs there are.
    pub counts: [usize; 2],
    /// Whether rows of a slab, and slabs, come last first.
    pub backward: [bool; 2],
}

impl Sweep {
    /// The four orders of the rows of a lattice.
    pub fn all(counts: [usize; 2]) -> [Self; 4] {
        [[false, false], [true, false], [false, true], [true, true]].map(|backward| Self { counts, backward })
    }

    /// The first slab of a wave, in the order of the sweep, and how many rows the wave has.
    fn wave(&self, wave: usize) -> (usize, usize) {
        let [rows, slabs] = self.counts;
        let first = (wave + 1).saturating_sub(rows);
        (first, (wave + 1).min(slabs).saturating_sub(first))
    }

    /// Visits each row, with its place in the lattice, so that it sees those beside it as if all were visited one after
    /// the other, slab by slab. `rows` are in the order of the lattice. Rows whose two coordinates have the same sum
    /// know nothing of each other: they are a wave, and are visited at the same time (Detrixhe, Gibou and Min 2013, with
    /// rows in place of samples), `chunk` rows in one go. The result is that of one thread.
    ///
    /// # Errors
    /// Those of `visit`, too little memory, or the reason to stop.
    pub fn run<T: Send + Sync>(
        &self,
        rows: impl ExactSizeIterator<Item = T>,
        chunk: usize,
        exec: &Exec,
        visit: impl Fn([usize; 2], &mut T, Beside<'_, T>) -> Result<(), ConvertError> + Sync,
    ) -> Result<(), ConvertError> {
        let [count, slabs] = self.counts;
        let waves = count + slabs - 1;
        let _memory = exec.reserve_elements(rows.len() as u64, 2 * size_of::<Option<T>>())?;
        let mut starts = Vec::with_capacity(waves + 1);
        let mut start = 0;
        for wave in 0..waves {
            starts.push(start);
            start += self.wave(wave).1;
        }
        let turned = |at: usize, axis: usize| {
            if self.backward[axis] { self.counts[axis] - 1 - at } else { at }
        };
        let mut placed: Vec<Option<T>> = std::iter::repeat_with(|| None).take(rows.len()).collect();
        for (index, row) in rows.enumerate() {
            let (j, k) = (turned(index % count, 0), turned(index / count, 1));
            placed[starts[j + k] + k - self.wave(j + k).0] = Some(row);
        }
        let mut rows: Vec<T> = placed.into_iter().flatten().collect();
        for wave in 0..waves {
            exec.check()?;
            exec.progress(wave as f64 / waves as f64);
            let (first, len) = self.wave(wave);
            let (done, left) = rows.split_at_mut(starts[wave]);
            let (now, next) = left.split_at_mut(len);
            let (before, after) = (wave.checked_sub(1), self.wave(wave + 1).0);
            let before = before.map(|before| (starts[before], self.wave(before).0));
            fill_chunks(exec, now, chunk, |offset, part| {
                for (n, row) in part.iter_mut().enumerate() {
                    let k = first + offset + n;
                    let j = wave - k;
                    let of_before = |exists: bool, k: usize| {
                        before.filter(|_| exists).map(|(start, first)| &done[start + k - first])
                    };
                    let of_after = |exists: bool, k: usize| exists.then(|| &next[k - after]);
                    let beside = Beside {
                        before: [of_before(j > 0, k), of_before(k > 0, k.saturating_sub(1))],
                        after: [of_after(j + 1 < count, k), of_after(k + 1 < slabs, k + 1)],
                    };
                    visit([turned(j, 0), turned(k, 1)], row, beside)?;
                }
                Ok::<_, ConvertError>(())
            })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each row becomes a number made of itself and of all beside it, in an order that matters: as in a plain loop.
    #[test]
    fn waves_see_what_a_plain_loop_sees() {
        for counts in [[1, 1], [1, 5], [6, 1], [4, 7], [9, 3]] {
            let [count, slabs] = counts;
            for sweep in Sweep::all(counts) {
                let mut plain: Vec<u64> = (1..=(count * slabs) as u64).collect();
                let order = |n: usize, backward: bool| move |at: usize| if backward { n - 1 - at } else { at };
                let mix = |row: u64, beside: [Option<u64>; 4]| {
                    beside.into_iter().fold(row, |mixed, other| mixed.wrapping_mul(31) ^ other.unwrap_or(7))
                };
                for k in (0..slabs).map(order(slabs, sweep.backward[1])) {
                    for j in (0..count).map(order(count, sweep.backward[0])) {
                        let get = |j: Option<usize>, k: Option<usize>| match (j, k) {
                            (Some(j), Some(k)) if j < count && k < slabs => Some(plain[k * count + j]),
                            _ => None,
                        };
                        let mut y = [get(j.checked_sub(1), Some(k)), get(Some(j + 1), Some(k))];
                        let mut z = [get(Some(j), k.checked_sub(1)), get(Some(j), Some(k + 1))];
                        if sweep.backward[0] {
                            y.reverse();
                        }
                        if sweep.backward[1] {
                            z.reverse();
                        }
                        plain[k * count + j] = mix(plain[k * count + j], [y[0], z[0], y[1], z[1]]);
                    }
                }
                let mut waves: Vec<u64> = (1..=(count * slabs) as u64).collect();
                let visit = |[j, k]: [usize; 2], row: &mut &mut u64, beside: Beside<'_, &mut u64>| {
                    assert_eq!(**row, (k * count + j + 1) as u64);
                    let [a, b] = beside.before.map(|row| row.map(|row| **row));
                    let [c, d] = beside.after.map(|row| row.map(|row| **row));
                    **row = mix(**row, [a, b, c, d]);
                    Ok(())
                };
                sweep.run(waves.iter_mut(), 2, &Exec::default(), visit).unwrap();
                assert_eq!(waves, plain, "{counts:?} {:?}", sweep.backward);
            }
        }
    }
}
