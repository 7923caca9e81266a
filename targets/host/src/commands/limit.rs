//! `hexagen limit`: the highest speed at which a controller holds the torque.

use super::cut::cut_by;
use super::ran::Ran;
use crate::cli::{Failure, RunArguments, print_json, print_text, spinner, tell_warnings};
use clap::Args;
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::closed_loop::{
    LimitOptions, LimitOutcome, Side, SpeedLimit, TOLERANCE, percent, speed_limit,
};
use hexagen_lab::engine::{Prepared, SelectedMotor};
use hexagen_lab::envelope::{SpeedBounds, envelope_on};
use hexagen_lab::text::significant;
use serde::Serialize;

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

/// Scans for the limit, and for that without the board's window, where there is one.
///
/// # Errors
/// Diagnostics, or a plant option out of range.
pub fn collect(options: &Options) -> Result<(Prepared, SpeedLimit, Option<SpeedLimit>), Failure> {
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
fn scan(arguments: &RunArguments, drive: &Prepared) -> Result<SpeedLimit, Failure> {
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
    let scan = LimitOptions::new(drive.rated_rpm(), torque);
    let progress = spinner("scanning speeds");
    let limit = speed_limit(
        &plant,
        &run,
        &scan,
        drive.maker(arguments.model(), set_point),
    );
    progress.finish_and_clear();
    Ok(limit?)
}

/// Runs the command.
///
/// # Errors
/// As [`collect`], or a drive that tripped above its limit.
pub fn run(options: &Options) -> Result<(), Failure> {
    let (drive, limit, without_window) = collect(options)?;
    let torque = options.run.torque(&drive);
    let envelope = envelope_on(&drive.spec, &options.run.plant.plant(&drive)?);
    let outcome = Outcome {
        ran: Ran::of(&drive, options.run.model()),
        torque_nm: torque,
        bounds: SpeedBounds::of(&envelope, torque),
        limit,
        without_window,
    };
    if options.run.json {
        print_json(&outcome)?;
    } else {
        let v_bus = options.run.plant.v_bus;
        let v_bus = v_bus.unwrap_or(drive.spec.inverter.v_bus);
        print_found(&outcome, &drive, v_bus)?;
    }
    Failure::of_trip(outcome.limit.tripped)
}

fn print_found(outcome: &Outcome, drive: &Prepared, v_bus: f64) -> Result<(), Failure> {
    let told = |limit: &SpeedLimit| found(limit, outcome.torque_nm, drive, v_bus);
    let own = told(&outcome.limit);
    let free = match outcome.without_window.as_ref().map(told) {
        None => String::new(),
        Some(free) if free == own => "; the same with in-phase sensors".to_owned(),
        Some(free) => format!("; with in-phase sensors {free}"),
    };
    let bounds = outcome.bounds.map_or_else(String::new, |bounds| {
        if bounds.envelope_rpm > 0.0 {
            format!(
                "\nHeld: its mean within {:.0} %. The bus drives the whole current up to {} rpm; no profile within its peak gives the torque beyond {} rpm.",
                100.0 * TOLERANCE, bounds.envelope_rpm.floor(), bounds.any_profile_rpm.floor()
            )
        } else {
            "\nThe torque is beyond the drive at every speed.".to_owned()
        }
    });
    print_text(&format!(
        "{}: {} Nm {own}{free}{bounds}",
        outcome.ran.name(),
        significant(outcome.torque_nm, 4),
    ))
}

/// A limit in words, on a bus of `v_bus` volt.
fn found(limit: &SpeedLimit, torque: f64, drive: &Prepared, v_bus: f64) -> String {
    let is_below = limit.lost == Some(Side::Below);
    let cut = is_below.then(|| cut_by(&drive.spec.inverter, torque > 0.0, v_bus, None));
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
