//! `hexagen halls`: the Hall sensors' codes and places, from a log of the shorted motor turned by hand.

use super::replay::{in_log, open_log};
use crate::cli::{DriveArguments, Failure, print_json, print_table, print_text};
use clap::Args;
use hexagen_codegen::spec::{HALL_ANGLES, MotorSpec};
use hexagen_lab::halls::{Halls, find};
use hexagen_lab::report::{Cell, Column, Table};
use hexagen_lab::text::significant;
use serde::Serialize;
use std::path::PathBuf;

/// Options of `halls`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// The drive; of its motor file resistance, inductance and pole pairs count, and of the inverter the sensors.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// CSV with a row per control period, or per `--every`, and a header: `adc_1`, `adc_2`, `adc_3` (counts of the sensed phases in
    /// their order) and `hall`, of the shorted motor while its shaft is turned by hand for some turns. With a column
    /// `call`, the rows from `brake` to the next other call count
    #[arg(long, value_name = "FILE")]
    pub log: PathBuf,
    /// Control periods from a row to the next
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub every: u32,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// What was found, and why the angles are not to be trusted, if so.
#[derive(Serialize)]
struct Told<'h> {
    #[serde(flatten)]
    halls: &'h Halls,
    doubt: Option<String>,
}

/// Edges so far from the stated ones, in degrees, are worth `hall_angles`.
const WORTH_STATING: f64 = 2.0;

/// How far from its place an edge may be stated, degrees.
const FARTHEST: f64 = 20.0;

/// An EMF constant so far from the stated one is told, relative.
const OTHER_MOTOR: f64 = 0.15;

/// An effect of a wrong inductance that is told, degrees.
const WORTH_TELLING: f64 = 0.5;

/// Narrowest over widest current below which gains differ by enough to move edges by a degree.
const LEAST_ROUNDNESS: f64 = 0.97;

/// Distance of the passes of one edge beyond which their mean says little, degrees.
const MOST_SPREAD: f64 = 4.0;

/// Hystereses of Hall sensors, degrees.
const LIKELY_HYSTERESIS: std::ops::RangeInclusive<f64> = -2.0..=20.0;

/// Runs the command.
///
/// # Errors
/// Diagnostics; a log that cannot be read, with the line, or that does not tell the sensors' places.
pub fn run(options: &Options) -> Result<(), Failure> {
    let drive = options.drive.prepare()?;
    let row_time = f64::from(options.every) * drive.spec.inverter.t_s;
    let found = find(&drive, open_log(&options.log)?, row_time)
        .map_err(|error| in_log(&options.log, &error))?;
    if options.json {
        let doubt = doubts(&found);
        return print_json(&Told {
            halls: &found,
            doubt,
        });
    }
    let motor = &drive.spec.motor;
    let [forward, backward] = found.turns;
    print_text(&format!(
        "{}: {forward:.1} electrical turns forward (a, b, c), {backward:.1} backward, at {} rpm in the mean\n",
        drive.motor,
        significant(found.rpm, 3),
    ))?;
    print_table(&table(&found))?;
    print_text(&format!("\n{}", lines(&found, motor).join("\n")))
}

fn table(found: &Halls) -> Table {
    let columns = [
        Column::text("sector"),
        Column::text("code"),
        Column::number("begins at", "deg"),
        Column::number("out of place", "deg"),
        Column::number("hysteresis", "deg"),
        Column::number("spread", "deg"),
        Column::number("passes", ""),
    ];
    let mut table = Table::new("", columns);
    for (place, (edge, code)) in found.edges.iter().zip(found.codes).enumerate() {
        let degrees = |angle: f64| Cell::from(format!("{angle:.1}"));
        table.row([
            Cell::from(format!("S{}", place + 1)),
            Cell::from(format!("{code:03b}")),
            degrees(edge.angle),
            degrees(edge.angle - HALL_ANGLES[place]),
            edge.hysteresis.map_or_else(|| Cell::from("-"), degrees),
            degrees(edge.spread),
            Cell::from(edge.passes.to_string()),
        ]);
    }
    table
}

/// What to write into the motor's file, and what to look at.
fn lines(found: &Halls, motor: &MotorSpec) -> Vec<String> {
    let mut lines = vec![codes(found, motor), places(found, motor)];
    if !found.begins_forward {
        lines.push(
            "the first turn was backward, c before b before a: if you turned the way that shall be forward, exchange two wires of the motor and record again"
                .to_owned(),
        );
    }
    if found.edges.iter().any(|edge| edge.hysteresis.is_none()) {
        lines.push(
            "turned one way only: the angles include the sensors' hysteresis; turn the shaft both ways"
                .to_owned(),
        );
    }
    if found.glitches > 0 {
        lines.push(format!(
            "{} samples had a code that stood for less than three: look at cable and filter, or state `hall_glitches`",
            found.glitches
        ));
    }
    let ratio = found.emf_constant / motor.emf_constant;
    if (ratio - 1.0).abs() > OTHER_MOTOR {
        lines.push(format!(
            "the EMF is {ratio:.2} of the stated one: check `back_emf`, `resistance`, `pole_pairs`, the sensors' gain, `--every`, and whether counts clip"
        ));
    }
    if found.inductance_effect > WORTH_TELLING {
        lines.push(format!(
            "an inductance 30 % off moves all edges by {:.1} deg at this speed: turn slower to be surer",
            found.inductance_effect
        ));
    }
    lines
}

fn codes(found: &Halls, motor: &MotorSpec) -> String {
    let told = format!("hall_codes = {:?}", found.codes);
    if found.codes == motor.hall_codes {
        format!("{told}, as the motor's file says or by default")
    } else {
        format!("{told}, in place of {:?}", motor.hall_codes)
    }
}

/// Why the angles are not to be trusted.
fn doubts(found: &Halls) -> Option<String> {
    let spread = found
        .edges
        .iter()
        .map(|edge| edge.spread)
        .fold(0.0, f64::max);
    let hystereses = || found.edges.iter().filter_map(|edge| edge.hysteresis);
    if found.roundness < LEAST_ROUNDNESS {
        return Some(format!(
            "the currents are {:.0} % as large in one direction as in another: gains of the sensors differ (`adc_gain` as a list), or counts clip, or an offset drifts",
            100.0 * found.roundness
        ));
    }
    if spread > MOST_SPREAD {
        return Some(format!(
            "the passes of an edge lie up to {spread:.0} deg apart: a sensor that chatters, magnets of unlike width, an offset that drifts, counts that clip, or rows that lie not as far apart as `--every` says"
        ));
    }
    let lag = hystereses().find(|lag| !LIKELY_HYSTERESIS.contains(lag))?;
    Some(format!(
        "a hysteresis of {lag:.0} deg: `resistance` or `inductance` is far off, or the rows lie not as far apart as `--every` says"
    ))
}

fn places(found: &Halls, motor: &MotorSpec) -> String {
    if let Some(doubt) = doubts(found) {
        return format!("hall_angles: not to be told from this log; {doubt}");
    }
    let angles = found.edges.map(|edge| edge.angle);
    let farthest = |from: &[f64; 6]| {
        let distances = angles
            .iter()
            .zip(from)
            .map(|(angle, from)| (angle - from).abs());
        distances.fold(0.0, f64::max)
    };
    if farthest(&HALL_ANGLES) > FARTHEST {
        return format!(
            "an edge is {:.0} deg out of its place, of which {FARTHEST} can be stated: the sensors have to be moved",
            farthest(&HALL_ANGLES)
        );
    }
    if farthest(&motor.hall_angles) <= WORTH_STATING {
        return "hall_angles: within 2 deg of what the motor's file says or of the default"
            .to_owned();
    }
    if farthest(&HALL_ANGLES) <= WORTH_STATING {
        return "hall_angles: leave them out, all edges are within 2 deg of their places"
            .to_owned();
    }
    let stated: Vec<String> = angles
        .iter()
        .map(|angle| format!("\"{angle:.0} deg\""))
        .collect();
    format!("hall_angles = [{}]", stated.join(", "))
}
