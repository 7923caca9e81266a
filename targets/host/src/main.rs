//! The `hexagen` program: simulate, limit, verify, compare, generate, report.

use std::process::ExitCode;

fn main() -> ExitCode {
    hexagen_host::cli::run()
}
