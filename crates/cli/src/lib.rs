//! The command line of shapeloom, as a library so that tests can call it: [`run`] takes arguments and streams and gives
//! an exit code.
//!
//! | code | meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | a check or comparison found something |
//! | 2 | wrong usage |
//! | 3 | the input is unreadable or malformed |
//! | 4 | no way to do it, or not supported |
//! | 5 | the conversion failed, or a strict tolerance was missed |
//! | 6 | the output cannot be written |
//! | 7 | over a memory or time limit |
//! | 130 | interrupted |

mod account;
mod arguments;
mod commands;
mod explanations;
mod failure;
mod input;
mod output;
mod progress;
mod session;
mod settings;
mod soundness;
mod streams;
mod structure_costs;
mod subjects;
mod workload;

pub use explanations::explanation;
pub use streams::Streams;

use std::ffi::OsString;

use clap::Parser;
use shapeloom_core::CancelFlag;

use arguments::{Arguments, Command};
use session::Session;

/// Runs the process's own command line on its own streams; an interrupt cancels.
pub fn run_process() -> u8 {
    let flag = CancelFlag::default();
    let handler = flag.clone();
    // Without a handler an interrupt just ends the process, which is no worse than before.
    let _ = ctrlc::set_handler(move || handler.cancel());
    run(std::env::args_os(), &mut Streams::of_process(), &flag)
}

/// Runs a command line, the program's name first, and returns its exit code. `flag` cancels it from outside.
pub fn run(arguments: impl IntoIterator<Item = OsString>, streams: &mut Streams, flag: &CancelFlag) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            let text = error.render();
            // Help and version are what was asked for; anything else is wrong usage.
            let (stream, code) = if error.use_stderr() { (&mut streams.err, 2) } else { (&mut streams.out, 0) };
            let _ = write!(stream, "{text}");
            return code;
        }
    };
    let json = arguments.globals.json;
    let outcome = Session::new(&arguments.globals, streams, flag).and_then(|mut session| {
        let session = &mut session;
        session.in_pool(|session| match &arguments.command {
            Command::Convert(arguments) => commands::convert::run(arguments, session),
            Command::Info(arguments) => commands::info::run(arguments, session),
            Command::Check(arguments) => commands::check::run(arguments, session),
            Command::Compare(arguments) => commands::compare::run(arguments, session),
            Command::Render(arguments) => commands::render::run(arguments, session),
            Command::Make(arguments) => commands::make::run(arguments, session),
            Command::Boolean(arguments) => commands::boolean::run(arguments, session),
            Command::Structures(arguments) => commands::structures::run(arguments, session),
            Command::Formats => commands::formats::run(session),
            Command::Graph(arguments) => commands::graph::run(arguments, session),
            Command::Explain(arguments) => commands::explain::run(arguments, session),
        })
    });
    match outcome {
        Ok(()) => 0,
        Err(failure) => {
            failure.print(streams, json);
            failure.exit_code()
        }
    }
}
