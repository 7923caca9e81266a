//! The constant-torque speed limit: the lowest speed at which the mean torque differs from the
//! demand.
//!
//! Simulates the grid's speeds from the lowest upward, in blocks that run in parallel; stops after
//! the first block with a crossing.

use super::measure::mean_torque;
use super::{CurrentLoop, RunOptions, Trip};
use crate::plant::{PlantError, PlantParams, Truth};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Tolerance of the torque, relative to the demand.
pub const TOLERANCE: f64 = 0.03;

/// Criterion for a mean torque that is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Held {
    /// Within [`TOLERANCE`] of the demand, on either side.
    Within,
    /// At least the demand minus [`TOLERANCE`], however much more: the criterion of the paper and
    /// of the design document's table.
    AtLeast,
}

/// The side of the demand on which the torque is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Less torque than demanded, or against it.
    Below,
    /// More than demanded.
    Above,
}

impl Side {
    /// Text for reports.
    pub fn text(self) -> &'static str {
        match self {
            Self::Below => "torque below the demand",
            Self::Above => "torque above the demand",
        }
    }

    /// The limit of [`TOLERANCE`] on this side, relative to the demand.
    pub fn edge(self) -> f64 {
        self.edge_of(TOLERANCE)
    }

    /// The limit of a tolerance on this side, both relative to the demand.
    fn edge_of(self, tolerance: f64) -> f64 {
        match self {
            Self::Below => 1.0 - tolerance,
            Self::Above => 1.0 + tolerance,
        }
    }
}

impl Held {
    /// The sides on which the torque can be lost.
    pub fn sides(self) -> &'static [Side] {
        match self {
            Self::Within => &[Side::Below, Side::Above],
            Self::AtLeast => &[Side::Below],
        }
    }

    /// The side on which a mean torque is lost; `None` if it is held. Both torques in the same
    /// unit, with their signs.
    pub fn lost(self, torque: f64, demand: f64) -> Option<Side> {
        self.lost_beyond(torque, demand, TOLERANCE)
    }

    fn lost_beyond(self, torque: f64, demand: f64, tolerance: f64) -> Option<Side> {
        let share = torque / demand;
        let is_lost = |side: &&Side| match side {
            // NaN is not held.
            Side::Below => share.is_nan() || share < side.edge_of(tolerance),
            Side::Above => share > side.edge_of(tolerance),
        };
        self.sides().iter().find(is_lost).copied()
    }
}

/// The grid of a scan. Speeds are magnitudes; the direction is that of the run's speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitOptions {
    /// Rated speed in rpm, positive: what `limit_pct` refers to.
    pub rated_rpm: f64,
    /// Demanded torque in newton metres, with its sign.
    pub torque: f64,
    /// Criterion for a mean torque that is held.
    pub held: Held,
    /// First speed of the grid in rpm. The default is 20 % of rated speed: a controller that fails
    /// below it, where the EMF is far below the bus voltage, fails at 20 %, too.
    pub from_rpm: f64,
    /// Last speed in rpm; the default is 160 % of rated speed.
    pub to_rpm: f64,
    /// Step in rpm; the default is 20.
    pub step_rpm: f64,
    /// Least tolerance of the torque, Nm, where [`TOLERANCE`] of the demand is less: an ADC count's, say. The default is 0.
    #[serde(skip)]
    pub least: f64,
}

impl LimitOptions {
    /// The standard grid for a rated speed in rpm and a demanded torque in newton metres.
    pub fn new(rated_rpm: f64, torque: f64) -> Self {
        Self {
            rated_rpm,
            torque,
            held: Held::Within,
            from_rpm: 0.2 * rated_rpm,
            to_rpm: 1.6 * rated_rpm,
            step_rpm: 20.0,
            least: 0.0,
        }
    }

    /// Tolerance of the torque, relative to the demand.
    pub fn tolerance(&self) -> f64 {
        TOLERANCE.max(self.least / self.torque.abs())
    }

    fn lost(&self, torque: f64) -> Option<Side> {
        self.held.lost_beyond(torque, self.torque, self.tolerance())
    }
}

/// Outcome of a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LimitOutcome {
    /// The torque is held up to `limit_rpm`.
    Found,
    /// The torque is not held at the first speed of the grid: no limit is reported.
    NeverHeld,
    /// The torque is held up to the last speed, which `limit_rpm` reports as a lower bound.
    NotReached,
}

/// The constant-torque speed limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpeedLimit {
    /// First crossing of the tolerance's limit in rpm (a magnitude), linearly interpolated; for a
    /// drive that tripped, the last speed at which the torque was held; `None` if never held.
    pub limit_rpm: Option<f64>,
    /// The same in percent of rated speed.
    pub limit_pct: Option<f64>,
    /// Outcome of the scan.
    pub outcome: LimitOutcome,
    /// The side on which the torque was lost at the last speed; `None` if it was held, or the drive
    /// tripped.
    pub lost: Option<Side>,
    /// Trip of the drive at the last speed.
    pub tripped: Option<Trip>,
    /// The scanned torque-speed curve: rpm and mean torque in newton metres, without speeds at
    /// which the drive tripped.
    pub curve: Vec<(f64, f64)>,
}

impl SpeedLimit {
    /// Text for reports: how the torque was lost at the last speed; `None` if it was held.
    pub fn why(&self) -> Option<String> {
        let trip = self.tripped;
        let trips = trip.map(|trip| format!("the drive trips at {:.0} rpm", trip.rpm.abs()));
        trips.or_else(|| self.lost.map(|side| side.text().to_owned()))
    }
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

/// Like [`speed_limit`], with known mean torques (rpm, newton metres) from the same starts, which
/// are not simulated again.
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
    let mut curve: Vec<(f64, f64)> = Vec::with_capacity(speeds.len());
    // Longer blocks would only simulate more speeds beyond the crossing.
    let block = rayon::current_num_threads();
    for speeds in speeds.chunks(block) {
        let torques = speeds
            .par_iter()
            .map(|rpm| {
                if let Some(torque) = measured(*rpm) {
                    return Ok(Ok(torque));
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
        for (&rpm, measured) in speeds.iter().zip(torques) {
            let before: Option<(f64, f64)> = curve.last().copied();
            let lost = match measured {
                Ok(torque) => {
                    curve.push((rpm, torque));
                    let Some(side) = options.lost(torque) else {
                        continue;
                    };
                    Ok((side, torque / options.torque))
                }
                Err(trip) => Err(trip),
            };
            let limit = before.map(|(rpm_before, torque_before)| match lost {
                Ok((side, share)) => {
                    let share_before = torque_before / options.torque;
                    let part =
                        (side.edge_of(options.tolerance()) - share_before) / (share - share_before);
                    rpm_before + (rpm - rpm_before) * part
                }
                // A tripped drive has no torque to interpolate with.
                Err(_) => rpm_before,
            });
            return Ok(SpeedLimit {
                limit_rpm: limit,
                limit_pct: limit.map(|rpm| 100.0 * rpm / options.rated_rpm),
                outcome: match limit {
                    Some(_) => LimitOutcome::Found,
                    None => LimitOutcome::NeverHeld,
                },
                lost: lost.ok().map(|(side, _)| side),
                tripped: lost.err(),
                curve,
            });
        }
    }
    let last = curve.last().map(|point| point.0);
    Ok(SpeedLimit {
        limit_rpm: last,
        limit_pct: last.map(|rpm| 100.0 * rpm / options.rated_rpm),
        outcome: LimitOutcome::NotReached,
        lost: None,
        tripped: None,
        curve,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_torque_is_held_within_its_least_tolerance() {
        let scan = |torque: f64| LimitOptions {
            least: 0.05,
            ..LimitOptions::new(1000.0, torque)
        };
        assert_eq!(scan(1.0).lost(0.951), None);
        assert_eq!(scan(1.0).lost(0.949), Some(Side::Below));
        assert_eq!(scan(-1.0).lost(-1.051), Some(Side::Above));
        assert_eq!(scan(2.0).tolerance(), TOLERANCE);
    }

    #[test]
    fn a_torque_is_held_within_three_percent_on_either_side() {
        for (torque, within, at_least) in [
            (2.0, None, None),
            (1.95, None, None),
            (2.05, None, None),
            (1.93, Some(Side::Below), Some(Side::Below)),
            (2.07, Some(Side::Above), None),
            (5.64, Some(Side::Above), None),
            (-2.0, Some(Side::Below), Some(Side::Below)),
            (f64::NAN, Some(Side::Below), Some(Side::Below)),
        ] {
            for sign in [1.0, -1.0] {
                let lost = |held: Held| held.lost(sign * torque, sign * 2.0);
                assert_eq!(lost(Held::Within), within, "{torque}");
                assert_eq!(lost(Held::AtLeast), at_least, "{torque}");
            }
        }
    }
}
