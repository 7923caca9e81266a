//! `hexagen verify`: generated code against the bit-true reference, on every output and state bit.

use crate::cli::{Failure, Selection, TextTable, bar, print_json, print_text, significant, warn};
use crate::commands::selected::{Refused, select};
use clap::{Args, ValueEnum};
use hexagen_lab::engine::{BuildError, EngineKind, Prepared, Verifier};
use hexagen_reference::verify::Report;
use indicatif::ProgressBar;
use rayon::prelude::*;
use serde::Serialize;
use std::env;
use std::time::Instant;

/// Steps of one run from rest; a longer check is many runs with seeds of their own.
const RUN: u64 = 1 << 19;

/// Most steps of a check: hours on one core.
const MOST_STEPS: u64 = 100_000_000_000;

/// Options of `verify`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor files or names of library motors [default: the whole library]
    #[arg(value_name = "MOTOR")]
    pub motors: Vec<String>,
    /// Controller variant, or `all` [default: the motor file's]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]")]
    pub controller: Option<Selection>,
    /// Steps per motor and controller, at most 1e11
    #[arg(long, value_name = "N", default_value_t = 1_000_000, allow_hyphen_values = true, value_parser = parse_steps)]
    pub steps: u64,
    /// Seed of the inputs
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// The emitted code that is compared; C is compiled by `CC`, with `CFLAGS`
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
            format!("give a whole number from 1 to {MOST_STEPS}; more steps are further runs, each with a --seed of its own")
        })
}

/// A language that drives are emitted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// Rust
    #[default]
    Rust,
    /// C99
    C99,
}

impl Language {
    /// What runs each drive's code in this language.
    ///
    /// # Errors
    /// No C compiler, or what it said; without one of Rust, the interpreter runs.
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

/// The check of one drive.
#[derive(Clone, Debug, Serialize)]
pub struct Checked {
    /// Motor.
    pub motor: String,
    /// Controller variant.
    pub controller: String,
    /// What ran.
    pub engine: EngineKind,
    /// Steps that were compared.
    pub steps: u64,
    /// Whether every output and state word was equal after every step.
    pub passed: bool,
    /// Steps per second and core.
    pub steps_per_second: f64,
    /// What the steps covered.
    pub coverage: Coverage,
    /// What differs.
    pub mismatch: Option<String>,
}

/// How many steps went which way.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Coverage {
    /// In control.
    pub running: u64,
    /// Offset calibration under way.
    pub calibrating: u64,
    /// Bootstrap pre-charge under way.
    pub precharging: u64,
    /// Tripped.
    pub tripped: u64,
    /// In control and limited to the hexagon.
    pub limited: u64,
    /// Of these, past the reach along the EMF (torque priority).
    pub past_reach: u64,
    /// In control with a commutation under way (pair modulation).
    pub commutating: u64,
    /// In control with an interpolated rotor angle.
    pub timed: u64,
    /// Of these, turning backward.
    pub backward: u64,
    /// Calls between steps.
    pub actions: u64,
}

impl From<&Report> for Coverage {
    fn from(report: &Report) -> Self {
        Self {
            running: report.running,
            calibrating: report.calibrating,
            precharging: report.precharging,
            tripped: report.tripped,
            limited: report.limited,
            past_reach: report.past_reach,
            commutating: report.commutating,
            timed: report.timed,
            backward: report.backward,
            actions: report.actions,
        }
    }
}

/// Compares each drive over `steps` steps; runs of all drives share the cores.
pub fn collect(drives: &[Prepared], steps: u64, seed: u64, progress: &ProgressBar) -> Vec<Checked> {
    let verifiers: Vec<Verifier> = drives.par_iter().map(Prepared::verifier).collect();
    compare(drives, &verifiers, steps, seed, progress)
}

/// As [`collect`], with what runs each drive.
fn compare(
    drives: &[Prepared],
    verifiers: &[Verifier<'_>],
    steps: u64,
    seed: u64,
    progress: &ProgressBar,
) -> Vec<Checked> {
    for (drive, verifier) in drives.iter().zip(verifiers) {
        if let Some(reason) = verifier.why_interpreted() {
            warn(&format!(
                "{}, {}: interpreted, {reason}",
                drive.motor, drive.variant
            ));
        }
    }
    let runs: Vec<(usize, u64, u64)> = (0..drives.len())
        .flat_map(|drive| {
            (0..steps.div_ceil(RUN)).map(move |run| (drive, run, RUN.min(steps - run * RUN)))
        })
        .collect();
    let outcomes: Vec<_> = runs
        .par_iter()
        .map(|&(drive, run, steps)| {
            let begin = Instant::now();
            let outcome = verifiers[drive].verify(steps, seed.wrapping_add(run));
            progress.inc(steps);
            (drive, outcome, begin.elapsed().as_secs_f64())
        })
        .collect();
    drives
        .iter()
        .enumerate()
        .map(|(index, drive)| {
            let mut report = Report::default();
            let (mut seconds, mut mismatch) = (0.0, None);
            for (_, outcome, took) in outcomes.iter().filter(|(drive, _, _)| *drive == index) {
                match outcome {
                    Ok(part) => {
                        report.add(part);
                        seconds += took;
                    }
                    Err(error) => {
                        mismatch.get_or_insert_with(|| error.clone());
                    }
                }
            }
            Checked {
                motor: drive.motor.clone(),
                controller: drive.variant.clone(),
                engine: verifiers[index].kind(),
                steps: report.steps,
                passed: mismatch.is_none(),
                steps_per_second: if seconds > 0.0 {
                    report.steps as f64 / seconds
                } else {
                    0.0
                },
                coverage: Coverage::from(&report),
                mismatch,
            }
        })
        .collect()
}

/// Runs the command.
///
/// # Errors
/// Diagnostics, or the difference that was found.
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
    let (drives, refused) = select(&options.motors, &variants, takes_all)?;
    let verifiers = options.language.verifiers(&drives)?;
    let progress = bar(options.steps * drives.len() as u64, "comparing");
    let results = compare(&drives, &verifiers, options.steps, options.seed, &progress);
    progress.finish_and_clear();
    let failed: Vec<&Checked> = results.iter().filter(|checked| !checked.passed).collect();
    let outcome = match failed.first() {
        None => Ok(()),
        Some(_) => Err(Failure::Check(
            failed
                .iter()
                .map(|checked| {
                    let mismatch = checked.mismatch.as_deref().unwrap_or_default();
                    format!("{}, {}: {mismatch}", checked.motor, checked.controller)
                })
                .collect::<Vec<_>>()
                .join("\n"),
        )),
    };
    if options.json {
        print_json(&Verification {
            passed: outcome.is_ok(),
            steps: results.iter().map(|checked| checked.steps).sum(),
            results,
            refused,
        })?;
    } else {
        print_text(&table(&results))?;
    }
    outcome
}

fn table(results: &[Checked]) -> String {
    let mut table = TextTable::new(
        3,
        [
            "motor",
            "controller",
            "engine",
            "steps",
            "result",
            "Msteps/s/core",
            "control %",
            "limited %",
            "past reach %",
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
            share(coverage.calibrating + coverage.precharging),
            share(coverage.tripped),
        ]);
    }
    table.render()
}
