//! How a conversion runs: progress, cancellation, memory and threads.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::{Category, Diagnostic};

/// How many threads the parallel helpers use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Threads {
    /// The calling thread alone.
    Sequential,
    /// The current rayon pool. Libraries never build one.
    #[default]
    Pool,
}

/// Why a conversion stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The caller cancelled.
    Cancelled,
    /// A time limit set by the caller was reached.
    TimeLimit,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cancelled => "stopped because it was cancelled",
            Self::TimeLimit => "stopped because the time limit was reached",
        })
    }
}

impl std::error::Error for Stop {}

impl Diagnostic for Stop {
    fn code(&self) -> &'static str {
        match self {
            Self::Cancelled => "E-cancelled",
            Self::TimeLimit => "E-time-limit",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Cancelled => Category::Cancelled,
            Self::TimeLimit => Category::OverLimit,
        }
    }

    fn advice(&self) -> Option<String> {
        (*self == Self::TimeLimit).then(|| "allow more time, or ask for a coarser result".into())
    }
}

/// A switch that stops conversions, shared between threads.
#[derive(Clone, Debug, Default)]
pub struct CancelFlag(Arc<AtomicBool>);

impl CancelFlag {
    /// Asks every conversion that watches this flag to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether someone cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

type Watch = Arc<dyn Fn() -> Option<Stop> + Send + Sync>;
type Listener = Arc<dyn Fn(f64) + Send + Sync>;

#[derive(Debug)]
struct Budget {
    limit: u64,
    taken: AtomicU64,
}

/// How a conversion runs. Owned, cheap to clone, without lifetimes; clones share the memory budget.
#[derive(Clone)]
pub struct Exec {
    progress: Option<Listener>,
    span: (f64, f64),
    watches: Vec<Watch>,
    budget: Arc<Budget>,
    threads: Threads,
}

impl Exec {
    /// The memory budget of the default: 4 GiB.
    pub const DEFAULT_MEMORY: u64 = 4 << 30;

    /// Reports progress to `listener`: fractions from 0 to 1, from any thread, not always rising.
    #[must_use]
    pub fn with_progress(mut self, listener: impl Fn(f64) + Send + Sync + 'static) -> Self {
        self.progress = Some(Arc::new(listener));
        self.span = (0.0, 1.0);
        self
    }

    /// Stops when `flag` is cancelled.
    #[must_use]
    pub fn with_cancel(self, flag: &CancelFlag) -> Self {
        let flag = flag.clone();
        self.with_watch(move || flag.is_cancelled().then_some(Stop::Cancelled))
    }

    /// Stops when `watch` says so. It is called at every poll, often, from any thread: libraries have no clock, so this
    /// is where a caller's time limit goes.
    #[must_use]
    pub fn with_watch(mut self, watch: impl Fn() -> Option<Stop> + Send + Sync + 'static) -> Self {
        self.watches.push(Arc::new(watch));
        self
    }

    /// Sets a new memory budget in bytes, with nothing taken.
    #[must_use]
    pub fn with_memory(mut self, bytes: u64) -> Self {
        self.budget = Arc::new(Budget { limit: bytes, taken: AtomicU64::new(0) });
        self
    }

    /// Sets the number of threads.
    #[must_use]
    pub fn with_threads(mut self, threads: Threads) -> Self {
        self.threads = threads;
        self
    }

    /// How many threads the parallel helpers use.
    pub fn threads(&self) -> Threads {
        self.threads
    }

    /// The memory budget in bytes.
    pub fn memory_limit(&self) -> u64 {
        self.budget.limit
    }

    /// Bytes reserved at the moment.
    pub fn memory_taken(&self) -> u64 {
        self.budget.taken.load(Ordering::Relaxed)
    }

    /// An `Exec` for a part of the work: its progress from 0 to 1 is this one's from `from` to `to`.
    #[must_use]
    pub fn part(&self, from: f64, to: f64) -> Self {
        let (start, end) = self.span;
        let at = |fraction: f64| start + (end - start) * fraction;
        Self { span: (at(from), at(to)), ..self.clone() }
    }

    /// Says how much of this part is done, from 0 to 1.
    pub fn progress(&self, fraction: f64) {
        if let Some(listener) = &self.progress {
            let (start, end) = self.span;
            listener(start + (end - start) * fraction.clamp(0.0, 1.0));
        }
    }

    /// Polls for cancellation. Algorithms call it at least every few milliseconds.
    ///
    /// # Errors
    /// The reason to stop, if there is one.
    pub fn check(&self) -> Result<(), Stop> {
        match self.watches.iter().find_map(|watch| watch()) {
            Some(stop) => Err(stop),
            None => Ok(()),
        }
    }

    /// Takes `bytes` from the memory budget, before they are allocated. They return when the reservation is dropped.
    ///
    /// # Errors
    /// The budget does not have them.
    pub fn reserve(&self, bytes: u64) -> Result<Reservation, OverBudget> {
        let refuse = |taken: u64| OverBudget { wanted: bytes, taken, limit: self.budget.limit };
        let grown = |taken: u64| taken.checked_add(bytes).filter(|&sum| sum <= self.budget.limit);
        match self.budget.taken.fetch_update(Ordering::Relaxed, Ordering::Relaxed, grown) {
            Ok(_) => Ok(Reservation { budget: Arc::clone(&self.budget), bytes }),
            Err(taken) => Err(refuse(taken)),
        }
    }

    /// [`Exec::reserve`] for `count` elements of `size` bytes, where the product may overflow.
    ///
    /// # Errors
    /// The budget does not have them.
    pub fn reserve_elements(&self, count: u64, size: usize) -> Result<Reservation, OverBudget> {
        self.reserve(count.saturating_mul(size as u64))
    }
}

impl Default for Exec {
    fn default() -> Self {
        Self { progress: None, span: (0.0, 1.0), watches: Vec::new(), budget: default_budget(), threads: Threads::Pool }
    }
}

fn default_budget() -> Arc<Budget> {
    Arc::new(Budget { limit: Exec::DEFAULT_MEMORY, taken: AtomicU64::new(0) })
}

impl fmt::Debug for Exec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Exec")
            .field("span", &self.span)
            .field("watches", &self.watches.len())
            .field("memory_limit", &self.memory_limit())
            .field("memory_taken", &self.memory_taken())
            .field("threads", &self.threads)
            .finish_non_exhaustive()
    }
}

/// A part of the memory budget, returned when dropped.
#[derive(Debug)]
pub struct Reservation {
    budget: Arc<Budget>,
    bytes: u64,
}

impl Reservation {
    /// The number of bytes held.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        self.budget.taken.fetch_sub(self.bytes, Ordering::Relaxed);
    }
}

/// A memory budget that does not have what an algorithm needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OverBudget {
    /// The bytes asked for.
    pub wanted: u64,
    /// The bytes already taken.
    pub taken: u64,
    /// The whole budget.
    pub limit: u64,
}

impl fmt::Display for OverBudget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "memory budget: found a need of {} bytes beside {} in use, expected at most {} in all",
            self.wanted, self.taken, self.limit
        )
    }
}

impl std::error::Error for OverBudget {}

impl Diagnostic for OverBudget {
    fn code(&self) -> &'static str {
        "E-memory-budget"
    }

    fn category(&self) -> Category {
        Category::OverLimit
    }

    fn advice(&self) -> Option<String> {
        Some("ask for a coarser result, or raise the memory limit".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn reservations_return_when_dropped() {
        let exec = Exec::default().with_memory(100);
        let first = exec.reserve(60).unwrap();
        assert_eq!(exec.clone().reserve(60).unwrap_err(), OverBudget { wanted: 60, taken: 60, limit: 100 });
        drop(first);
        assert!(exec.reserve(100).is_ok());
        assert_eq!(exec.memory_taken(), 0);
        assert!(exec.reserve_elements(u64::MAX, 8).is_err());
    }

    #[test]
    fn progress_of_parts_falls_into_their_span() {
        let seen = Arc::new(Mutex::new(Vec::new()));
        let log = Arc::clone(&seen);
        let exec = Exec::default().with_progress(move |fraction| log.lock().unwrap().push(fraction));
        exec.part(0.5, 1.0).part(0.0, 0.5).progress(1.0);
        exec.progress(7.0);
        assert_eq!(*seen.lock().unwrap(), [0.75, 1.0]);
    }

    #[test]
    fn flags_and_watches_stop() {
        let flag = CancelFlag::default();
        let exec = Exec::default().with_cancel(&flag);
        assert_eq!(exec.check(), Ok(()));
        flag.cancel();
        assert_eq!(exec.part(0.0, 0.1).check(), Err(Stop::Cancelled));
        let late = Exec::default().with_watch(|| Some(Stop::TimeLimit));
        assert_eq!(late.check(), Err(Stop::TimeLimit));
    }
}
