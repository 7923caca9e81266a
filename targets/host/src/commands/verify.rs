//! `hexagen verify`: generated code against the bit-true reference, on every output and state bit.

use crate::cli::{Bar, Failure, Selection, print_json, print_table, warn};
use crate::commands::selected::{Refused, select};
use clap::{Args, ValueEnum};
use hexagen_lab::engine::{BuildError, Prepared, Verifier};
use hexagen_lab::report::Table;
use hexagen_lab::text::significant;
use hexagen_lab::verification::{Checked, mismatches, verify_with};
use rayon::prelude::*;
use serde::Serialize;
use std::env;

/// Greatest number of steps: hours on one core.
const MOST_STEPS: u64 = 100_000_000_000;

/// Options of `verify`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor files or names of library motors [default: the whole library]
    #[arg(value_name = "MOTOR")]
    pub motors: Vec<String>,
    /// Board, a name of the library or a file [default: the motor files']
    #[arg(long, value_name = "BOARD")]
    pub board: Option<String>,
    /// Controller variant, or `all` [default: the motor file's]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]")]
    pub controller: Option<Selection>,
    /// Steps per motor and controller, at most 1e11
    #[arg(long, value_name = "N", default_value_t = 1_000_000, allow_hyphen_values = true, value_parser = parse_steps)]
    pub steps: u64,
    /// Seed of the inputs
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Language of the emitted code; C is compiled by `CC` with `CFLAGS`
    #[arg(long, value_enum, default_value_t)]
    pub language: Language,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

fn parse_steps(text: &str) -> Result<u64, String> {
    let steps = text.parse().ok();
    steps
        .filter(|steps| (1..=MOST_STEPS).contains(steps))
        .ok_or_else(|| {
            format!("give a whole number from 1 to {MOST_STEPS}; for more steps, run again with another --seed")
        })
}

/// Language of emitted code.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// Rust
    #[default]
    Rust,
    /// C99
    C99,
}

impl Language {
    /// A verifier of each drive's code; the interpreter replaces a missing Rust compiler.
    ///
    /// # Errors
    /// A missing C compiler, or its error.
    fn verifiers(self, drives: &[Prepared]) -> Result<Vec<Verifier<'_>>, Failure> {
        match self {
            Self::Rust => Ok(drives.par_iter().map(Prepared::verifier).collect()),
            Self::C99 => {
                let flags = env::var("CFLAGS").unwrap_or_default();
                let drives = drives.par_iter();
                let compiled = drives.map(|drive| Verifier::of_c99(drive, &flags));
                Ok(compiled.collect::<Result<_, BuildError>>()?)
            }
        }
    }
}

/// Runs the command.
///
/// # Errors
/// Diagnostics, or a difference.
pub fn run(options: &Options) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Verification {
        passed: bool,
        steps: u64,
        results: Vec<Checked>,
        refused: Vec<Refused>,
    }
    let variants: Vec<Option<String>> = match &options.controller {
        None => vec![None],
        Some(selection) => selection.variants().into_iter().map(Some).collect(),
    };
    let takes_all = options.controller == Some(Selection::All);
    let (drives, refused) = select(
        &options.motors,
        options.board.as_deref(),
        &variants,
        takes_all,
    )?;
    let verifiers = options.language.verifiers(&drives)?;
    for (drive, verifier) in drives.iter().zip(&verifiers) {
        if let Some(reason) = verifier.why_interpreted() {
            let (motor, variant) = (&drive.motor, &drive.variant);
            warn(&format!("{motor}, {variant}: interpreted, {reason}"));
        }
    }
    let (steps, seed) = (options.steps, options.seed);
    let results = verify_with(&drives, &verifiers, steps, seed, &Bar::of_long_work());
    let outcome = mismatches(&results).map_or(Ok(()), |lines| Err(Failure::Check(lines)));
    if options.json {
        print_json(&Verification {
            passed: outcome.is_ok(),
            steps: results.iter().map(|checked| checked.steps).sum(),
            results,
            refused,
        })?;
    } else {
        print_table(&table(&results))?;
    }
    outcome
}

fn table(results: &[Checked]) -> Table {
    let mut table = Table::listed(
        ["motor", "controller", "engine"],
        [
            "steps",
            "result",
            "Msteps/s/core",
            "control %",
            "limited %",
            "saturated %",
            "commutating %",
            "angle %",
            "backward %",
            "start-up %",
            "tripped %",
        ],
    );
    for checked in results {
        let coverage = &checked.coverage;
        let share =
            |count: u64| format!("{:.1}", 100.0 * count as f64 / checked.steps.max(1) as f64);
        table.row([
            checked.motor.clone(),
            checked.controller.clone(),
            checked.engine.name().to_owned(),
            checked.steps.to_string(),
            if checked.passed { "equal" } else { "DIFFERENT" }.to_owned(),
            significant(checked.steps_per_second * 1e-6, 3),
            share(coverage.running),
            share(coverage.limited),
            share(coverage.past_reach),
            share(coverage.commutating),
            share(coverage.timed),
            share(coverage.backward),
            share(coverage.calibrating + coverage.precharging + coverage.starting),
            share(coverage.tripped),
        ]);
    }
    table
}
