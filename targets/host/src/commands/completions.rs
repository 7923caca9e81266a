//! `hexagen completions`: a script that completes the command line in a shell.

use crate::cli::{Arguments, Failure, print_text};
use clap::{Args, CommandFactory};
use clap_complete::{Shell, generate};

/// Options of `completions`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// The shell
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Runs the command.
///
/// # Errors
/// When the script cannot be printed.
pub fn run(options: &Options) -> Result<(), Failure> {
    let mut script = Vec::new();
    generate(
        options.shell,
        &mut Arguments::command(),
        "hexagen",
        &mut script,
    );
    print_text(&String::from_utf8_lossy(&script))
}
