//! What a study found, as data.

use super::class::{FaultClass, Part};
use super::run::{OperatingPoint, Run};
use crate::closed_loop::{Cause, percent};
use hexagen_codegen::spec::Spec;
use serde::Serialize;
use std::f64::consts::TAU;

/// A study of all classes of faults of a drive.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultStudy {
    /// Current above which the drive trips, ampere.
    pub trip_current_a: f64,
    /// Largest set-point, ampere.
    pub max_current_a: f64,
    /// Time after which a rotor that stands trips, second; `None` without stall detection.
    pub stall_timeout_s: Option<f64>,
    /// Time after which currents that do not follow the voltages trip, second; `None` where they are
    /// not watched.
    pub residual_timeout_s: Option<f64>,
    /// Speed above which the drive trips, rpm; `None` where it is not watched.
    pub over_speed_rpm: Option<f64>,
    /// The operating points, each a run of every class.
    pub points: Vec<OperatingPoint>,
    /// One row per class.
    pub rows: Vec<FaultRow>,
    /// Counts over the rows.
    pub totals: Totals,
}

/// What a class of faults did.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultRow {
    /// The part that broke.
    pub part: Part,
    /// What happened, in plain words.
    pub fault: String,
    /// Whether the drive noticed.
    pub seen: Seen,
    /// Runs that reached the fault without a trip.
    pub runs: usize,
    /// Runs of these that tripped.
    pub tripped: usize,
    /// What tripped them, the most frequent first.
    pub causes: Vec<CauseCount>,
    /// Time from the fault to the sample that tripped the drive, millisecond: the median. Of a
    /// sound drive: from the start of control on a turning rotor. `None` without a trip.
    pub after_ms: Option<f64>,
    /// Largest true current of a phase, or with a short of a leg, after the fault, ampere; of a sound
    /// drive after settling.
    pub largest_a: f64,
    /// The same over `max_current`.
    pub largest_over_max: f64,
    /// The largest true phase current of a run that did not trip, ampere; `None` if all did.
    pub unseen_largest_a: Option<f64>,
    /// Mean torque after the fault in percent of that of the sound drive at the same operating
    /// point: the least and the greatest of the runs that did not trip. Negative against the
    /// demand.
    pub torque_pct: Option<[f64; 2]>,
    /// Ripple of the torque in the second half of the time after the fault, peak to peak of the means over a
    /// control period, in percent of the sound drive's mean: the greatest of the runs that did not trip.
    pub ripple_pp_pct: Option<f64>,
}

/// Runs with a cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct CauseCount {
    /// The drive's fault.
    pub cause: Cause,
    /// Runs that it tripped.
    pub runs: usize,
}

/// Whether a drive notices a class of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Seen {
    /// It trips in every run.
    Always,
    /// It trips in some.
    Sometimes,
    /// It trips in none.
    Never,
    /// No run reached the fault: the sound drive trips before.
    Untried,
}

/// Counts over the rows of a study.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Totals {
    /// Classes in which something breaks.
    pub classes: usize,
    /// Those that trip in every run.
    pub always: usize,
    /// Those that trip in some runs.
    pub sometimes: usize,
    /// Those that trip in none.
    pub never: usize,
    /// Those that no run reached.
    pub untried: usize,
    /// Those in which the true current passed the trip level in a run that did not trip.
    pub beyond_trip_unseen: usize,
    /// Sound drives.
    pub sound: usize,
    /// Those of them that trip in any run.
    pub false_alarms: usize,
}

impl FaultStudy {
    /// Sums up the runs of each class, one per operating point.
    pub(super) fn of(
        spec: &Spec,
        points: Vec<OperatingPoint>,
        classes: &[FaultClass],
        runs: &[&[Run]],
    ) -> Self {
        let inverter = &spec.inverter;
        let sound = classes.iter().position(FaultClass::is_sound);
        let sound = sound.map_or(&[][..], |place| runs[place]);
        let rows: Vec<FaultRow> = classes
            .iter()
            .zip(runs)
            .map(|(class, runs)| FaultRow::of(class, runs, sound, inverter.max_current))
            .collect();
        Self {
            trip_current_a: inverter.trip_current,
            max_current_a: inverter.max_current,
            stall_timeout_s: (inverter.stall_periods > 0)
                .then(|| f64::from(inverter.stall_periods) * inverter.t_s),
            residual_timeout_s: (spec.controller.common().residual_periods)
                .map(|periods| f64::from(periods) * inverter.t_s),
            over_speed_rpm: inverter.over_speed.map(|speed| speed * 60.0 / TAU),
            totals: Totals::of(&rows, inverter.trip_current),
            points,
            rows,
        }
    }

    /// The rows of a part.
    pub fn of_part(&self, part: Part) -> impl Iterator<Item = &FaultRow> {
        self.rows.iter().filter(move |row| row.part == part)
    }
}

impl FaultRow {
    fn of(class: &FaultClass, runs: &[Run], sound: &[Run], max_current: f64) -> Self {
        let reached = || runs.iter().filter(|run| !run.tripped_before);
        let trips: Vec<_> = reached().filter_map(|run| run.trip).collect();
        let mut causes: Vec<CauseCount> = Vec::new();
        for trip in &trips {
            match causes.iter_mut().find(|known| known.cause == trip.fault) {
                Some(known) => known.runs += 1,
                None => causes.push(CauseCount {
                    cause: trip.fault,
                    runs: 1,
                }),
            }
        }
        causes.sort_by_key(|known| std::cmp::Reverse(known.runs));
        let largest =
            |runs: &mut dyn Iterator<Item = &Run>| runs.map(|run| run.largest).reduce(f64::max);
        let largest_a = largest(&mut reached()).unwrap_or(0.0);
        let untripped = runs.iter().zip(sound);
        let untripped = untripped.filter(|(run, _)| !run.tripped_before && run.trip.is_none());
        let torques = untripped.clone().filter_map(|(run, sound)| {
            percent(run.torque * sound.torque.signum(), sound.torque, 0.0)
        });
        let ripples = untripped.filter_map(|(run, sound)| percent(run.ripple, sound.torque, 0.0));
        let times = trips.iter().map(|trip| 1e3 * trip.time_s);
        Self {
            part: class.part,
            fault: class.name.clone(),
            seen: Seen::of(trips.len(), reached().count()),
            runs: reached().count(),
            tripped: trips.len(),
            causes,
            after_ms: median(times.collect()),
            largest_a,
            largest_over_max: largest_a / max_current,
            unseen_largest_a: largest(&mut reached().filter(|run| run.trip.is_none())),
            torque_pct: torques.fold(None, |range, torque| {
                let [least, greatest] = range.unwrap_or([torque; 2]);
                Some([torque.min(least), torque.max(greatest)])
            }),
            ripple_pp_pct: ripples.reduce(f64::max),
        }
    }

    /// Whether the drive trips although nothing is broken.
    pub fn is_false_alarm(&self) -> bool {
        self.part == Part::Sound && self.tripped > 0
    }

    /// Whether the true current passes a level, in ampere, in a run that does not trip.
    pub fn passes_unseen(&self, level: f64) -> bool {
        self.unseen_largest_a.is_some_and(|largest| largest > level)
    }
}

impl Seen {
    fn of(tripped: usize, runs: usize) -> Self {
        match (tripped, runs) {
            (_, 0) => Self::Untried,
            (0, _) => Self::Never,
            (tripped, runs) if tripped == runs => Self::Always,
            _ => Self::Sometimes,
        }
    }
}

impl Totals {
    fn of(rows: &[FaultRow], trip_current: f64) -> Self {
        let mut totals = Self::default();
        for row in rows {
            if row.part == Part::Sound {
                totals.sound += 1;
                totals.false_alarms += usize::from(row.is_false_alarm());
                continue;
            }
            totals.classes += 1;
            *match row.seen {
                Seen::Always => &mut totals.always,
                Seen::Sometimes => &mut totals.sometimes,
                Seen::Never => &mut totals.never,
                Seen::Untried => &mut totals.untried,
            } += 1;
            totals.beyond_trip_unseen += usize::from(row.passes_unseen(trip_current));
        }
        totals
    }
}

/// The median; the mean of the middle two of an even number.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.len().checked_sub(1)? / 2, values.len() / 2);
    Some(0.5 * (values[low] + values[high]))
}
