//! Measured runs: settling, the measured window, and the three starts.

use super::{ClosedLoop, CurrentLoop, Delay, FiguresOfMerit, Trace, Trip, figures_of_merit};
use crate::plant::{Plant, PlantError, PlantParams, Truth};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Electrical start angles in radians, so that Hall edges fall differently between the samples.
pub const STARTS: [f64; 3] = [0.1, 0.117, 0.134];

/// Minimum settling time in seconds.
const SETTLING: f64 = 15e-3;

/// Electrical periods: minimum of settling, maximum of measurement.
const SETTLING_TURNS: f64 = 2.0;
const MEASURED_TURNS: f64 = 6.0;

/// Maximum control periods of a record with long electrical periods, of which it then has fewer,
/// but at least one. (Such a record takes 200 megabytes at 20 kHz, and there is one per start.)
pub const MOST_RECORDED: usize = 250_000;

/// Measured time at standstill, without electrical periods, in seconds.
const STANDSTILL: f64 = 50e-3;

/// Options of a run. Speed and torque may have either sign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunOptions {
    /// Mechanical speed in rad/s; the initial one if the speed is free.
    pub omega_m: f64,
    /// Amplitude in amperes of the quasi-square reference for tracking and commutation: that of the
    /// limited set-point. Its sign is the torque's.
    pub current: f64,
    /// Delay of commands.
    pub delay: Delay,
    /// Current in amperes that ends a commutation in the figures of merit.
    pub commutation_threshold: f64,
    /// Electrical start angles in radians; each is a run of its own.
    pub starts: Vec<f64>,
    /// Seconds that a drive with a rotor at standstill waits for its angle before it settles. (Where the
    /// rotor turns, half a turn of settling gives the angle.)
    pub wait: f64,
    /// Seconds in which the set-point takes effect, with a slew rate.
    pub ramp: f64,
    /// Largest difference of two legs' compare values, where it is less than the timer's period.
    pub reach: Option<u16>,
    /// Target of a speed loop; `None` if the speed is held or free.
    pub aim: Option<Aim>,
    /// A further load from the middle of the measured window on; it needs a free shaft.
    pub load_step: Option<LoadStep>,
}

/// A load that a free shaft bears from the middle of the measured window on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadStep {
    /// The whole load torque from then on, Nm.
    pub load: f64,
    /// Time for which it is recorded, seconds.
    pub watched: f64,
}

/// Speed to be reached before the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Aim {
    /// Mechanical speed in rad/s.
    pub omega_m: f64,
    /// Settling time in seconds.
    pub within: f64,
}

impl RunOptions {
    /// The standard measurement at a speed in rad/s and a reference amplitude in amperes.
    pub fn new(omega_m: f64, current: f64) -> Self {
        Self {
            omega_m,
            current,
            delay: Delay::OnePeriod,
            commutation_threshold: 0.5,
            starts: STARTS.to_vec(),
            wait: 0.0,
            ramp: 0.0,
            reach: None,
            aim: None,
            load_step: None,
        }
    }

    /// Of so many measured periods those before the load step; all without one.
    pub fn before_step(&self, measured: usize) -> usize {
        self.load_step.map_or(measured, |_| measured / 2)
    }

    /// Control periods of settling and of measurement for a motor.
    pub fn periods(&self, params: &PlantParams) -> (usize, usize) {
        let omega_m = self.aim.map_or(self.omega_m, |aim| aim.omega_m);
        let turn = TAU / (omega_m.abs() * f64::from(params.pole_pairs));
        let (settling, measured) = if turn.is_finite() {
            let most = (MOST_RECORDED as f64 * params.t_s / turn).floor();
            let measured = turn * most.clamp(1.0, MEASURED_TURNS);
            (SETTLING.max(SETTLING_TURNS * turn), measured)
        } else {
            (self.wait + SETTLING, STANDSTILL)
        };
        let settling = self.aim.map_or(settling, |aim| settling.max(aim.within));
        let watched = self.load_step.map_or(0.0, |step| 2.0 * step.watched);
        let watched = watched.min(MOST_RECORDED as f64 * params.t_s);
        (
            ((self.ramp + settling) / params.t_s).ceil() as usize,
            ((measured.max(watched) / params.t_s).round() as usize).max(1),
        )
    }
}

/// The figures of merit over all starts and their records.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Worst peak-to-peak ripple of the starts, mean of everything else; empty for a drive that
    /// tripped.
    pub figures: FiguresOfMerit,
    /// Record of each start's measured window.
    pub traces: Vec<Trace>,
    /// The trip of the first start whose controller tripped.
    pub tripped: Option<Trip>,
}

/// Runs one start: settles, then records the measured window.
fn run_start<C: CurrentLoop>(
    params: &PlantParams,
    options: &RunOptions,
    start: f64,
    controller: C,
) -> Result<(Trace, Option<Trip>), PlantError> {
    let plant = Plant::new(params.clone(), start, options.omega_m)?;
    let (settling, measured) = options.periods(params);
    let mut closed = ClosedLoop::new(plant, controller, options.delay);
    closed.run(settling, &mut ());
    let mut trace = Trace::of_run(closed.plant(), options, measured);
    let before = options.before_step(measured);
    closed.run(before, &mut trace);
    if let Some(step) = options.load_step {
        closed.plant_mut().set_load(step.load);
        closed.run(measured - before, &mut trace);
    }
    Ok((trace, closed.tripped()))
}

/// Measures a controller from every start. The loop settles for 15 ms and at least two electrical
/// periods; the figures of merit are those of the next six periods (fewer if they exceed
/// [`MOST_RECORDED`]): the worst peak-to-peak ripple of all starts and the mean of everything else.
/// `make` builds a controller with its set-point for each start from the plant's initial state;
/// starts run in parallel.
///
/// # Errors
/// A plant parameter outside its range.
pub fn measure<C, F>(
    params: &PlantParams,
    options: &RunOptions,
    make: F,
) -> Result<Measurement, PlantError>
where
    C: CurrentLoop,
    F: Fn(&Truth) -> C + Sync,
{
    let runs = options
        .starts
        .par_iter()
        .map(|&start| {
            let initial = Plant::new(params.clone(), start, options.omega_m)?.truth();
            run_start(params, options, start, make(&initial))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let (traces, trips): (Vec<_>, Vec<_>) = runs.into_iter().unzip();
    let tripped = trips.into_iter().flatten().next();
    Ok(Measurement::of(traces, tripped, options))
}

impl Measurement {
    /// The figures of merit of a run from the records of all starts, none of which may have
    /// `tripped`.
    pub fn of(traces: Vec<Trace>, tripped: Option<Trip>, options: &RunOptions) -> Self {
        let starts: Vec<FiguresOfMerit> = traces
            .iter()
            .map(|trace| figures_of_merit(trace, options.current, options.commutation_threshold))
            .collect();
        Self {
            figures: match tripped {
                None => FiguresOfMerit::of_starts(&starts),
                Some(_) => FiguresOfMerit::default(),
            },
            traces,
            tripped,
        }
    }
}

/// Records a run from its first period on, start-up included, for plots and CSV. Uses the first
/// start angle; `duration` in seconds.
///
/// # Errors
/// A plant parameter outside its range.
pub fn record<C: CurrentLoop>(
    params: &PlantParams,
    options: &RunOptions,
    controller: C,
    duration: f64,
) -> Result<Trace, PlantError> {
    let start = options.starts.first().copied().unwrap_or(STARTS[0]);
    let plant = Plant::new(params.clone(), start, options.omega_m)?;
    let periods = (duration / params.t_s).round() as usize;
    let mut trace = Trace::of_run(&plant, options, periods);
    ClosedLoop::new(plant, controller, options.delay).run(periods, &mut trace);
    Ok(trace)
}

/// Mean torque over the measured window, mean of the starts, in newton metres, or the first start's
/// trip; without a record, for the speed limit's scan.
///
/// # Errors
/// A plant parameter outside its range.
pub fn mean_torque<C, F>(
    params: &PlantParams,
    options: &RunOptions,
    make: &F,
) -> Result<Result<f64, Trip>, PlantError>
where
    C: CurrentLoop,
    F: Fn(&Truth) -> C + Sync,
{
    let (settling, measured) = options.periods(params);
    let mut total = 0.0;
    for &start in &options.starts {
        let plant = Plant::new(params.clone(), start, options.omega_m)?;
        let controller = make(&plant.truth());
        let mut closed = ClosedLoop::new(plant, controller, options.delay);
        closed.run(settling, &mut ());
        let mut sum = 0.0;
        for _ in 0..measured {
            closed.run(1, &mut ());
            sum += closed.plant().truth().mean_torque;
        }
        if let Some(trip) = closed.tripped() {
            return Ok(Err(trip));
        }
        total += sum / measured as f64;
    }
    Ok(Ok(total / options.starts.len() as f64))
}
