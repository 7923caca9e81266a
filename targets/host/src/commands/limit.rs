//! `hexagen limit`: the highest speed at which a controller holds the torque.

use super::cut::{cut_by, followed};
use super::ran::Ran;
use crate::cli::{
    Failure, RunArguments, paragraph, print_json, print_text, spinner, tell_warnings,
};
use clap::Args;
use hexagen_codegen::diagnostics::engineering;
use hexagen_codegen::spec::Envelope;
use hexagen_lab::closed_loop::{
    LimitOptions, LimitOutcome, RunOptions, Side, SpeedLimit, TOLERANCE, measure, percent,
    speed_limit,
};
use hexagen_lab::engine::{Prepared, SelectedMotor};
use hexagen_lab::envelope::{SpeedBounds, envelope_on};
use hexagen_lab::text::significant;
use serde::Serialize;
use std::f64::consts::TAU;

/// Options of `limit`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor, controller and plant.
    #[command(flatten)]
    pub run: RunArguments,
}

/// A speed limit with its run. A torque is held while its mean is within [`TOLERANCE`] of the demand.
#[derive(Clone, Debug, Serialize)]
pub struct Outcome {
    /// Motor, controller and model.
    #[serde(flatten)]
    pub ran: Ran,
    /// Torque demand, Nm.
    pub torque_nm: f64,
    /// The limit.
    #[serde(flatten)]
    pub limit: SpeedLimit,
    /// What bounds the limit of a motoring torque.
    #[serde(flatten)]
    pub bounds: Option<SpeedBounds>,
    /// The limit of the same drive with sensors in the phases and legs that may be high all the time;
    /// none where the board limits no leg.
    pub without_window: Option<SpeedLimit>,
}

/// A scan of a drive.
struct Scan {
    limit: SpeedLimit,
    /// Mean current drawn from the bus at the last speed, ampere, where that is limited and torque is lost.
    bus_current: Option<f64>,
}

/// Scans for the limit, and for that without the board's window, where there is one.
///
/// # Errors
/// Diagnostics, or a plant option out of range.
fn collect(options: &Options) -> Result<(Prepared, Scan, Option<Scan>), Failure> {
    let arguments = &options.run;
    let motor = SelectedMotor::find(&arguments.motor, &arguments.plant.options())?;
    let drive = motor.prepare_for_torque(arguments.controller.as_deref())?;
    tell_warnings(&drive);
    // Warns of a torque beyond the drive, once for both scans.
    arguments.plant.set_point(&drive, arguments.torque(&drive));
    let limit = scan(arguments, &drive)?;
    let inverter = &drive.spec.inverter;
    let has_window = inverter.window().is_some() || inverter.minimum_low_time > 0.0;
    let free = if has_window {
        let free = motor.without_window()?;
        let free = free.prepare_for_torque(arguments.controller.as_deref())?;
        Some(scan(arguments, &free)?)
    } else {
        None
    };
    Ok((drive, limit, free))
}

/// The limit of a drive.
fn scan(arguments: &RunArguments, drive: &Prepared) -> Result<Scan, Failure> {
    let torque = arguments.torque(drive);
    if torque == 0.0 {
        return Err(Failure::Argument(
            "--torque 0: the limit needs a torque; give one that is not 0".to_owned(),
        ));
    }
    if arguments.plant.inertia.is_some() {
        return Err(Failure::Argument(
            "--inertia: the limit is measured at fixed speeds; remove it".to_owned(),
        ));
    }
    let plant = arguments.plant.plant(drive)?;
    let run = arguments.plant.options().run(drive, 1.0, torque);
    let set_point = arguments.plant.options().set_point(drive, torque);
    let scan = LimitOptions {
        least: torque_of_count(drive),
        ..LimitOptions::new(drive.rated_rpm(), torque)
    };
    let progress = spinner("scanning speeds");
    let maker = drive.maker(arguments.model(), set_point);
    let limit = speed_limit(&plant, &run, &scan, &maker)?;
    let last = limit.curve.last().filter(|_| {
        let limits = drive.spec.inverter.bus_currents;
        let is_limited = limits.drawn.or(limits.returned).is_some();
        is_limited && limit.lost == Some(Side::Below)
    });
    let at_last = last.map(|(rpm, _)| {
        let omega_m = rpm * TAU / 60.0;
        measure(&plant, &RunOptions { omega_m, ..run }, &maker)
    });
    progress.finish_and_clear();
    let bus_current = at_last.transpose()?.and_then(|at| at.figures.bus_current_a);
    Ok(Scan { limit, bus_current })
}

/// Torque of an ADC count, Nm: a demand of few counts is held no better.
fn torque_of_count(drive: &Prepared) -> f64 {
    let per_ampere = Envelope::of(&drive.spec).torque_constant();
    drive.spec.inverter.adc_gain.abs() * per_ampere
}

/// When a torque counts as held, and up to where the drive follows the rotor.
fn criterion(drive: &Prepared, torque: f64) -> String {
    let count = torque_of_count(drive);
    if count > TOLERANCE * torque.abs() {
        format!(
            "Held: its mean within an ADC count of the current, {}",
            engineering(count, "Nm")
        )
    } else {
        format!("Held: its mean within {:.0} %", 100.0 * TOLERANCE)
    }
}

/// Runs the command.
///
/// # Errors
/// What cannot be read or simulated, or a drive that tripped above its limit.
pub fn run(options: &Options) -> Result<(), Failure> {
    let (drive, own, free) = collect(options)?;
    let torque = options.run.torque(&drive);
    let envelope = envelope_on(&drive.spec, &options.run.plant.plant(&drive)?);
    let v_bus = options.run.plant.v_bus;
    let v_bus = v_bus.unwrap_or(drive.spec.inverter.v_bus);
    let told = |scan: &Scan| found(scan, torque, &drive, v_bus);
    let texts = (told(&own), free.as_ref().map(told));
    let outcome = Outcome {
        ran: Ran::of(&drive, options.run.model()),
        torque_nm: torque,
        bounds: SpeedBounds::of(&envelope, torque),
        limit: own.limit,
        without_window: free.map(|free| free.limit),
    };
    if options.run.json {
        print_json(&outcome)?;
    } else {
        print_found(&outcome, &drive, texts)?;
    }
    Failure::of_trip(outcome.limit.tripped)
}

/// Prints the limit; `texts` say it in words, with that without the board's window.
fn print_found(
    outcome: &Outcome,
    drive: &Prepared,
    (own, free): (String, Option<String>),
) -> Result<(), Failure> {
    let free = match free {
        None => String::new(),
        Some(free) if free == own => "; the same with in-phase sensors".to_owned(),
        Some(free) => format!("; with in-phase sensors {free}"),
    };
    let bounds = outcome.bounds.map_or_else(String::new, |bounds| {
        if bounds.envelope_rpm > 0.0 {
            let (lasts, why) = followed(drive, bounds.envelope_rpm);
            format!(
                "\n{}. The bus drives the whole current up to {} rpm{}; no profile within its peak gives the torque beyond {} rpm.",
                criterion(drive, outcome.torque_nm),
                lasts.floor(),
                why.unwrap_or_default(),
                bounds.any_profile_rpm.floor()
            )
        } else {
            "\nThe torque is beyond the drive at every speed.".to_owned()
        }
    });
    print_text(&paragraph(&format!(
        "{}: {} Nm {own}{free}{bounds}",
        outcome.ran.name(),
        significant(outcome.torque_nm, 4),
    )))
}

/// A limit in words, on a bus of `v_bus` volt.
fn found(scan: &Scan, torque: f64, drive: &Prepared, v_bus: f64) -> String {
    let Scan { limit, bus_current } = scan;
    let is_below = limit.lost == Some(Side::Below);
    let cut = is_below.then(|| cut_by(&drive.spec.inverter, torque > 0.0, v_bus, *bus_current));
    let cut = cut.flatten().map(|cut| format!(", with {cut}"));
    let why = limit.why().unwrap_or_default() + &cut.unwrap_or_default();
    match (limit.outcome, limit.limit_rpm, limit.limit_pct) {
        (LimitOutcome::NeverHeld, _, _) | (_, None, _) | (_, _, None) => {
            let reach = drive.reach();
            let limited = if reach < torque.abs() {
                format!(
                    "; a max_current of {} limits the set-point to {} Nm",
                    engineering(drive.spec.inverter.max_current, "A"),
                    significant(reach, 3)
                )
            } else {
                String::new()
            };
            let found = limit.curve.first().map_or(String::new(), |point| {
                let share = percent(point.1, torque, 0.0);
                format!(" ({} % of it at {:.0} rpm)", significant(share, 3), point.0)
            });
            format!("not held even at the first speed: {why}{found}{limited}")
        }
        (LimitOutcome::Found, Some(rpm), Some(percent)) => {
            format!("held up to {rpm:.0} rpm, {percent:.1} % of rated speed; beyond, {why}")
        }
        (LimitOutcome::NotReached, Some(rpm), Some(percent)) => {
            format!("held beyond {rpm:.0} rpm, {percent:.1} % of rated speed, where the scan ends")
        }
    }
}
