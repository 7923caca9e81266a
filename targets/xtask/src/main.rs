//! `cargo xtask`: the one tool that sets up, builds, runs and compares.
//!
//! `cargo xtask test` is what continuous integration runs: every check of a push, in an order that
//! fails early. `cargo xtask nightly` adds the long ones. Every step is a plain cargo command that
//! is printed before it runs, so that it can be repeated by hand.

mod compile_time;
mod editors;
mod install;
mod mutants;
mod packages;
mod readme;
mod step;
mod steps;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(
    name = "xtask",
    about = "Sets up, builds, runs and compares; `cargo xtask test` is the check of every push"
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Format, contents of packages, lints, documentation, all tests but those that take minutes, the
    /// README's first drive, and the firmware on emulated cores with its cost
    Test,
    /// `test` and `packages`, then bit-for-bit verification of every library motor over many steps; tests
    /// over all products of options, all planted faults and many random motors; tests that take minutes:
    /// studies of the library, disturbances in pairs, the pages of all motors, `editors`; a million steps
    /// of `pil`, `commands`, `programs`, the installed program, the proofs of all motors, which Coq checks
    /// once more; then `mutants`, another sample each day
    Nightly {
        /// Steps per motor and controller
        #[arg(long, default_value_t = 100_000_000)]
        steps: u64,
    },
    /// Packs every published crate, and builds each from its package
    Packages,
    /// Builds the firmware of every target and runs it on the emulated board
    Firmware(Forwarded),
    /// Builds the programs for real boards, `targets/frameworks`
    Programs(Forwarded),
    /// Processor in the loop: closed-loop vectors on the emulated cores, every word compared
    /// (`--target`, `--steps`)
    Pil(Forwarded),
    /// Cost of a step on every target: instructions, bytes, cycles (`--target`, `--only`,
    /// `--accept`)
    Cost(Forwarded),
    /// Regression of the counted drives' commands: digests of a million steps each (`--only`,
    /// `--accept`)
    Commands(Forwarded),
    /// Size of the repository with its marks, and circles of files that use each other
    Marks,
    /// Plants 300 faults and lists the detector of each: interval verifier, Gappa, or the
    /// comparison with the bit-true model
    Faults,
    /// Mutation score: share of small changes of the sources that the tests notice, apart from text
    /// snapshots, in the last commit: a sample of generator and laboratory, and all of the runtime
    Mutants(mutants::Options),
    /// Time that 100 controllers add to `cargo check`, and the share of each part of the generator
    CompileTime,
    /// What rust-analyzer shows of a macro call: documentation, definitions, errors; installs it,
    /// if it is missing
    Editors,
    /// Refreshes every recorded expectation (snapshots, compiler messages) except that of
    /// `commands`, which changes only with an intended change of behaviour; read the diff
    /// afterwards
    Accept,
}

/// Commands of the test bench, `targets/bench`.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
struct Forwarded {
    /// Options of the test bench; `--help` lists them
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    options: Vec<String>,
}

fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Test => steps::checker()
            .and_then(|()| steps::browser())
            .and_then(|()| checks()),
        Command::Nightly { steps } => steps::checker()
            .and_then(|()| steps::browser())
            .and_then(|()| steps::certificate_checker())
            .and_then(|()| editors::install())
            .and_then(|()| checks())
            .and_then(|()| steps::run(&steps::long_checks(steps)?))
            .and_then(|()| mutants::score(&mutants::Options::tonight())),
        Command::Packages => {
            packages::check_contents().and_then(|()| steps::run(&[packages::pack(true)?]))
        }
        Command::Firmware(forwarded) => steps::run(&[steps::bench("firmware", &forwarded.options)]),
        Command::Programs(forwarded) => steps::run(&[steps::bench("programs", &forwarded.options)]),
        Command::Pil(forwarded) => steps::run(&[steps::bench("pil", &forwarded.options)]),
        Command::Cost(forwarded) => steps::run(&[steps::bench("cost", &forwarded.options)]),
        Command::Commands(forwarded) => steps::run(&[steps::bench("commands", &forwarded.options)]),
        Command::Marks => steps::run(&[steps::bench("marks", &[])]),
        Command::Faults => steps::checker().and_then(|()| steps::run(&[steps::faults()])),
        Command::Mutants(options) => steps::checker()
            .and_then(|()| steps::browser())
            .and_then(|()| mutants::score(&options)),
        Command::CompileTime => compile_time::measure(step::root()),
        Command::Editors => editors::install().and_then(|()| steps::run(&[editors::session()])),
        Command::Accept => steps::checker()
            .and_then(|()| steps::browser())
            .and_then(|()| steps::run(&steps::refresh())),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("xtask: {message}");
            ExitCode::FAILURE
        }
    }
}

/// All checks of a push.
fn checks() -> Result<(), String> {
    packages::check_contents()?;
    steps::run(&steps::checks()?)
}
