//! `hexagen check`: whether and how well a drive will work, in ten lines and within a second.
//!
//! The drive is designed and verified as for generation, and judged on the simulated motor
//! (`hexagen_lab::judgement`); `report` compares, measures and plots.

mod text;

use crate::cli::{DriveArguments, Failure, note, print_json, print_text, tell_warnings};
use clap::Args;
use hexagen_lab::judgement::Judgement;

/// Options of `check`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// What is checked.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// Say why each option was chosen that the file leaves out
    #[arg(long)]
    pub reasons: bool,
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
    let judgement = Judgement::of(&drive)?;
    if options.json {
        print_json(&judgement)?;
    } else {
        tell_warnings(&drive);
        // Only a core that is not the board's own needs a word.
        if let Some(core) = drive
            .core_of_board
            .as_deref()
            .filter(|core| core.contains(": "))
        {
            note(&format!("the board's chip: {core}"));
        }
        let assumed = motor.assumed();
        if !assumed.is_empty() {
            note(&format!("assumed, so measure: {}", assumed.join(", ")));
        }
        let lines = text::lines(&judgement, &drive, options.reasons, &next(asked));
        print_text(&lines.join("\n"))?;
    }
    judgement
        .failure()
        .map_or(Ok(()), |error| Err(Failure::Check(error)))
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
