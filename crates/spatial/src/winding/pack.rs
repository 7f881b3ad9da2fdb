//! The order of the triangles in the tree.

use shapeloom_core::{Exec, Stop, parallel};

use super::near::WIDTH;

/// A place, as fractions of the shape's size in 32 bits, and whose it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub place: [u32; 3],
    pub element: u32,
}

impl Item {
    /// By place along an axis, then by element: no two are equal.
    fn key(&self, axis: usize) -> u64 {
        u64::from(self.place[axis]) << 32 | u64::from(self.element)
    }
}

/// Brings items into an order in which each aligned run of 8, 64, 512, ... is compact: halved again and again by the
/// place along the longest side, always at whole runs, so that only the last run of each size may be short.
pub(crate) fn pack(items: &mut [Item], exec: &Exec) -> Result<(), Stop> {
    let mut run = WIDTH;
    while run * WIDTH < items.len() {
        run *= WIDTH;
    }
    // Halves until there is work for many threads, then each to its end.
    let mut parts = vec![vec![(items, run)]];
    for _ in 0..6 {
        parallel::fill_chunks(exec, &mut parts, 1, |_, parts| {
            for part in parts {
                let halves = part.drain(..).flat_map(|(items, run)| halve(items, run).into_iter().flatten());
                *part = halves.collect();
            }
            Ok::<_, Stop>(())
        })?;
        parts = parts.into_iter().flatten().map(|part| vec![part]).collect();
    }
    parallel::fill_chunks(exec, &mut parts, 1, |_, parts| {
        for (items, run) in parts.iter_mut().flat_map(|part| part.drain(..)) {
            exec.check()?;
            finish(items, run);
        }
        Ok(())
    })
}

fn finish(items: &mut [Item], run: usize) {
    for (items, run) in halve(items, run).into_iter().flatten() {
        finish(items, run);
    }
}

type Halves<'a> = [Option<(&'a mut [Item], usize)>; 2];

/// Two halves of whole runs; of a single run those of its eighths; nothing where that is a run of the smallest size.
fn halve(items: &mut [Item], mut run: usize) -> Halves<'_> {
    while items.len() <= run {
        if run <= WIDTH {
            items.sort_unstable_by_key(|item| item.element);
            return [None, None];
        }
        run /= WIDTH;
    }
    let middle = items.len().div_ceil(run).div_ceil(2) * run;
    let (mut low, mut high) = ([u32::MAX; 3], [0; 3]);
    for item in &*items {
        for axis in 0..3 {
            low[axis] = item.place[axis].min(low[axis]);
            high[axis] = item.place[axis].max(high[axis]);
        }
    }
    let side = |axis: usize| high[axis] - low[axis];
    let axis = (1..3).fold(0, |longest, axis| if side(axis) > side(longest) { axis } else { longest });
    items.select_nth_unstable_by_key(middle, |item| item.key(axis));
    let (first, second) = items.split_at_mut(middle);
    [Some((first, run)), Some((second, run))]
}
