//! Speed of a free shaft, settling time of a speed loop, and its answer to a step of the load.

use super::{Aim, LoadStep, Measurement, PeriodRow, RunOptions, Trace};
use crate::plant::Mechanics;
use hexagen_codegen::spec::SpeedLoop;
use serde::Serialize;
use std::f64::consts::TAU;

/// Speed of a free shaft, with or without a speed loop; undefined for a drive that tripped.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Speed {
    /// Set-point of the speed loop, rpm; `None` without one.
    pub set_rpm: Option<f64>,
    /// Mean speed over the measured window up to a load step, rpm; mean over all start angles.
    pub mean_rpm: Option<f64>,
    /// Speed at the end of the measured window, rpm; mean over all start angles.
    pub final_rpm: Option<f64>,
    /// Whether the speed loop has settled: the mean speed of each of the last three sixths of that
    /// window is within 2 % of the set-point, at every start angle. (Of a slower set-point than
    /// the start or the lowest measurable speed: within 2 % of the faster of these, but no further than half
    /// of the set-point: a rotor that stands has not settled.) `None` without a speed loop.
    pub settled: Option<bool>,
}

/// Relative tolerance of a settled speed.
pub const SETTLED: f64 = 0.02;

/// Distance from a set-point that counts as settled, rpm.
fn tolerance(set_rpm: f64, least_rpm: f64) -> f64 {
    let distance = SETTLED * set_rpm.abs().max(least_rpm);
    if set_rpm == 0.0 {
        distance
    } else {
        distance.min(0.5 * set_rpm.abs())
    }
}

/// The records of a run that did not trip.
fn records(measured: &Measurement) -> &[Trace] {
    match measured.tripped {
        None => &measured.traces,
        Some(_) => &[],
    }
}

/// The periods before and after the load step of a run; without one all are before.
fn around_step<'t>(run: &RunOptions, trace: &'t Trace) -> (&'t [PeriodRow], &'t [PeriodRow]) {
    let rows = &trace.periods;
    rows.split_at(run.before_step(rows.len()))
}

impl Speed {
    /// The speed of a `run`. `set_rpm` is the speed loop's set-point, `least_rpm` the speed
    /// to which the tolerance refers where the set-point is slower.
    pub fn of(
        measured: &Measurement,
        run: &RunOptions,
        set_rpm: Option<f64>,
        least_rpm: f64,
    ) -> Self {
        let traces = records(measured);
        let has_run = !traces.is_empty();
        let over_starts = |speed: &dyn Fn(&Trace) -> f64| {
            let sum: f64 = traces.iter().map(speed).sum();
            has_run.then(|| sum / traces.len() as f64)
        };
        let has_settled = |set: f64| {
            let mut parts = traces.iter().flat_map(|trace| {
                let (rows, _) = around_step(run, trace);
                rows.rchunks(rows.len().div_ceil(6).max(1)).take(3)
            });
            parts.all(|rows| (mean_rpm(rows) - set).abs() <= tolerance(set, least_rpm))
        };
        Self {
            set_rpm,
            mean_rpm: over_starts(&|trace| mean_rpm(around_step(run, trace).0)),
            final_rpm: over_starts(&|trace| {
                let rows = &trace.periods;
                mean_rpm(&rows[rows.len().saturating_sub(1)..])
            }),
            settled: set_rpm.filter(|_| has_run).map(has_settled),
        }
    }
}

/// What a step of the load does to a regulated speed; the worst of all start angles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadResponse {
    /// Greatest loss of speed below the set-point, rpm.
    pub dip_rpm: f64,
    /// Greatest excess over the set-point after the deepest dip, rpm.
    pub overshoot_rpm: f64,
    /// Time from the step until the speed stays settled, millisecond; 0 where it never leaves that range,
    /// none where the record ends before.
    pub recovery_ms: Option<f64>,
}

impl LoadResponse {
    /// That of a `run` with a load step; none of a run without one, or that tripped.
    pub fn of(
        measured: &Measurement,
        run: &RunOptions,
        set_rpm: f64,
        least_rpm: f64,
    ) -> Option<Self> {
        run.load_step?;
        let within = tolerance(set_rpm, least_rpm);
        let responses = records(measured).iter().map(|trace| {
            let (_, after) = around_step(run, trace);
            Self::of_rows(after, set_rpm, within)
        });
        responses.reduce(|one, other| Self {
            dip_rpm: one.dip_rpm.max(other.dip_rpm),
            overshoot_rpm: one.overshoot_rpm.max(other.overshoot_rpm),
            recovery_ms: one
                .recovery_ms
                .zip(other.recovery_ms)
                .map(|(one, other)| one.max(other)),
        })
    }

    /// That of the periods after the step.
    fn of_rows(rows: &[PeriodRow], set_rpm: f64, within: f64) -> Self {
        let beyond = rows
            .iter()
            .map(|row| (row.omega_m * 60.0 / TAU - set_rpm) * 1.0_f64.copysign(set_rpm));
        let beyond: Vec<f64> = beyond.collect();
        let lowest = (0..beyond.len()).min_by(|&one, &other| beyond[one].total_cmp(&beyond[other]));
        let lowest = lowest.unwrap_or(0);
        let greatest = beyond[lowest..].iter().copied().fold(0.0, f64::max);
        let left = beyond.iter().rposition(|off| off.abs() > within);
        let recovery = match left {
            None => Some(0.0),
            Some(last) => rows.get(last + 1).map(|row| row.t - rows[0].t),
        };
        Self {
            dip_rpm: beyond.iter().fold(0.0, |dip: f64, off| dip.max(-off)),
            overshoot_rpm: greatest,
            recovery_ms: recovery.map(|time| 1e3 * time),
        }
    }
}

/// Mean speed of periods, rpm.
fn mean_rpm(rows: &[PeriodRow]) -> f64 {
    rows.iter().map(|row| row.omega_m).sum::<f64>() / rows.len() as f64 * 60.0 / TAU
}

/// Settling time in time constants of the speed loop's bandwidth.
const SETTLING_OF_SPEED: f64 = 6.0;

impl LoadStep {
    /// A step to a load in Nm, recorded for as long as the speed loop takes to settle.
    pub fn to(load: f64, speed: &SpeedLoop) -> Self {
        Self {
            load,
            watched: SETTLING_OF_SPEED / speed.bandwidth,
        }
    }
}

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

#[cfg(test)]
mod tests {
    use super::{LoadResponse, PeriodRow, tolerance};
    use std::f64::consts::TAU;

    fn rows(speeds: &[f64]) -> Vec<PeriodRow> {
        let rows = speeds.iter().zip(0_u32..).map(|(rpm, place)| PeriodRow {
            t: 2.0 + 1e-3 * f64::from(place),
            omega_m: rpm * TAU / 60.0,
            ..PeriodRow::default()
        });
        rows.collect()
    }

    #[test]
    fn a_load_step_has_a_dip_an_overshoot_and_a_time_of_recovery() {
        for sign in [1.0, -1.0] {
            let of = |speeds: &[f64]| {
                let turned: Vec<f64> = speeds.iter().map(|rpm| sign * rpm).collect();
                LoadResponse::of_rows(&rows(&turned), sign * 1000.0, 20.0)
            };
            let found = of(&[1001.0, 970.0, 900.0, 990.0, 1030.0, 1010.0, 1000.0]);
            assert!((found.dip_rpm - 100.0).abs() < 1e-6, "{found:?}");
            assert!((found.overshoot_rpm - 30.0).abs() < 1e-6, "{found:?}");
            let recovery = found.recovery_ms.expect("it comes back");
            assert!((recovery - 5.0).abs() < 1e-6, "{found:?}");
            assert_eq!(of(&[1000.0, 990.0, 1000.0]).recovery_ms, Some(0.0));
            assert_eq!(of(&[1000.0, 500.0, 0.0]).recovery_ms, None);
        }
    }

    #[test]
    fn a_rotor_that_stands_has_not_settled_at_any_speed() {
        for (set, least) in [(30.0, 2000.0), (1.0, 100.0), (-5.0, 3000.0)] {
            assert!(tolerance(set, least) < set.abs(), "{set} of {least}");
        }
        assert_eq!(tolerance(0.0, 1000.0), 20.0);
        assert_eq!(tolerance(1500.0, 100.0), 30.0);
    }
}
