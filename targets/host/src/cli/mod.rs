//! The command line: arguments in, exit code out.
//!
//! Exit codes: 0: success; 1: a check failed, or the drive tripped; 2: bad input, or the result
//! cannot be written. Results go to stdout, everything else to stderr. With `--json`, stdout holds
//! exactly one JSON object, which of bad input has the member `error` alone.

mod arguments;
mod failure;
mod output;
mod progress;
mod quantity;

pub use crate::render::lines::{paragraph, verdict_lines, wrapped_row};
pub use arguments::{
    Arguments, Command, DriveArguments, Emit, PlantArguments, RunArguments, Selection, parse_rpm,
    parse_speed, parse_torque,
};
pub use failure::{ErrorAlone, Failure};
pub use output::{
    note, print_blocks, print_json, print_table, print_text, print_verdict, tell_warnings, warn,
    write_file,
};
pub use progress::{Bar, spinner};

use crate::commands;
use clap::Parser;
use std::io::ErrorKind;
use std::process::ExitCode;

/// Runs the program on the process's arguments.
pub fn run() -> ExitCode {
    commands::completions::answer();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        // clap prints help and version this way as well.
        Err(error) => return unread(&error),
    };
    let report = commands::report::Options {
        motor: None,
        board: None,
        output: arguments.output,
    };
    let command = arguments.command.unwrap_or(Command::Report(report));
    let is_json = command.is_json();
    let outcome = match command {
        Command::Report(options) => commands::report::run(&options),
        Command::Generate(options) => commands::generate::run(&options),
        Command::Simulate(options) => commands::simulate::run(&options),
        Command::Limit(options) => commands::limit::run(&options),
        Command::Faults(options) => commands::faults::run(&options),
        Command::Replay(options) => commands::replay::run(&options),
        Command::Halls(options) => commands::halls::run(&options),
        Command::Verify(options) => commands::verify::run(&options),
        Command::Prove(options) => commands::prove::run(&options),
        Command::Compare(options) => commands::compare::run(&options),
        Command::Reproduce(options) => commands::reproduce::run(&options),
        Command::Motors(options) => commands::motors::run(&options),
        Command::Advise(options) => commands::advise::run(&options),
        Command::Boards(options) => commands::boards::run(&options),
        Command::New(options) => commands::new::run(&options),
        Command::Check(options) => commands::check::run(&options),
        Command::Explain(options) => commands::explain::run(&options),
        Command::Completions(options) => commands::completions::run(&options),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print();
            if is_json && let Some(error) = failure.without_result() {
                // Nobody is left to tell that this failed, too.
                let _ = print_json(&error);
            }
            failure.exit_code()
        }
    }
}

/// Prints what is wrong with the command line, or the help that it asks for.
fn unread(error: &clap::Error) -> ExitCode {
    let asks_json = std::env::args_os().any(|argument| argument == "--json");
    if asks_json && error.use_stderr() {
        let text = error.to_string();
        let error = text.strip_prefix("error: ").unwrap_or(&text);
        // Nobody is left to tell that this failed, too.
        let _ = print_json(&ErrorAlone {
            error: error.trim_end().to_owned(),
        });
    }
    let code = u8::try_from(error.exit_code()).unwrap_or(2);
    match error.print() {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => ExitCode::from(2),
        _ => ExitCode::from(code),
    }
}
