//! Speed of a free shaft, and the time that a speed loop needs to reach its set-point.

use super::{Aim, Measurement, PeriodRow};
use crate::plant::Mechanics;
use hexagen_codegen::spec::SpeedLoop;
use serde::Serialize;
use std::f64::consts::TAU;

/// Speed of a free shaft, with or without a speed loop; nothing for a drive that tripped.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Speed {
    /// Set-point of the speed loop, rpm; none without one.
    pub set_rpm: Option<f64>,
    /// Mean speed over the measured window, rpm; mean over all start angles.
    pub mean_rpm: Option<f64>,
    /// Speed at the end of the measured window, rpm; mean over all start angles.
    pub final_rpm: Option<f64>,
    /// Whether the speed loop has settled: the mean speed of each of the last three sixths of the
    /// measured window is within 2 % of the set-point, at every start angle. (Below the least speed
    /// that the drive tells from standstill: within 2 % of that speed.) None without a speed loop.
    pub settled: Option<bool>,
}

/// Distance of a settled speed from the set one, in parts of it.
pub const SETTLED: f64 = 0.02;

impl Speed {
    /// The speed of a run. `set_rpm` is the speed loop's, `least_rpm` the least speed
    /// that the drive tells from standstill.
    pub fn of(measured: &Measurement, set_rpm: Option<f64>, least_rpm: f64) -> Self {
        let traces = match measured.tripped {
            None => &measured.traces[..],
            Some(_) => &[],
        };
        let has_run = !traces.is_empty();
        let over_starts = |speed: &dyn Fn(&[PeriodRow]) -> f64| {
            let sum: f64 = traces.iter().map(|trace| speed(&trace.periods)).sum();
            has_run.then(|| sum / traces.len() as f64)
        };
        let has_settled = |set: f64| {
            let distance = SETTLED * set.abs().max(least_rpm);
            let mut parts = traces.iter().flat_map(|trace| {
                let sixth = trace.periods.len().div_ceil(6);
                trace.periods.rchunks(sixth.max(1)).take(3)
            });
            parts.all(|rows| (mean_rpm(rows) - set).abs() <= distance)
        };
        Self {
            set_rpm,
            mean_rpm: over_starts(&mean_rpm),
            final_rpm: over_starts(&|rows| mean_rpm(&rows[rows.len().saturating_sub(1)..])),
            settled: set_rpm.filter(|_| has_run).map(has_settled),
        }
    }
}

/// Mean speed of periods, rpm.
fn mean_rpm(rows: &[PeriodRow]) -> f64 {
    rows.iter().map(|row| row.omega_m).sum::<f64>() / rows.len() as f64 * 60.0 / TAU
}

/// Time constants of the speed loop's bandwidth in which it settles.
const SETTLING_OF_SPEED: f64 = 6.0;

impl Aim {
    /// A mechanical speed in rad/s to be reached from another, and the time for it: until the loop's integral bears the
    /// load, that of the run-up at the torque that the load leaves, and that of the loop.
    pub fn of(
        speed: &SpeedLoop,
        mechanics: &Mechanics,
        torque: f64,
        (from, to): (f64, f64),
    ) -> Self {
        let torque = torque.abs();
        // A load that takes all of the torque leaves a tenth: such a run shows that the speed is not reached.
        let free = (torque - mechanics.opposing_torque).max(torque / 10.0);
        let bandwidth = TAU * speed.bandwidth;
        let bearing = if to == 0.0 {
            0.0
        } else {
            let rate = bandwidth * bandwidth * speed.inertia * to.abs() / 4.0;
            mechanics.opposing_torque.min(torque) / rate
        };
        let run_up = (to - from).abs() * mechanics.inertia / free;
        Self {
            omega_m: to,
            within: bearing + run_up + SETTLING_OF_SPEED / speed.bandwidth,
        }
    }
}
