//! The `hexagen` program: simulate, limit, verify, compare, generate, report, reproduce.

use std::process::ExitCode;

fn main() -> ExitCode {
    hexagen_host::cli::run()
}
