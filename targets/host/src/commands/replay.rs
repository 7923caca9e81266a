//! `hexagen replay`: every word of a drive from a log of what it was given.

use crate::cli::{
    DriveArguments, Failure, note, paragraph, print_json, print_table, print_text, tell_warnings,
    write_file,
};
use clap::Args;
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::engine::Prepared;
use hexagen_lab::replay::{Cell, Replayed, replay};
use hexagen_lab::report::Table;
use hexagen_lab::text::significant;
use serde::Serialize;
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
    /// Print every word of every period, as CSV
    #[arg(long)]
    pub all: bool,
    /// Write every word of every period into a file
    #[arg(long, value_name = "FILE", conflicts_with = "all")]
    pub csv: Option<PathBuf>,
    /// Print one JSON object with the periods
    #[arg(long, conflicts_with_all = ["csv", "all"])]
    pub json: bool,
}

/// A replayed log as data.
#[derive(Debug, Serialize)]
struct Outcome<'a> {
    motor: &'a str,
    controller: &'a str,
    tripped: Option<Tripped>,
    /// By column; absent values are null.
    periods: Vec<BTreeMap<&'a str, &'a Cell>>,
}

#[derive(Debug, Serialize)]
struct Tripped {
    period: usize,
    fault: String,
}

impl<'a> Outcome<'a> {
    fn of(drive: &'a Prepared, replayed: &'a Replayed) -> Self {
        let columns = replayed.columns.iter().map(String::as_str);
        let periods = replayed.periods.iter();
        Self {
            motor: &drive.motor,
            controller: &drive.variant,
            tripped: replayed.fault.map(|(period, fault)| Tripped {
                period,
                fault: fault.to_string(),
            }),
            periods: periods
                .map(|row| columns.clone().zip(row).collect())
                .collect(),
        }
    }
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

/// Runs the command.
///
/// # Errors
/// Diagnostics; a log that cannot be read, with the line; a file that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let drive = options.drive.prepare()?;
    tell_warnings(&drive);
    let replayed =
        replay(&drive, open_log(&options.log)?).map_err(|error| in_log(&options.log, &error))?;
    if options.json {
        return print_json(&Outcome::of(&drive, &replayed));
    }
    let head = head(&drive, &replayed);
    if options.all {
        print_text(&String::from_utf8_lossy(&csv_of(&replayed, options)?))?;
        note(&head);
        return Ok(());
    }
    if let Some(csv) = &options.csv {
        write_file(csv, &csv_of(&replayed, options)?)?;
    }
    print_text(&paragraph(&head))?;
    print_table(&table(&replayed))?;
    if options.csv.is_some() {
        return Ok(());
    }
    print_text("--all prints every word of every period, --csv FILE writes them.")
}

fn csv_of(replayed: &Replayed, options: &Options) -> Result<Vec<u8>, Failure> {
    let mut rows = Vec::new();
    let written = replayed.write_csv(&mut rows);
    written.map_err(|error| in_log(&options.log, &error))?;
    Ok(rows)
}

/// What was replayed, and whether the drive tripped.
fn head(drive: &Prepared, replayed: &Replayed) -> String {
    let t_s = drive.spec.inverter.t_s;
    let became = replayed.fault.map_or_else(
        || "no fault".to_owned(),
        |(period, fault)| {
            let time = engineering(period as f64 * t_s, "s");
            format!("tripped in period {period}, at {time}: {fault}")
        },
    );
    let periods = replayed.periods.len();
    let time = engineering(periods as f64 * t_s, "s");
    let Prepared { motor, variant, .. } = drive;
    format!("{motor}, {variant}: {periods} periods, {time}; {became}")
}

/// The quantities over the log: in how many periods they exist, and their range and last value.
fn table(replayed: &Replayed) -> Table {
    let mut table = Table::listed(["quantity"], ["periods", "least", "greatest", "last"]);
    for place in replayed.quantities.clone() {
        let cells = replayed.periods.iter().map(|row| &row[place]);
        let values: Vec<f64> = cells.filter_map(Cell::number).collect();
        let least = values.iter().copied().reduce(f64::min);
        let greatest = values.iter().copied().reduce(f64::max);
        let [least, greatest, last] =
            [least, greatest, values.last().copied()].map(|value| significant(value, 4));
        let name = replayed.columns[place].clone();
        table.row([name, values.len().to_string(), least, greatest, last]);
    }
    table
}
