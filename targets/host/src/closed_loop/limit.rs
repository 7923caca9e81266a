//! The constant-torque speed limit: where the mean torque first falls below 97 % of the demand.
//!
//! Every speed of the grid is simulated from the lowest upward, in blocks that run in parallel;
//! the scan stops after the first block with a crossing. No speed below the crossing is skipped,
//! so it is the first one of the grid.

use super::measure::mean_torque;
use super::{CurrentLoop, RunOptions, Trip};
use crate::plant::{PlantError, PlantParams, Truth};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Fraction of the demanded torque that counts as held.
pub const HELD: f64 = 0.97;

/// The grid of a scan. Speeds are magnitudes; the direction is that of the run's speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitOptions {
    /// Rated speed in rpm, positive: what `limit_pct` refers to.
    pub rated_rpm: f64,
    /// Demanded torque in newton metres, with its sign.
    pub torque: f64,
    /// First speed of the grid in rpm. The default is 20 % of rated speed: below it the EMF is far
    /// from the bus voltage, so a controller that fails there fails at the first point too.
    pub from_rpm: f64,
    /// Last speed in rpm; the default is 160 % of rated speed.
    pub to_rpm: f64,
    /// Step in rpm; the default is 20.
    pub step_rpm: f64,
}

impl LimitOptions {
    /// The standard grid for a rated speed in rpm and a demanded torque in newton metres.
    pub fn new(rated_rpm: f64, torque: f64) -> Self {
        Self {
            rated_rpm,
            torque,
            from_rpm: 0.2 * rated_rpm,
            to_rpm: 1.6 * rated_rpm,
            step_rpm: 20.0,
        }
    }
}

/// How a scan ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitOutcome {
    /// The torque was held up to `limit_rpm`.
    Found,
    /// The torque was not held at the first speed of the grid: there is no limit to report.
    NeverHeld,
    /// The torque was held up to the last speed, which `limit_rpm` reports as a lower bound.
    NotReached,
}

/// The constant-torque speed limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedLimit {
    /// First crossing in rpm (a magnitude), linearly interpolated; none if never held.
    pub limit_rpm: Option<f64>,
    /// The same in percent of rated speed.
    pub limit_pct: Option<f64>,
    /// How the scan ended.
    pub outcome: LimitOutcome,
    /// Why the torque was not held at the speed that ended the scan, if the controller tripped there.
    pub tripped: Option<Trip>,
    /// The torque-speed curve as far as it was scanned: rpm and mean torque in newton metres.
    pub curve: Vec<(f64, f64)>,
}

/// Finds the speed limit of a controller. `run` gives the starts, delay and direction of rotation
/// (its speed's sign); `make` builds a controller with its set-point for a plant at the speed of
/// the given initial state.
///
/// # Errors
/// A plant parameter outside its range.
pub fn speed_limit<C, F>(
    params: &PlantParams,
    run: &RunOptions,
    options: &LimitOptions,
    make: F,
) -> Result<SpeedLimit, PlantError>
where
    C: CurrentLoop,
    F: Fn(&Truth) -> C + Sync,
{
    speed_limit_knowing(params, run, options, &[], make)
}

/// As [`speed_limit`], with the mean torque (rpm, newton metres) of speeds that were measured
/// already from the same starts: they are not simulated again.
///
/// # Errors
/// As [`speed_limit`].
pub fn speed_limit_knowing<C, F>(
    params: &PlantParams,
    run: &RunOptions,
    options: &LimitOptions,
    known: &[(f64, f64)],
    make: F,
) -> Result<SpeedLimit, PlantError>
where
    C: CurrentLoop,
    F: Fn(&Truth) -> C + Sync,
{
    let measured = |rpm: f64| {
        let same = |point: &&(f64, f64)| (point.0 - rpm).abs() < 1e-9 * options.rated_rpm;
        known.iter().find(same).map(|point| point.1)
    };
    let steps = ((options.to_rpm - options.from_rpm) / options.step_rpm)
        .floor()
        .max(0.0) as usize;
    let speeds: Vec<f64> = (0..=steps)
        .map(|k| options.from_rpm + k as f64 * options.step_rpm)
        .collect();
    let held = |torque: f64| torque / options.torque >= HELD;
    let mut curve: Vec<(f64, f64)> = Vec::with_capacity(speeds.len());
    // Longer blocks would only simulate more speeds beyond the crossing.
    let block = rayon::current_num_threads();
    for speeds in speeds.chunks(block) {
        let torques = speeds
            .par_iter()
            .map(|rpm| {
                if let Some(torque) = measured(*rpm) {
                    return Ok((torque, None));
                }
                let omega_m = (rpm * TAU / 60.0).copysign(run.omega_m);
                mean_torque(
                    params,
                    &RunOptions {
                        omega_m,
                        ..run.clone()
                    },
                    &make,
                )
            })
            .collect::<Result<Vec<_>, _>>()?;
        for (&rpm, (torque, tripped)) in speeds.iter().zip(torques) {
            let before = curve.last().copied();
            curve.push((rpm, torque));
            if held(torque) {
                continue;
            }
            let (limit, outcome) = match before {
                None => (None, LimitOutcome::NeverHeld),
                Some((rpm_before, torque_before)) => {
                    let excess = torque_before / options.torque - HELD;
                    let lack = HELD - torque / options.torque;
                    (
                        Some(rpm_before + (rpm - rpm_before) * excess / (excess + lack)),
                        LimitOutcome::Found,
                    )
                }
            };
            return Ok(report(limit, options, (outcome, tripped), curve));
        }
    }
    let last = curve.last().map(|point| point.0);
    let outcome = (LimitOutcome::NotReached, None);
    Ok(report(last, options, outcome, curve))
}

fn report(
    limit: Option<f64>,
    options: &LimitOptions,
    (outcome, tripped): (LimitOutcome, Option<Trip>),
    curve: Vec<(f64, f64)>,
) -> SpeedLimit {
    let limit_pct = limit.map(|rpm| 100.0 * rpm / options.rated_rpm);
    SpeedLimit {
        limit_rpm: limit,
        limit_pct,
        outcome,
        tripped,
        curve,
    }
}
