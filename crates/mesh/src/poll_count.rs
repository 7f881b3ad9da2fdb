//! How often work polls for cancellation.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use shapeloom_core::Exec;

/// How often the work polls.
pub(crate) fn polls(work: &dyn Fn(&Exec)) -> u64 {
    let count = Arc::new(AtomicU64::new(0));
    let counter = Arc::clone(&count);
    work(&Exec::default().with_watch(move || {
        counter.fetch_add(1, Ordering::Relaxed);
        None
    }));
    count.load(Ordering::Relaxed)
}
