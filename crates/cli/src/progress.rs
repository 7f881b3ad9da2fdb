//! Progress on a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use shapeloom_core::Exec;

/// A bar on standard error, drawn only where that is a terminal.
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
}

/// The bar counts in thousandths.
const STEPS: u64 = 1000;

impl Progress {
    pub(crate) fn new(shown: bool) -> Self {
        let bar = shown.then(|| {
            let bar = ProgressBar::new(STEPS);
            if let Ok(style) = ProgressStyle::with_template("{msg:12} {bar:40} {percent:>3}% {elapsed}") {
                bar.set_style(style);
            }
            // Short commands are done before anyone needs a bar.
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Self { bar }
    }

    /// Makes a conversion report to the bar.
    pub(crate) fn watch(&self, exec: Exec) -> Exec {
        match self.bar.clone() {
            Some(bar) => exec.with_progress(move |fraction| bar.set_position((fraction * STEPS as f64) as u64)),
            None => exec,
        }
    }

    pub(crate) fn stage(&self, name: &'static str) {
        if let Some(bar) = &self.bar {
            bar.set_position(0);
            bar.set_message(name);
        }
    }

    /// Takes the bar away before words are printed.
    pub(crate) fn clear(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}
