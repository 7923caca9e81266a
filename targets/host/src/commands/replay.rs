//! `hexagen replay`: every word of a drive from a log of what it was given.

use crate::cli::{Failure, note, print_text, tell_warnings, write_file};
use clap::Args;
use hexagen_lab::engine::{PlantOptions, SelectedMotor};
use hexagen_lab::replay::replay;
use std::path::PathBuf;

/// Options of `replay`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor file, or name of a library motor
    #[arg(value_name = "MOTOR")]
    pub motor: String,
    /// Board, a name of the library or a file [default: the motor file's]
    #[arg(long, value_name = "BOARD")]
    pub board: Option<String>,
    /// Controller variant [default: the motor file's]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]")]
    pub controller: Option<String>,
    /// CSV with a row per control period from the drive's start on, and a header: `adc_1`, `adc_2`,
    /// `adc_3` (counts of the sensed phases in their order), `hall`, `ticks` of the edge timer, where
    /// something is set `current_a`, `torque_nm`, `speed_rpm`, `bus` (ADC counts), and `call` (calibrate,
    /// precharge, reset, coast, brake, resume)
    #[arg(long, value_name = "FILE")]
    pub log: PathBuf,
    /// Write the periods into a file in place of stdout
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// Diagnostics; a log that cannot be read, with the line; a file that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let on_board = PlantOptions {
        board: options.board.clone(),
        ..PlantOptions::default()
    };
    let motor = SelectedMotor::find(&options.motor, &on_board)?;
    let drive = motor.prepare(options.controller.as_deref())?;
    tell_warnings(&drive);
    let path = options.log.display();
    let log = std::fs::File::open(&options.log)
        .map_err(|error| Failure::Argument(format!("--log {path}: {error}")))?;
    let mut rows = Vec::new();
    let replayed = replay(&drive, log, &mut rows)
        .map_err(|error| Failure::Argument(format!("--log {path}: {error}")))?;
    match &options.csv {
        Some(csv) => write_file(csv, &rows)?,
        None => print_text(String::from_utf8_lossy(&rows).trim_end())?,
    }
    let became = replayed.fault.map_or_else(
        || "no fault".to_owned(),
        |(period, fault)| format!("tripped in period {period}: {fault}"),
    );
    note(&format!(
        "{}, {}: {} periods, {became}",
        drive.motor, drive.variant, replayed.periods
    ));
    Ok(())
}
