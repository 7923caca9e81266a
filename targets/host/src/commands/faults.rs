//! `hexagen faults`: what a drive notices of what may break.

use super::ran::Ran;
use crate::cli::{Bar, Failure, RunArguments, paragraph, print_json, print_table, print_text};
use clap::Args;
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::closed_loop::Cause;
use hexagen_lab::engine::Prepared;
use hexagen_lab::faults::{FaultRow, FaultStudy, Part, Seen, Totals, study};
use hexagen_lab::plant::SHORT_RESISTANCE;
use hexagen_lab::report::{Cell, Column, Label, Table, Tone};
use hexagen_lab::text::significant;
use serde::Serialize;

/// Options of `faults`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor, controller and plant.
    #[command(flatten)]
    pub run: RunArguments,
}

/// A study with its drive.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Motor, controller and model.
    #[serde(flatten)]
    pub ran: Ran,
    /// The study.
    #[serde(flatten)]
    pub study: FaultStudy,
}

/// Breaks everything, one thing at a time.
///
/// # Errors
/// Diagnostics, or an option out of range.
pub fn collect(options: &Options) -> Result<(Prepared, FaultStudy), Failure> {
    let arguments = &options.run;
    let drive = arguments.prepare_for_torque()?;
    let torque = arguments.torque(&drive);
    if torque == 0.0 {
        return Err(Failure::Argument(
            "--torque 0: without current a drive notices little; give a torque that is not 0"
                .to_owned(),
        ));
    }
    if arguments.plant.inertia.is_some() {
        return Err(Failure::Argument(
            "--inertia: faults are tried with the shaft held at its speed; remove it".to_owned(),
        ));
    }
    // Warns of a set-point beyond the limit.
    arguments.plant.set_point(&drive, torque);
    let plant = arguments.plant.options();
    let found = study(&drive, arguments.model(), &plant, torque, &Bar::default());
    let found = found.map_err(|error| arguments.plant.blame(error))?;
    Ok((drive, found))
}

/// Runs the command.
///
/// # Errors
/// As [`collect`].
pub fn run(options: &Options) -> Result<(), Failure> {
    let (drive, study) = collect(options)?;
    let outcome = Outcome {
        ran: Ran::of(&drive, options.run.model()),
        study,
    };
    if options.run.json {
        print_json(&outcome)
    } else {
        print(&outcome, &drive)
    }
}

fn print(outcome: &Outcome, drive: &Prepared) -> Result<(), Failure> {
    let study = &outcome.study;
    let speeds = distinct(study.points.iter().map(|point| point.rpm));
    let torques = distinct(study.points.iter().map(|point| point.torque_nm.abs()));
    print_text(&paragraph(&format!(
        "{}: one thing breaks at a time, at {} rpm with {} Nm, motoring and braking",
        outcome.ran.name(),
        listed(&speeds, |rpm| format!("{rpm:.0}")),
        listed(&torques, |torque| significant(torque, 3)),
    )))?;
    print_text("")?;
    print_table(&table(study))?;
    print_text(&paragraph(&format!(
        "after: from the fault to the sample that trips, median; where nothing is broken, from the start of control on the \
         turning rotor.\npeak: largest true current of a phase or, with a short, of a leg after the fault, over all runs; max_current is {} A, the trip level {} A. \
         A short joins the named terminals of the motor, or one of them and the negative rail, beyond the current sensors. While \
         the upper switch of a named phase works against the lower one of the other, or against the rail, it draws what a bus \
         whose voltage holds drives through {} of switches and cables, until something ends it.\n\
         torque: mean after the fault in percent of the sound drive's, least to greatest of the runs that did not trip; ripple: \
         peak to peak in percent of the same mean, the greatest of these runs. The shaft is held at its speed.",
        significant(study.max_current_a, 3),
        significant(study.trip_current_a, 3),
        engineering(SHORT_RESISTANCE, "ohm"),
    )))?;
    print_text("")?;
    print_text(&paragraph(&verdict(study, drive)))
}

fn table(study: &FaultStudy) -> Table {
    let columns = [
        Column::text("what breaks"),
        Column::number("trips", ""),
        Column::text("by"),
        Column::number("after", "ms"),
        Column::number("peak", "A"),
        Column::number("torque", "%"),
        Column::number("ripple", "%"),
    ];
    let mut table = Table::new("", columns);
    for part in Part::ALL {
        let mut rows = study.of_part(part).peekable();
        if rows.peek().is_none() {
            continue;
        }
        table.group(Label::Above(format!("{}:", part.name()).into()));
        for row in rows {
            table.row(cells(row, study.trip_current_a));
        }
    }
    table
}

fn cells(row: &FaultRow, trip_current: f64) -> [Cell; 7] {
    let tripped = if row.seen == Seen::Untried {
        "untried".to_owned()
    } else {
        format!("{} of {}", row.tripped, row.runs)
    };
    let is_tried = row.seen != Seen::Untried;
    [
        row.fault.as_str().into(),
        Cell::from(tripped).toned(tone(row, trip_current)),
        causes(row).into(),
        row.after_ms
            .map_or_else(|| "-".to_owned(), |ms| format!("{ms:.1}"))
            .into(),
        significant(Some(row.largest_a).filter(|_| is_tried), 3).into(),
        row.torque_pct.map_or_else(|| "-".to_owned(), range).into(),
        row.ripple_pp_pct
            .map_or_else(|| "-".to_owned(), |ripple| format!("{ripple:.0}"))
            .into(),
    ]
}

/// A range in whole numbers; one number where both ends round to it.
fn range(ends: [f64; 2]) -> String {
    // No minus sign before a zero.
    let [least, greatest] = ends.map(|x| x.round() as i64);
    if least == greatest {
        least.to_string()
    } else {
        format!("{least} to {greatest}")
    }
}

/// What tripped the drive, with the number of runs where they differ.
fn causes(row: &FaultRow) -> String {
    let causes: Vec<String> = match row.causes[..] {
        [one] => vec![cause(one.cause).to_owned()],
        ref several => {
            let each = several.iter();
            each.map(|known| format!("{} {}", cause(known.cause), known.runs))
                .collect()
        }
    };
    let causes = causes.join(",\n");
    if row.is_false_alarm() {
        format!("false alarm:\n{causes}")
    } else {
        causes
    }
}

fn cause(cause: Cause) -> &'static str {
    match cause {
        Cause::AdcRange => "ADC range",
        Cause::OverCurrent => "over-current",
        Cause::Hall => "Hall code",
        Cause::Stall => "stall",
        Cause::Offset => "offset",
        Cause::OverVoltage => "over-voltage",
        Cause::UnderVoltage => "under-voltage",
        Cause::Residual => "residual",
        Cause::CurrentSum => "current sum",
        Cause::OverSpeed => "over-speed",
    }
}

fn tone(row: &FaultRow, trip_current: f64) -> Tone {
    if row.part == Part::Sound {
        return if row.is_false_alarm() {
            Tone::Broken
        } else {
            Tone::None
        };
    }
    match row.seen {
        Seen::Always | Seen::Untried => Tone::None,
        _ if row.passes_unseen(trip_current) => Tone::Broken,
        Seen::Sometimes => Tone::Slight,
        Seen::Never => Tone::Marked,
    }
}

/// What the counts mean for the board.
const HARDWARE: &str = "The drive watches ADC range, trip level, Hall codes, a measured bus and, where told to, whether the rotor stands or turns too fast and whether the currents follow the voltages. Against what shows in none of them the \
    board needs hardware: a comparator of the current on the timer's break input, a watchdog on the control interrupt and a \
    thermal limit.";

/// The counts, and what follows for the board.
fn verdict(study: &FaultStudy, drive: &Prepared) -> String {
    let Totals {
        classes,
        always,
        sometimes,
        never,
        untried,
        beyond_trip_unseen,
        sound,
        false_alarms,
    } = study.totals;
    let mut lines = vec![format!(
        "Of {classes} faults the drive notices {always} in every run, {sometimes} in some, {never} in none; \
         sound drives that trip: {false_alarms} of {sound}."
    )];
    if untried > 0 {
        lines.push(format!(
            "{untried} faults are untried: the sound drive trips before, at every operating point."
        ));
    }
    if beyond_trip_unseen > 0 {
        let broken = study.rows.iter().filter(|row| row.part != Part::Sound);
        let largest = broken.filter_map(|row| row.unseen_largest_a);
        lines.push(format!(
            "{beyond_trip_unseen} faults let the true current pass the trip level without a trip, up to {} A.",
            significant(largest.reduce(f64::max), 3)
        ));
    }
    if drive.bus_counts(0.0).is_some() {
        lines.push(
            "A bus that is no longer measured trips nothing: `status().bus_is_stale` tells it."
                .to_owned(),
        );
    }
    if study.stall_timeout_s.is_none() {
        lines.push("Stall detection is off: `stall_timeout` in [inverter] turns it on.".to_owned());
    }
    if study.residual_timeout_s.is_none() {
        lines.push(
            "Currents that do not follow the voltages trip nothing: the option `residual_timeout` turns that on where the controller has `emf: observer`."
                .to_owned(),
        );
    }
    if study.over_speed_rpm.is_none() {
        lines
            .push("The speed is not watched: `over_speed` in [inverter] turns that on.".to_owned());
    }
    if drive.left_out.is_some() {
        lines.push(
            "The drive's speed loop was left out, so that the torque is that of each run; its stall time-out was not."
                .to_owned(),
        );
    }
    lines.push(HARDWARE.to_owned());
    lines.join("\n")
}

/// Values without their repetitions, in their order.
fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

fn listed(values: &[f64], text: impl Fn(f64) -> String) -> String {
    let texts: Vec<String> = values.iter().map(|&value| text(value)).collect();
    texts.join(" and ")
}
