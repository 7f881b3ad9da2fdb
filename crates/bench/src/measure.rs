//! Timing.

use std::time::Instant;

use cpu_time::ProcessTime;

/// Seconds of the fastest run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Times {
    pub(crate) wall: f64,
    /// Of all threads of the process.
    pub(crate) cpu: f64,
}

/// Runs `work` several times and returns its last result and the smallest times.
pub(crate) fn fastest<T>(runs: u32, mut work: impl FnMut() -> Result<T, String>) -> Result<(T, Times), String> {
    let mut best = Times { wall: f64::INFINITY, cpu: f64::INFINITY };
    let mut last = None;
    for _ in 0..runs.max(1) {
        // Dropping a result is not part of making the next one.
        drop(last.take());
        let cpu = ProcessTime::try_now().map_err(|error| format!("no CPU time: {error}"))?;
        let wall = Instant::now();
        let result = work()?;
        best.wall = best.wall.min(wall.elapsed().as_secs_f64());
        best.cpu = best.cpu.min(cpu.elapsed().as_secs_f64());
        last = Some(result);
    }
    last.map(|result| (result, best)).ok_or_else(|| "no run".to_owned())
}
