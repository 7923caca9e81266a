//! The test bench: builds the firmware of every target, runs it on emulated cores, compares every
//! word with the host, counts the cost of steps; compares the drives' commands on the host with
//! those of earlier versions; measures the repository.
//!
//! Called by `cargo xtask firmware`, `cargo xtask programs`, `cargo xtask pil`, `cargo xtask cost`
//! and `cargo xtask commands`.

mod commands;
mod cost;
mod firmware;
mod listing;
mod log;
mod marks;
mod pil;
mod targets;
mod toolchain;
mod vectors;

use clap::{Parser, Subcommand};
use std::process::{ExitCode, ExitStatus};
use targets::Target;

#[derive(Parser)]
#[command(
    name = "cargo xtask",
    about = "Builds firmware, runs it on emulated cores, compares and counts"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Targets; all by default
    #[arg(long, global = true, value_enum)]
    target: Vec<Target>,
    /// Skips targets whose tools are missing, with a warning
    #[arg(long, global = true)]
    where_possible: bool,
}

#[derive(Subcommand)]
enum Command {
    /// Builds and lints the firmware of every target, and runs it on the emulated board
    Firmware,
    /// Builds the programs of `targets/frameworks` for their chips
    Programs,
    /// Processor in the loop: replays closed-loop vectors on the emulated cores and compares every
    /// word
    Pil(pil::Options),
    /// Counts instructions, code, tables, state and stack of every step
    Cost(cost::Options),
    /// Compares a million commands of every counted drive, in closed loop on the host, with the
    /// expected ones
    Commands(commands::Options),
    /// Size of the repository, and circles of files that use each other
    Marks,
}

/// Error of the bench.
#[derive(Debug, thiserror::Error)]
enum BenchError {
    #[error(transparent)]
    Missing(#[from] toolchain::Missing),
    #[error("the firmware of {0} does not build")]
    Build(&'static str),
    #[error("the emulator of {0} hangs")]
    Hangs(&'static str),
    #[error("the emulator of {0} ended with {1}: {2}")]
    Ended(&'static str, ExitStatus, String),
    #[error("the firmware's list of drives cannot be read")]
    Listing,
    #[error("the library has no motor `{0}`")]
    Motor(String),
    #[error("`{0}` cannot be made on the host:\n{1}")]
    Drive(String, String),
    #[error("`{0}` is another drive on the host: the firmware was built from other sources")]
    Other(String),
    #[error("no stimulus: {0}")]
    Stimulus(String),
    #[error(transparent)]
    Plant(#[from] hexagen_lab::plant::PlantError),
    #[error(transparent)]
    Io(#[from] std::io::Error),
    #[error("the ELF cannot be read: {0}")]
    Elf(#[from] object::Error),
    #[error("{0}")]
    Failed(String),
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let targets = match arguments.target.as_slice() {
        [] => Target::ALL.to_vec(),
        named => named.to_vec(),
    };
    let targets = possible(targets, arguments.where_possible);
    let outcome = match arguments.command {
        Command::Firmware => targets.iter().try_for_each(|&target| demonstrate(target)),
        Command::Programs if targets.contains(&Target::CortexM4) => {
            firmware::Firmware::build_frameworks()
        }
        Command::Programs => Ok(()),
        Command::Pil(options) => pil::run(&targets, &options),
        Command::Cost(options) => cost::run(&targets, &options),
        Command::Commands(options) => commands::run(&options),
        Command::Marks => marks::print(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// The targets, without those whose tools are missing, if that is allowed.
fn possible(mut targets: Vec<Target>, where_possible: bool) -> Vec<Target> {
    if where_possible {
        targets.retain(|&target| match toolchain::find(target) {
            Ok(_) => true,
            Err(missing) => {
                eprintln!(
                    "WARNING: nothing is checked on {}: {missing}",
                    target.name()
                );
                false
            }
        });
    }
    targets
}

/// Builds a target's firmware and runs its main program on the emulated board.
fn demonstrate(target: Target) -> Result<(), BenchError> {
    let built = firmware::Firmware::build(target)?;
    built.lint()?;
    let folder = tempfile::tempdir()?;
    let printed = built.emulate("firmware", targets::Purpose::Answers, folder.path())?;
    print!(
        "{}, {}: {printed}",
        target.name(),
        built.toolchain.version()
    );
    Ok(())
}
