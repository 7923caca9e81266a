//! `hexagen completions`: a script that completes the command line in a shell.
//!
//! The script asks the program, so that it offers the names of library motors and boards beside files.

use crate::cli::{Arguments, Failure, print_text};
use clap::builder::Str;
use clap::{Arg, Args, Command, CommandFactory};
use clap_complete::engine::ValueCompleter;
use clap_complete::env::Shells;
use clap_complete::{ArgValueCompleter, CompleteEnv, CompletionCandidate, PathCompleter, Shell};
use hexagen_codegen::spec::BOARDS;
use hexagen_lab::engine::library;
use std::ffi::OsStr;

/// The program.
const NAME: &str = "hexagen";

/// Variable by which a script asks for completions.
const VARIABLE: &str = "HEXAGEN_COMPLETE";

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
    let shell = options.shell.to_string();
    let mut script = Vec::new();
    Shells::builtins()
        .completer(&shell)
        .and_then(|shell| {
            let written = shell.write_registration(VARIABLE, NAME, NAME, NAME, &mut script);
            written.ok()
        })
        .ok_or_else(|| Failure::Argument(format!("cannot write a script for {shell}")))?;
    print_text(&String::from_utf8_lossy(&script))
}

/// Answers a script that asks for completions, and ends the program then.
pub fn answer() {
    CompleteEnv::with_factory(command).var(VARIABLE).complete();
}

/// The command line with what its arguments may be.
fn command() -> Command {
    Arguments::command().mut_subcommands(|command| command.mut_args(with_names))
}

fn with_names(argument: Arg) -> Arg {
    let names = argument.get_value_names().and_then(<[_]>::first);
    match names.map(Str::as_str) {
        Some("MOTOR") => argument.add(ArgValueCompleter::new(motors)),
        Some("BOARD") => argument.add(ArgValueCompleter::new(boards)),
        _ => argument,
    }
}

fn motors(typed: &OsStr) -> Vec<CompletionCandidate> {
    names_and_files(library().iter().map(|motor| motor.name), typed)
}

fn boards(typed: &OsStr) -> Vec<CompletionCandidate> {
    names_and_files(BOARDS.iter().map(|board| board.name), typed)
}

/// Names that begin with what was typed, and TOML files.
fn names_and_files(
    names: impl Iterator<Item = &'static str>,
    typed: &OsStr,
) -> Vec<CompletionCandidate> {
    let is_toml = |path: &std::path::Path| path.extension().is_some_and(|ending| ending == "toml");
    let names = names.filter(|name| typed.to_str().is_some_and(|typed| name.starts_with(typed)));
    let files = PathCompleter::file().filter(is_toml).complete(typed);
    names.map(CompletionCandidate::new).chain(files).collect()
}
