//! Many queries, taken along a curve so that neighbours find what they need in the caches.

use glam::DVec3;
use shapeloom_core::{Exec, parallel};

use super::tree::WindingTree;
use crate::BvhError;
use crate::scaled_input::Units;

/// How many queries are ordered together: more save little, and the order takes 16 bytes a query.
const SECTION: usize = 1 << 22;

impl WindingTree {
    /// [`WindingTree::winding_number`] of many points, in parallel, with the same bits. Queries are answered in an
    /// order of their own, along a Morton curve; `out` has the given one. Between asking whether to stop up to four
    /// million queries are sorted, which takes 130 ms; all other steps are short.
    ///
    /// # Errors
    /// Too little memory in the budget (16 bytes a query, at most 64 MiB), or the reason to stop.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn winding_numbers(&self, queries: &[DVec3], out: &mut [f64], exec: &Exec) -> Result<(), BvhError> {
        along_curve(&self.units, queries, out, exec, |query, _| self.winding_number(query))
    }
}

/// Fills `out` with what `answer` says of each query, in parallel and in the order of a Morton curve. It is also told
/// the queries before and their answers, the latest last: most often near ones, which must change no bit of the answer.
pub(crate) fn along_curve<T: Copy + Default + Send>(
    units: &Units,
    queries: &[DVec3],
    out: &mut [T],
    exec: &Exec,
    answer: impl Fn(DVec3, &[(DVec3, T)]) -> T + Sync,
) -> Result<(), BvhError> {
    assert_eq!(queries.len(), out.len(), "slices of one length");
    let section = SECTION.min(queries.len());
    let _memory = exec.reserve_elements(section as u64, size_of::<u64>() + size_of::<T>())?;
    let (mut order, mut answers) = (vec![0u64; section], vec![T::default(); section]);
    let sections = queries.len().div_ceil(SECTION.max(1));
    for (index, (queries, out)) in queries.chunks(SECTION).zip(out.chunks_mut(SECTION)).enumerate() {
        let (order, answers) = (&mut order[..queries.len()], &mut answers[..queries.len()]);
        parallel::fill_chunks(exec, order, parallel::CHUNK, |first, part| {
            for (place, key) in (first..).zip(part) {
                *key = u64::from(code(queries[place] * units.per_unit - units.center)) << 32 | place as u64;
            }
            Ok::<_, BvhError>(())
        })?;
        order.sort_unstable();
        let order = &*order;
        parallel::fill_chunks(exec, answers, 256, |first, part| {
            let mut before = Vec::with_capacity(part.len());
            for (&key, found) in order[first..].iter().zip(part) {
                let query = queries[key as u32 as usize];
                *found = answer(query, &before);
                before.push((query, *found));
            }
            Ok::<_, BvhError>(())
        })?;
        for (&key, &found) in order.iter().zip(&*answers) {
            out[key as u32 as usize] = found;
        }
        exec.progress((index + 1) as f64 / sections as f64);
    }
    Ok(())
}

/// The place on a Morton curve through `[-2, 2)³`, ten bits an axis; what lies outside counts as on the border.
fn code(local: DVec3) -> u32 {
    let spread = |x: f64| {
        let mut bits = (((x + 2.0) * 256.0) as u32).min(1023);
        bits = (bits | bits << 16) & 0x0300_00ff;
        bits = (bits | bits << 8) & 0x0300_f00f;
        bits = (bits | bits << 4) & 0x030c_30c3;
        (bits | bits << 2) & 0x0924_9249
    };
    spread(local.x) | spread(local.y) << 1 | spread(local.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_interleave_the_bits() {
        assert_eq!(code(DVec3::splat(-2.0)), 0);
        assert_eq!(code(DVec3::splat(9.0)), (1 << 30) - 1);
        assert_eq!(code(DVec3::new(0.0, -2.0, -2.0)), 1 << 27);
        assert_eq!(code(DVec3::new(-2.0, 0.0, -2.0)), 1 << 28);
        assert_eq!(code(DVec3::new(-2.0, -2.0, -2.0 + 1.0 / 256.0)), 1 << 2);
        assert_eq!(code(DVec3::NAN), 0);
    }

    #[test]
    fn answers_come_back_in_order() {
        let queries: Vec<DVec3> = (0..1000).map(|i| DVec3::splat(f64::from(i * 7919 % 1000) / 500.0 - 1.0)).collect();
        let units = Units { unit: 1.0, per_unit: 1.0, center: DVec3::ZERO };
        let mut out = vec![0.0; 1000];
        along_curve(&units, &queries, &mut out, &Exec::default(), |query, _| query.x).unwrap();
        assert!(queries.iter().zip(&out).all(|(query, &x)| query.x == x));
        let small = Exec::default().with_memory(1000);
        assert!(along_curve(&units, &queries, &mut out, &small, |query, _| query.x).is_err());
    }
}
