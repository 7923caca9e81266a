//! Regression test of the drives' commands: digests of a million steps of each counted drive, in
//! closed loop on the simulated plant.
//!
//! Only commands are compared, that is compare values and leg states; state words, and the response
//! to arbitrary inputs, may change. The plant uses sines and powers of the system's mathematical
//! library: another one may change the last bit of a voltage, later an ADC count, and so the
//! digest, with the same drives.

mod counted;
mod expected;
mod run;

use crate::BenchError;
use crate::vectors::prepared;
use counted::Counted;
use expected::{Expected, difference};
use hexagen_lab::engine::Prepared;
use rayon::prelude::*;
use run::{Commands, in_full};

/// Minimum steps of each drive.
const STEPS: usize = 1_000_000;

/// Options of the comparison.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Only drives whose symbol contains this
    #[arg(long)]
    only: Option<String>,
    /// Prints the samples and commands of this stretch, step by step, without comparing, for
    /// comparison with another version
    #[arg(long, value_name = "NUMBER")]
    stretch: Option<usize>,
    /// Writes the digests as expected
    #[arg(long, conflicts_with_all = ["only", "stretch"])]
    accept: bool,
}

/// Runs every counted drive and compares its commands with the expected ones, or writes them.
///
/// # Errors
/// If a drive's commands differ, a drive is not expected, an expected one is missing, or none is
/// selected.
pub fn run(options: &Options) -> Result<(), BenchError> {
    let mut drives = counted::drives();
    if let Some(part) = &options.only {
        drives.retain(|counted| counted.symbol.contains(part.as_str()));
        if drives.is_empty() {
            return Err(BenchError::Failed(format!(
                "no symbol of a counted drive contains `{part}`"
            )));
        }
    }
    if let Some(place) = options.stretch {
        for counted in &drives {
            println!("{}\n{}", counted.symbol, in_full(&made(counted)?, place)?);
        }
        return Ok(());
    }
    let found: Vec<Commands> = drives
        .par_iter()
        .map(|counted| Commands::of(&made(counted)?, STEPS))
        .collect::<Result<_, BenchError>>()?;
    let found = drives.iter().map(|counted| counted.symbol).zip(found);
    if options.accept {
        let found = found.inspect(|(symbol, commands)| println!("{}", line(symbol, commands)));
        let named = found.map(|(symbol, commands)| (symbol.to_owned(), commands));
        return Expected(named.collect()).write();
    }
    let Expected(mut expected) = Expected::read()?;
    let mut failures = vec![];
    for (symbol, commands) in found {
        let failure = match expected.remove(symbol) {
            None => Some("is not expected".to_owned()),
            Some(expected) => difference(&expected, &commands)
                .map(|difference| format!("its commands differ: {difference}")),
        };
        let verdict = if failure.is_some() { "DIFFERS" } else { "same" };
        println!("{}, {verdict}", line(symbol, &commands));
        failures.extend(failure.map(|failure| format!("{symbol} {failure}")));
    }
    if options.only.is_none() {
        let gone = expected.keys();
        failures.extend(gone.map(|symbol| format!("{symbol} is expected, but missing")));
    }
    if failures.is_empty() {
        return Ok(());
    }
    Err(BenchError::Failed(format!(
        "{}\n`cargo xtask commands --only SYMBOL --stretch NUMBER`, with this version and the one before, prints what to \
         compare; accept by `cargo xtask commands --accept` what is meant",
        failures.join("\n")
    )))
}

fn made(counted: &Counted) -> Result<Prepared, BenchError> {
    prepared(counted.symbol, counted.motor, &counted.variant)
}

fn line(symbol: &str, commands: &Commands) -> String {
    let Commands {
        steps,
        driving,
        digest,
        ..
    } = commands;
    format!("{symbol}: {steps} steps, {driving} driving, digest {digest:016x}")
}
