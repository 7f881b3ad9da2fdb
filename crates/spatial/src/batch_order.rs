//! The order in which a batch of queries is answered.
//!
//! Queries that lie scattered each wait for memory; where neighbours in time are neighbours in space, they use what is
//! near already. Answers do not depend on the order.

use glam::DVec3;
use shapeloom_core::parallel::fill_chunks;
use shapeloom_core::{Exec, Stop};

use crate::scaled_input::Units;

/// How many queries are ordered together. More bring neighbours closer to each other; this many fit about as many
/// triangles as the caches do not.
const BATCH: usize = 1 << 20;

/// How many queries a thread answers between two looks at whether to stop: some milliseconds.
const PART: usize = 512;

/// Answers queries in parallel, in the order of their keys if `sorted`; each answer comes to its query's place.
pub(crate) fn answer_all<Q: Copy + Sync, A: Copy + Default + Send + Sync>(
    queries: &[Q],
    out: &mut [A],
    sorted: bool,
    exec: &Exec,
    keys: impl Fn(&[Q], &mut [u64]) + Sync,
    answer: impl Fn(&[Q], &mut [A]) + Sync,
) -> Result<(), Stop> {
    assert_eq!(queries.len(), out.len(), "slices of one length");
    for (queries, out) in queries.chunks(BATCH).zip(out.chunks_mut(BATCH)) {
        // Keys twice and the answers; without room for them the order stays as it is.
        let memory = exec.reserve_elements(queries.len() as u64, 2 * size_of::<u64>() + size_of::<A>());
        if !sorted || queries.len() < 64 || memory.is_err() {
            fill_chunks(exec, out, PART, |first, out| {
                answer(&queries[first..first + out.len()], out);
                Ok::<(), Stop>(())
            })?;
            continue;
        }
        let mut places = vec![0; queries.len()];
        fill_chunks(exec, &mut places, 8 * PART, |first, places| {
            keys(&queries[first..first + places.len()], places);
            for (place, key) in (first..).zip(places) {
                *key = *key << 32 | place as u64;
            }
            Ok::<(), Stop>(())
        })?;
        sort(&mut places);
        let mut answers = vec![A::default(); queries.len()];
        fill_chunks(exec, &mut answers, PART, |first, answers| {
            // Gathered and scattered in loops of their own, so that many loads and stores are under way at once.
            let places = &places[first..first + answers.len()];
            let gathered: Vec<Q> = places.iter().map(|&place| queries[place as u32 as usize]).collect();
            answer(&gathered, answers);
            Ok::<(), Stop>(())
        })?;
        for (&place, &answer) in places.iter().zip(&answers) {
            out[place as u32 as usize] = answer;
        }
    }
    Ok(())
}

/// Whether most queries are near the one before, as in a picture: sorting then costs more than it gains.
pub(crate) fn together<Q>(queries: &[Q], near: impl Fn(&Q, &Q) -> bool) -> bool {
    let sample = queries.chunks_exact(16);
    let pairs = sample.len();
    let together = sample.filter(|some| near(&some[0], &some[1])).count();
    4 * together > 3 * pairs
}

/// The place of a point along a curve through the cube around the shape (Morton 1966), of 30 bits.
pub(crate) fn along_curve(point: DVec3, units: &Units) -> u64 {
    let local = (point * units.per_unit - units.center) * 0.25;
    // As a number, NaN is the first cell and what is outside is at the border.
    let cell = |coordinate: f64| spread(((coordinate + 0.5) * 1024.0).clamp(0.0, 1023.0) as u32);
    u64::from(cell(local.x) | cell(local.y) << 1 | cell(local.z) << 2)
}

/// Ten bits with two zeros between neighbours.
fn spread(bits: u32) -> u32 {
    let bits = (bits | bits << 16) & 0x0300_00ff;
    let bits = (bits | bits << 8) & 0x0300_f00f;
    let bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}

/// Sorts by bits 32 to 61, ten at a time from the lowest; equal ones keep their order.
fn sort(keyed: &mut Vec<u64>) {
    let mut other = vec![0; keyed.len()];
    for digit in 0..3 {
        let bucket = |entry: u64| (entry >> (32 + 10 * digit) & 0x3ff) as usize;
        let mut starts = [0u32; 1024];
        for &entry in keyed.iter() {
            starts[bucket(entry)] += 1;
        }
        let mut total = 0;
        for start in &mut starts {
            total += std::mem::replace(start, total);
        }
        for &entry in keyed.iter() {
            let start = &mut starts[bucket(entry)];
            other[*start as usize] = entry;
            *start += 1;
        }
        std::mem::swap(keyed, &mut other);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Draws;

    #[test]
    fn every_query_is_answered_once_and_in_its_place() {
        let mut draws = Draws::new(31);
        for len in [0, 1, 63, 64, 5000] {
            let queries: Vec<u64> = (0..len).map(|_| draws.next() % (1 << 30)).collect();
            for sorted in [false, true] {
                let mut out = vec![None; queries.len()];
                let keys = |queries: &[u64], keys: &mut [u64]| keys.copy_from_slice(queries);
                let answer = |queries: &[u64], out: &mut [Option<u64>]| {
                    assert!(!sorted || len < 64 || queries.is_sorted());
                    queries.iter().zip(out).for_each(|(&query, out)| *out = Some(query * 3));
                };
                answer_all(&queries, &mut out, sorted, &Exec::default(), keys, answer).unwrap();
                assert!(queries.iter().zip(&out).all(|(&query, &out)| out == Some(query * 3)));
            }
        }
    }

    #[test]
    fn the_curve_keeps_neighbours_together_and_takes_any_number() {
        let units = Units { unit: 1.0, per_unit: 1.0, center: DVec3::ZERO };
        let key = |x: f64, y: f64, z: f64| along_curve(DVec3::new(x, y, z), &units);
        assert_eq!(key(-2.0, -2.0, -2.0), 0);
        assert_eq!(key(-2.0 + 1.0 / 256.0, -2.0, -2.0), 1);
        assert_eq!(key(0.0, -2.0, -2.0), 1 << 27);
        assert_eq!(key(9.0, 1e300, f64::INFINITY), (1 << 30) - 1);
        assert_eq!(key(f64::NAN, f64::NEG_INFINITY, -9.0), 0);
    }
}
