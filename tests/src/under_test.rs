//! The program `shapeloom`, built beside the tests so that they can start it as a process.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(shapeloom_cli::run_process())
}
