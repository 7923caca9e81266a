//! Speed of a free shaft, and settling time of a speed loop.

use super::{Aim, Measurement, PeriodRow};
use crate::plant::Mechanics;
use hexagen_codegen::spec::SpeedLoop;
use serde::Serialize;
use std::f64::consts::TAU;

/// Speed of a free shaft, with or without a speed loop; undefined for a drive that tripped.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Speed {
    /// Set-point of the speed loop, rpm; `None` without one.
    pub set_rpm: Option<f64>,
    /// Mean speed over the measured window, rpm; mean over all start angles.
    pub mean_rpm: Option<f64>,
    /// Speed at the end of the measured window, rpm; mean over all start angles.
    pub final_rpm: Option<f64>,
    /// Whether the speed loop has settled: the mean speed of each of the last three sixths of the
    /// measured window is within 2 % of the set-point, at every start angle. (Of a slower set-point than
    /// the start or the lowest measurable speed: within 2 % of the faster of these.) `None` without a
    /// speed loop.
    pub settled: Option<bool>,
}

/// Relative tolerance of a settled speed.
pub const SETTLED: f64 = 0.02;

impl Speed {
    /// The speed of a run. `set_rpm` is the speed loop's set-point, `least_rpm` the speed
    /// to which the tolerance refers where the set-point is slower.
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

/// Settling time in time constants of the speed loop's bandwidth.
const SETTLING_OF_SPEED: f64 = 6.0;

impl Aim {
    /// A target speed in rad/s from another one, and the time to settle there: until the loop's
    /// integral carries the load, that of the run-up with the torque left by the load, and that of
    /// the loop.
    pub fn of(
        speed: &SpeedLoop,
        mechanics: &Mechanics,
        torque: f64,
        (from, to): (f64, f64),
    ) -> Self {
        let torque = torque.abs();
        // A load that takes all of the torque leaves a tenth: such a run shows that the speed is
        // not reached.
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
