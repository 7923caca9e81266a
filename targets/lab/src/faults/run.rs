//! One run: settling, the instant at which something breaks, and what follows.

use super::class::FaultClass;
use super::defect::{Defect, SignalDefect};
use super::signals::Signals;
use crate::LabError;
use crate::closed_loop::{ClosedLoop, CurrentLoop, Recorder, RunOptions, Step, Trip};
use crate::engine::{Engine, Model, PlantOptions, Prepared};
use crate::plant::{Observer, Plant, PlantError, PlantParams, Segment, Truth};
use hexagen::{Fault, Sample};
use hexagen_reference::AnyCommand;
use serde::Serialize;
use std::f64::consts::TAU;

/// Speeds over the rated one.
const SPEEDS: [f64; 2] = [0.25, 0.75];

/// Torques over the demanded one: motoring and braking.
const TORQUES: [f64; 4] = [0.3, 1.0, -0.3, -1.0];

/// Electrical angle at the start of the first run, and how much further it is in each following
/// one, so that things break at different angles; radians.
const FIRST_START: f64 = 0.1;
const START_STEP: f64 = 0.77;

/// Time after the fault, second, and electrical turns, whichever is longer.
const AFTER: f64 = 0.1;
const TURNS_AFTER: f64 = 3.0;

/// Most of it in control periods, for motors that turn slowly.
const MOST_AFTER: f64 = 20_000.0;

/// Time over the stall time-out that a shaft or an angle that stays is watched for.
const STALL_MARGIN: f64 = 1.2;

/// Speed and torque of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Torque demand, Nm; negative brakes.
    pub torque_nm: f64,
}

/// The operating points of a drive, with `torque` in newton metres as the greatest one.
pub fn points(drive: &Prepared, torque: f64) -> Vec<OperatingPoint> {
    let point = |speed: f64, part: f64| OperatingPoint {
        rpm: speed * drive.rated_rpm(),
        torque_nm: part * torque,
    };
    let speeds = SPEEDS.into_iter();
    speeds
        .flat_map(|speed| TORQUES.map(|part| point(speed, part)))
        .collect()
}

/// What happened in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    /// Trip before the fault: the run says nothing about it.
    pub(super) tripped_before: bool,
    /// Trip after the fault, with the time since it; of a sound drive since its start.
    pub(super) trip: Option<Trip>,
    /// Largest true current of a phase or of a leg after the fault, ampere.
    pub(super) largest: f64,
    /// Mean torque after the fault, Nm.
    pub(super) torque: f64,
    /// Greatest less least torque, means over a period, in the second half of the time after the fault, Nm.
    pub(super) ripple: f64,
}

/// A drive with its plant and everything that runs of it have in common.
pub(super) struct Bench<'d> {
    drive: &'d Prepared,
    model: Model,
    options: &'d PlantOptions,
    plant: PlantParams,
}

impl<'d> Bench<'d> {
    /// # Errors
    /// A free shaft, or a plant option out of range.
    pub(super) fn new(
        drive: &'d Prepared,
        model: Model,
        options: &'d PlantOptions,
    ) -> Result<Self, LabError> {
        if options.inertia.is_some() {
            return Err(LabError::FreeShaft);
        }
        let plant = options.plant(drive)?;
        Ok(Self {
            drive,
            model,
            options,
            plant,
        })
    }

    /// Runs a class at an operating point, the `place`-th of the study.
    ///
    /// # Errors
    /// A parameter that the defect moves out of its range.
    pub(super) fn run(
        &self,
        class: &FaultClass,
        point: OperatingPoint,
        place: usize,
    ) -> Result<Run, LabError> {
        let Self { drive, options, .. } = *self;
        let run = options.run(drive, point.rpm, point.torque_nm);
        let start = FIRST_START + START_STEP * place as f64;
        let start = options.start_angle.unwrap_or(start);
        let plant = Plant::new(self.plant.clone(), start, run.omega_m)?;
        let set_point = options.set_point(drive, point.torque_nm);
        let controller = Watched {
            engine: drive.engine(self.model, set_point),
            signals: Signals::new(&self.plant, place as u64),
            lost: 0,
            last: AnyCommand::default(),
        };
        let mut closed = ClosedLoop::new(plant, controller, run.delay);
        if class.is_sound() {
            self.break_down(&mut closed, class.defect)?;
        }
        closed.run(run.periods(&self.plant).0, &mut ());
        if closed.tripped().is_none() && !class.is_sound() {
            self.break_down(&mut closed, class.defect)?;
        }
        let before = closed.tripped();
        let begun = if class.is_sound() {
            0.0
        } else {
            closed.plant().time()
        };
        let mut after = After::default();
        let periods = self.periods_after(&run, class.defect);
        closed.run(periods / 2, &mut after);
        after.range = None;
        closed.run(periods - periods / 2, &mut after);
        let since = |trip: Trip| Trip {
            time_s: trip.time_s - begun,
            ..trip
        };
        let trip = closed.tripped().map(since);
        Ok(Run {
            // A sound drive has no instant before which it may trip.
            tripped_before: before.is_some() && !class.is_sound(),
            trip,
            largest: after.largest,
            torque: after.torque / after.periods,
            ripple: after.range.map_or(0.0, |[least, most]| most - least),
        })
    }

    fn break_down(
        &self,
        closed: &mut ClosedLoop<Watched<'_>>,
        defect: Defect,
    ) -> Result<(), PlantError> {
        match defect {
            Defect::None => {}
            Defect::Plant(defect) => closed.plant_mut().change(|plant| defect.apply(plant))?,
            Defect::Signal(defect) => closed.controller().signals.break_down(defect),
            Defect::Bus { factor, is_told } => {
                closed.plant_mut().change(|plant| plant.v_bus *= factor)?;
                let v_bus = closed.plant().params().v_bus;
                let engine = &mut closed.controller().engine;
                match self.drive.bus_counts(v_bus).filter(|_| is_told) {
                    Some(counts) => engine.set_bus(counts),
                    None => engine.stop_telling_bus(),
                }
            }
            Defect::Shaft { factor } => {
                let omega_m = closed.plant().truth().omega_m;
                closed.plant_mut().set_speed(factor * omega_m);
            }
            Defect::Interrupt { lost } => {
                closed.controller().lost = lost.unwrap_or(usize::MAX);
            }
        }
        Ok(())
    }

    /// Control periods that follow a fault.
    fn periods_after(&self, run: &RunOptions, defect: Defect) -> usize {
        let PlantParams {
            pole_pairs, t_s, ..
        } = self.plant;
        let turn = TAU / (run.omega_m.abs() * f64::from(pole_pairs));
        let periods = (AFTER.max(TURNS_AFTER * turn) / t_s).min(MOST_AFTER);
        let stall = STALL_MARGIN * f64::from(self.drive.spec.inverter.stall_periods);
        let stands = matches!(
            defect,
            Defect::Shaft { factor: 0.0 } | Defect::Signal(SignalDefect::AngleStuck)
        );
        let periods = if stands { periods.max(stall) } else { periods };
        periods.ceil() as usize
    }
}

/// A drive behind signals that may break and an interrupt that may not come.
struct Watched<'g> {
    engine: Engine<'g>,
    signals: Signals,
    /// Periods without an interrupt that are to come.
    lost: usize,
    /// The last command.
    last: AnyCommand,
}

impl CurrentLoop for Watched<'_> {
    fn step(&mut self, sample: &Sample, truth: &Truth) -> AnyCommand {
        let sample = self.signals.read(sample);
        if self.lost > 0 {
            self.lost -= 1;
            return self.last;
        }
        self.last = self.engine.step(&sample, truth);
        self.last
    }

    fn fault(&self) -> Option<Fault> {
        self.engine.fault()
    }
}

/// Current and torque after the fault.
#[derive(Clone, Copy, Debug, Default)]
struct After {
    /// Largest current of a phase or of a leg, ampere.
    largest: f64,
    /// Sum of the periods' mean torques, Nm.
    torque: f64,
    /// Number of periods.
    periods: f64,
    /// Least and greatest of the periods' mean torques, Nm.
    range: Option<[f64; 2]>,
}

impl Observer for After {
    fn segment(&mut self, segment: &Segment) {
        // Between two events a current hardly turns back.
        let ends = [0.0, segment.duration];
        let ends = ends.map(|t| [segment.currents_at(t), segment.leg_currents_at(t)]);
        let currents = ends.into_iter().flatten().flatten().map(f64::abs);
        self.largest = currents.fold(self.largest, f64::max);
    }
}

impl Recorder for After {
    fn period(&mut self, step: &Step<'_>) {
        let torque = step.plant.truth().mean_torque;
        self.torque += torque;
        self.periods += 1.0;
        let [least, most] = self.range.unwrap_or([torque; 2]);
        self.range = Some([least.min(torque), most.max(torque)]);
    }
}
