//! The benchmark program: see the library for its tasks.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(shapeloom_bench::run(std::env::args_os(), &mut std::io::stdout(), &mut std::io::stderr()))
}
