//! `hexagen replay`: every word of a drive from a log of what it was given.

use crate::cli::{
    DriveArguments, Failure, note, print_json, print_text, tell_warnings, write_file,
};
use clap::Args;
use hexagen_lab::replay::replay;
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Options of `replay`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// The drive that ran.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// CSV with a row per control period from the drive's start on, and a header: `adc_1`, `adc_2`,
    /// `adc_3` (counts of the sensed phases in their order), `hall`, `ticks` of the edge timer, where
    /// something is set `current_a`, `torque_nm`, `speed_rpm`, `bus` (ADC counts), and `call` (calibrate,
    /// precharge, reset, coast, brake, resume)
    #[arg(long, value_name = "FILE")]
    pub log: PathBuf,
    /// Write the periods into a file in place of stdout
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Print one JSON object with the periods
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
}

/// A replayed log.
#[derive(Debug, Serialize)]
struct Replayed<'a> {
    motor: &'a str,
    controller: &'a str,
    tripped: Option<Tripped>,
    /// By column: numbers and words; absent values are null.
    periods: Vec<BTreeMap<String, Value>>,
}

#[derive(Debug, Serialize)]
struct Tripped {
    period: usize,
    fault: String,
}

/// Opens a log.
///
/// # Errors
/// A file that cannot be read.
pub fn open_log(path: &Path) -> Result<File, Failure> {
    File::open(path).map_err(|error| in_log(path, &error))
}

/// What is wrong with a log.
pub fn in_log(path: &Path, error: &dyn std::error::Error) -> Failure {
    Failure::Argument(format!("--log {}: {error}", path.display()))
}

/// A cell as data.
fn value_of(text: String) -> Value {
    match text.parse::<f64>() {
        _ if text.is_empty() => Value::Null,
        Ok(number) => number.into(),
        Err(_) => text.into(),
    }
}

/// Runs the command.
///
/// # Errors
/// Diagnostics; a log that cannot be read, with the line; a file that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let drive = options.drive.prepare()?;
    tell_warnings(&drive);
    let mut rows = Vec::new();
    let replayed = replay(&drive, open_log(&options.log)?, &mut rows)
        .map_err(|error| in_log(&options.log, &error))?;
    if options.json {
        let periods = csv::Reader::from_reader(rows.as_slice()).into_deserialize();
        let periods = periods.map(|row: csv::Result<BTreeMap<String, String>>| {
            let cells = row?.into_iter();
            Ok(cells
                .map(|(column, text)| (column, value_of(text)))
                .collect())
        });
        let periods: Result<_, csv::Error> = periods.collect();
        return print_json(&Replayed {
            motor: &drive.motor,
            controller: &drive.variant,
            tripped: replayed.fault.map(|(period, fault)| Tripped {
                period,
                fault: fault.to_string(),
            }),
            periods: periods.map_err(|error| in_log(&options.log, &error))?,
        });
    }
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
