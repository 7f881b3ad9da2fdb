//! Parallel helpers whose results do not depend on the number of threads.
//!
//! Work is cut into chunks of a fixed size, chosen by the caller and never by the number of threads; results are put
//! together in the order of the chunks. A float sum is therefore the same bits on one thread and on many. Every helper
//! polls [`Exec::check`] once a chunk.

use std::ops::Range;

#[cfg(feature = "rayon")]
use crate::Threads;
use crate::{Exec, Stop};

/// A chunk size that suits cheap work on each element (a few nanoseconds).
pub const CHUNK: usize = 4096;

/// How many chunks can be worked on at the same time: for choosing between ways whose results are the same bits, never for sizes of
/// chunks that results depend on.
pub fn workers(exec: &Exec) -> usize {
    #[cfg(feature = "rayon")]
    if exec.threads() == Threads::Pool {
        return rayon::current_num_threads();
    }
    let _ = exec;
    1
}

fn range(index: usize, chunk: usize, len: usize) -> Range<usize> {
    index * chunk..((index + 1) * chunk).min(len)
}

/// Calls `f` on fixed chunks of `0..len` and returns the results in order.
///
/// # Errors
/// The first error in the order of the chunks among those that ran, or the reason to stop.
pub fn map_chunks<T, E>(
    exec: &Exec,
    len: usize,
    chunk: usize,
    f: impl Fn(Range<usize>) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E>
where
    T: Send,
    E: Send + From<Stop>,
{
    let chunk = chunk.max(1);
    let chunks = len.div_ceil(chunk);
    let run = |index: usize| {
        exec.check()?;
        f(range(index, chunk, len))
    };
    #[cfg(feature = "rayon")]
    if exec.threads() == Threads::Pool && chunks > 1 {
        use rayon::prelude::*;
        return (0..chunks).into_par_iter().map(run).collect::<Vec<Result<T, E>>>().into_iter().collect();
    }
    (0..chunks).map(run).collect()
}

/// Fills `out` in fixed chunks: `f` gets the index of a chunk's first element and the chunk.
///
/// # Errors
/// The first error in the order of the chunks among those that ran, or the reason to stop; `out` is then partly filled.
pub fn fill_chunks<T, E>(
    exec: &Exec,
    out: &mut [T],
    chunk: usize,
    f: impl Fn(usize, &mut [T]) -> Result<(), E> + Sync,
) -> Result<(), E>
where
    T: Send,
    E: Send + From<Stop>,
{
    let chunk = chunk.max(1);
    let run = |(index, part): (usize, &mut [T])| {
        exec.check()?;
        f(index * chunk, part)
    };
    #[cfg(feature = "rayon")]
    if exec.threads() == Threads::Pool && out.len() > chunk {
        use rayon::prelude::*;
        let results: Vec<Result<(), E>> = out.par_chunks_mut(chunk).enumerate().map(run).collect();
        return results.into_iter().collect();
    }
    out.chunks_mut(chunk).enumerate().try_for_each(run)
}

/// The sum of `f(i)` over `0..len`: each fixed chunk is summed from left to right, then the chunks' sums.
///
/// # Errors
/// The reason to stop.
pub fn sum(exec: &Exec, len: usize, f: impl Fn(usize) -> f64 + Sync) -> Result<f64, Stop> {
    let sums = map_chunks(exec, len, CHUNK, |part| Ok::<f64, Stop>(part.map(&f).sum()))?;
    Ok(sums.into_iter().sum())
}

/// Turns counts into start offsets and returns the total: `[2, 0, 3]` becomes `[0, 2, 2]` and 5. None on overflow.
pub fn prefix_sum(counts: &mut [u32]) -> Option<u32> {
    let mut total = 0u32;
    for count in counts {
        let next = total.checked_add(*count)?;
        *count = total;
        total = next;
    }
    Some(total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CancelFlag;

    fn awkward(i: usize) -> f64 {
        ((i * 7919) % 1013) as f64 * 1e-3 + 1e10 / (i + 1) as f64
    }

    #[test]
    fn sums_are_the_same_bits_on_any_number_of_threads() {
        let alone = Exec::default().with_threads(crate::Threads::Sequential);
        let wanted = sum(&alone, 100_003, awkward).unwrap().to_bits();
        #[cfg(feature = "rayon")]
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| sum(&Exec::default(), 100_003, awkward).unwrap().to_bits());
            assert_eq!(found, wanted, "{threads}");
        }
        assert_eq!(sum(&alone, 100_003, awkward).unwrap().to_bits(), wanted);
    }

    #[test]
    fn chunks_cover_everything_once_and_in_order() {
        let parts = map_chunks(&Exec::default(), 10, 4, Ok::<_, Stop>).unwrap();
        assert_eq!(parts, [0..4, 4..8, 8..10]);
        let mut out = vec![0; 10];
        fill_chunks(&Exec::default(), &mut out, 3, |first, part| {
            part.iter_mut().enumerate().for_each(|(i, value)| *value = first + i);
            Ok::<_, Stop>(())
        })
        .unwrap();
        assert_eq!(out, (0..10).collect::<Vec<_>>());
        assert!(map_chunks(&Exec::default(), 0, 4, Ok::<_, Stop>).unwrap().is_empty());
    }

    #[test]
    fn cancelled_work_stops() {
        let flag = CancelFlag::default();
        flag.cancel();
        let exec = Exec::default().with_cancel(&flag);
        assert_eq!(sum(&exec, 5, awkward), Err(Stop::Cancelled));
    }

    #[test]
    fn prefix_sums_start_at_zero_and_notice_overflow() {
        let mut counts = [2, 0, 3];
        assert_eq!(prefix_sum(&mut counts), Some(5));
        assert_eq!(counts, [0, 2, 2]);
        assert_eq!(prefix_sum(&mut [u32::MAX, 1]), None);
    }
}
