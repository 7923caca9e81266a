//! `hexagen replay`: every word of a drive from a log of what it was given.

use crate::cli::{
    DriveArguments, Failure, note, paragraph, print_json, print_table, print_text, tell_warnings,
    write_file,
};
use clap::Args;
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::engine::Prepared;
use hexagen_lab::log::LogError;
use hexagen_lab::replay::{Cell, Quantity, Replayed, columns, replay, replay_csv};
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
    fn of(
        drive: &'a Prepared,
        replayed: &Replayed,
        columns: &'a [String],
        periods: &'a [Vec<Cell>],
    ) -> Self {
        let columns = columns.iter().map(String::as_str);
        Self {
            motor: &drive.motor,
            controller: &drive.variant,
            tripped: replayed.fault.map(|(period, fault)| Tripped {
                period,
                fault: fault.to_string(),
            }),
            periods: (periods.iter())
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
    let log = open_log(&options.log)?;
    let told = |error: LogError| in_log(&options.log, &error);
    if options.json {
        let mut periods = Vec::new();
        let kept = |row| {
            periods.push(row);
            Ok(())
        };
        let replayed = replay(&drive, log, kept).map_err(told)?;
        let columns = columns(&drive);
        return print_json(&Outcome::of(&drive, &replayed, &columns, &periods));
    }
    if !options.all && options.csv.is_none() {
        let replayed = replay(&drive, log, |_| Ok(())).map_err(told)?;
        print_summary(&drive, &replayed)?;
        return print_text("--all prints every word of every period, --csv FILE writes them.");
    }
    let mut rows = Vec::new();
    let replayed = replay_csv(&drive, log, &mut rows).map_err(told)?;
    if let Some(csv) = &options.csv {
        write_file(csv, &rows)?;
        return print_summary(&drive, &replayed);
    }
    print_text(&String::from_utf8_lossy(&rows))?;
    note(&head(&drive, &replayed));
    Ok(())
}

fn print_summary(drive: &Prepared, replayed: &Replayed) -> Result<(), Failure> {
    print_text(&paragraph(&head(drive, replayed)))?;
    print_table(&table(replayed))
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
    let periods = replayed.periods;
    let time = engineering(periods as f64 * t_s, "s");
    let Prepared { motor, variant, .. } = drive;
    format!("{motor}, {variant}: {periods} periods, {time}; {became}")
}

/// The quantities over the log: in how many periods they exist, and their range and last value.
fn table(replayed: &Replayed) -> Table {
    let mut table = Table::listed(["quantity"], ["periods", "least", "greatest", "last"]);
    for quantity in &replayed.quantities {
        let Quantity {
            name,
            periods,
            least,
            greatest,
            last,
        } = quantity;
        let [least, greatest, last] = [least, greatest, last].map(|value| significant(*value, 4));
        table.row([
            (*name).to_owned(),
            periods.to_string(),
            least,
            greatest,
            last,
        ]);
    }
    table
}
