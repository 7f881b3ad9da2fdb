//! What every command works with.

use std::fmt::Display;
use std::io::Write;
use std::time::{Duration, Instant};

use serde_json::Value;
use shapeloom_core::{CancelFlag, Exec, Findings, Limits, Severity, Stop, Threads};

use crate::Streams;
use crate::arguments::Globals;
use crate::failure::Failure;
use crate::progress::Progress;

/// The streams, limits and manners of one command.
pub(crate) struct Session<'a> {
    pub(crate) streams: &'a mut Streams,
    pub(crate) globals: &'a Globals,
    /// Whether there is more than one input, so that messages must say which they are about.
    pub(crate) several_inputs: bool,
    exec: Exec,
    pool: Option<rayon::ThreadPool>,
    progress: Progress,
}

impl<'a> Session<'a> {
    pub(crate) fn new(globals: &'a Globals, streams: &'a mut Streams, flag: &CancelFlag) -> Result<Self, Failure> {
        let mut exec = Exec::default().with_memory(globals.max_memory).with_cancel(flag);
        if let Some(seconds) = globals.max_time {
            // Longer than a process can live is no limit.
            let limit = Duration::try_from_secs_f64(seconds).ok().and_then(|time| Instant::now().checked_add(time));
            if let Some(end) = limit {
                exec = exec.with_watch(move || (Instant::now() >= end).then_some(Stop::TimeLimit));
            }
        }
        let progress = Progress::new(streams.err_is_terminal && !globals.quiet);
        exec = progress.watch(exec);
        let mut pool = None;
        match globals.threads {
            Some(1) => exec = exec.with_threads(Threads::Sequential),
            Some(count) => {
                let built = rayon::ThreadPoolBuilder::new().num_threads(usize::from(count)).build();
                pool = Some(built.map_err(|error| {
                    Failure::usage("E-usage-threads", format!("{count} threads cannot be started: {error}"))
                })?);
            }
            None => {}
        }
        Ok(Self { streams, globals, several_inputs: false, exec, pool, progress })
    }

    /// How conversions run.
    pub(crate) fn exec(&self) -> Exec {
        self.exec.clone()
    }

    /// What readers accept: inputs no larger than the memory allowed.
    pub(crate) fn limits(&self) -> Limits {
        Limits { max_bytes: self.globals.max_memory, ..Limits::default() }
    }

    /// Runs `f` on the threads that were asked for.
    pub(crate) fn in_pool(&mut self, f: impl FnOnce(&mut Self) -> Result<(), Failure> + Send) -> Result<(), Failure> {
        match self.pool.take() {
            Some(pool) => pool.install(|| f(self)),
            None => f(self),
        }
    }

    /// Shows what is being done on the bar of progress.
    pub(crate) fn stage(&self, name: &'static str) {
        self.progress.stage(name);
    }

    /// Says something on standard error, unless told to be quiet.
    pub(crate) fn say(&mut self, words: impl Display) {
        if !self.globals.quiet {
            self.progress.clear();
            let _ = writeln!(self.streams.err, "{words}");
        }
    }

    /// Says findings: warnings always, notes where more was asked for.
    pub(crate) fn say_findings(&mut self, findings: &Findings) {
        let verbose = self.globals.verbose;
        for finding in findings.iter().filter(|finding| verbose || finding.severity == Severity::Warning) {
            self.say(finding);
        }
    }

    /// Says something about an input, named where there is more than one.
    pub(crate) fn say_about(&mut self, input: &str, words: impl Display) {
        if self.several_inputs { self.say(format_args!("{input}: {words}")) } else { self.say(words) }
    }

    /// Says findings about an input, named where there is more than one.
    pub(crate) fn say_findings_about(&mut self, input: &str, findings: &Findings) {
        let verbose = self.globals.verbose;
        for finding in findings.iter().filter(|finding| verbose || finding.severity == Severity::Warning) {
            self.say_about(input, finding);
        }
    }

    /// Prints data on standard output.
    pub(crate) fn print(&mut self, text: impl Display) -> Result<(), Failure> {
        self.progress.clear();
        let written = writeln!(self.streams.out, "{text}").and_then(|()| self.streams.out.flush());
        written.map_err(|error| Failure::stream(&error))
    }

    /// Prints one JSON object on standard output.
    pub(crate) fn print_json(&mut self, object: &Value) -> Result<(), Failure> {
        self.print(format_args!("{object:#}"))
    }
}
