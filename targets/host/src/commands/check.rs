//! `hexagen check`: whether and how well a drive will work, in ten lines and within a second.
//!
//! The drive is designed and verified as for generation, and judged on the simulated motor
//! (`hexagen_lab::judgement`); `report` compares, measures and plots.

mod text;

use super::cut::beyond_followed;
use crate::cli::{
    DriveArguments, Failure, note, parse_rpm, print_json, print_verdict, tell_warnings,
    verdict_lines,
};
use clap::Args;
use hexagen_codegen::timing::long_products;
use hexagen_lab::engine::Prepared;
use hexagen_lab::judgement::Judgement;

/// Options of `check`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// What is checked.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// Run it at this mechanical speed in rpm, too; negative is backward
    #[arg(long, value_name = "RPM", value_parser = parse_rpm, allow_hyphen_values = true)]
    pub rpm: Option<f64>,
    /// Say why each option was chosen that the file leaves out
    #[arg(long)]
    pub reasons: bool,
    /// Print every clause of every line, also where they are more than ten lines
    #[arg(long)]
    pub all: bool,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// All diagnostics; a drive that does not work.
pub fn run(options: &Options) -> Result<(), Failure> {
    let asked = &options.drive;
    let motor = asked.select()?;
    let drive = motor.prepare_for_torque(asked.controller.as_deref())?;
    let mut judgement = Judgement::of(&drive)?;
    if let Some(rpm) = options.rpm {
        check_speed(&drive, rpm)?;
        judgement.ask(&drive, rpm)?;
    }
    if options.json {
        print_json(&judgement)?;
    } else {
        tell_warnings(&drive);
        if let Some(core) = of_core(&drive) {
            note(&format!("the board's chip: {core}"));
        }
        if let Some(text) = text::stated_torque(&drive.spec.motor) {
            note(&text);
        }
        let assumed = motor.assumed();
        if !assumed.is_empty() {
            note(&format!("assumed, so measure: {}", assumed.join(", ")));
        }
        let rows = text::rows(&judgement, &drive, options.reasons, &next(asked));
        let head = format!("{}: {}", judgement.motor, judgement.verdict);
        print_verdict(&within(&head, &rows, most(options)))?;
    }
    judgement
        .failure()
        .map_or(Ok(()), |error| Err(Failure::Check(error)))
}

/// Least speed of a run over the rated one: an electrical turn of a slower one takes long to simulate.
const LEAST_SPEED: f64 = 0.01;

/// Checks that the drive follows the rotor at a speed.
fn check_speed(drive: &Prepared, rpm: f64) -> Result<(), Failure> {
    if let Some(text) = beyond_followed(drive, rpm) {
        let most = drive.maximum_rpm().floor();
        return Err(Failure::Argument(format!(
            "{text}; give at most {most} rpm"
        )));
    }
    let least = drive.minimum_rpm().max(LEAST_SPEED * drive.rated_rpm());
    if rpm.abs() < least * (1.0 - 1e-9) {
        let least = least.ceil();
        return Err(Failure::Argument(format!(
            "--rpm {rpm}: slower than this command runs a drive; give at least {least} rpm, or take `hexagen simulate`"
        )));
    }
    Ok(())
}

/// Cycles that a long product takes more on a Cortex-M3 than on a Cortex-M4, at most.
const LONG_PRODUCT: u32 = 6;

/// What the board's file says of a core that is not its own: only that needs a word.
fn of_core(drive: &Prepared) -> Option<String> {
    let core = drive.core_of_board.as_deref()?;
    let core = Some(core).filter(|core| core.contains(": "))?;
    if !core.contains("Cortex-M3") {
        return Some(core.to_owned());
    }
    let products = long_products(drive.generated.graph.program());
    Some(format!(
        "{core}; a step has up to {products} of them: at most {} cycles more",
        LONG_PRODUCT * products
    ))
}

/// The verdict and its rows in so many lines; without the last row, the next command, where the others need its room.
fn within(head: &str, rows: &[(&str, String)], most: usize) -> Vec<String> {
    let lines = verdict_lines(head, rows, usize::MAX, "");
    let count: usize = lines.iter().map(|row| row.lines().count()).sum();
    match rows.split_last() {
        Some((_, others)) if count > most => verdict_lines(head, others, most, "with --all"),
        _ => lines,
    }
}

/// Most lines.
fn most(options: &Options) -> usize {
    if options.all || options.reasons {
        usize::MAX
    } else {
        10
    }
}

/// The command that says more of the same drive.
fn next(asked: &DriveArguments) -> String {
    let motor = &asked.motor;
    let board = asked.board.iter().map(|board| format!(" --board {board}"));
    let board: String = board.collect();
    match &asked.controller {
        Some(controller) => format!("hexagen limit {motor}{board} --controller \"{controller}\""),
        None => format!("hexagen report {motor}{board}"),
    }
}
