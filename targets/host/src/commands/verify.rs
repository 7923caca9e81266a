//! `hexagen verify`: generated code against the bit-true reference, on every output and state bit.

use crate::cli::{Bar, Failure, Selection, paragraph, print_json, print_table, print_text, warn};
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
        print_table(&results_table(&results))?;
        print_text("")?;
        print_table(&coverage_table(&results))?;
        print_text(&paragraph(
            "Shares of all steps: limited to the voltage of the bus; beyond its reach along the EMF, as far as a law tells it; \
             in a commutation of phases; with an angle between Hall edges; with such an angle backward. Start: calibration, pre-charge and \
             the wait for the rotor's angle.",
        ))?;
    }
    outcome
}

fn results_table(results: &[Checked]) -> Table {
    let texts = ["motor", "controller", "engine"];
    let mut table = Table::listed(
        texts,
        [
            "steps",
            "result",
            "Msteps/s a core",
            "in control %",
            "tripped %",
        ],
    );
    for checked in results {
        let coverage = &checked.coverage;
        table.row([
            checked.motor.clone(),
            checked.controller.clone(),
            checked.engine.name().to_owned(),
            checked.steps.to_string(),
            if checked.passed { "equal" } else { "DIFFERENT" }.to_owned(),
            significant(checked.steps_per_second * 1e-6, 3),
            share(checked, coverage.running),
            share(checked, coverage.tripped),
        ]);
    }
    table
}

/// What else the steps were, percent of them.
fn coverage_table(results: &[Checked]) -> Table {
    let shares = [
        "limited %",
        "beyond reach %",
        "commutating %",
        "angle %",
        "backward %",
        "start %",
    ];
    let mut table = Table::listed(["motor", "controller"], shares);
    for checked in results {
        let coverage = &checked.coverage;
        table.row([
            checked.motor.clone(),
            checked.controller.clone(),
            share(checked, coverage.limited),
            share(checked, coverage.past_reach),
            share(checked, coverage.commutating),
            share(checked, coverage.timed),
            share(checked, coverage.backward),
            share(
                checked,
                coverage.calibrating + coverage.precharging + coverage.starting,
            ),
        ]);
    }
    table
}

/// A count of steps over all of them, percent.
fn share(checked: &Checked, count: u64) -> String {
    format!("{:.1}", 100.0 * count as f64 / checked.steps.max(1) as f64)
}
