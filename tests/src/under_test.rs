//! The program `shapeloom`, built beside the tests so that they can start it as a process. With `SHAPELOOM_PEAK` in the
//! environment its last line on standard error is the most memory that it had, in kilobytes, where the system tells.
#![allow(clippy::print_stderr)]

use std::process::ExitCode;

fn main() -> ExitCode {
    let code = shapeloom_cli::run_process();
    if std::env::var_os("SHAPELOOM_PEAK").is_some() {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix(" kB"));
        eprintln!("{}", peak.unwrap_or("unknown").trim());
    }
    ExitCode::from(code)
}
