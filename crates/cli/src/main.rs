//! The program `shapeloom`.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(shapeloom_cli::run_process())
}
