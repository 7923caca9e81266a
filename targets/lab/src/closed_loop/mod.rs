//! The closed loop: controller, plant and measurements.
//!
//! [`CurrentLoop`] is the interface of a controller: a compiled drive, an interpreted graph, the
//! bit-true or the ideal model. Samples are taken at the start of each period; the command computed
//! in period k takes effect in period k + 1, or, without delay, in period k.
//!
//! A sample's later conversions fall into the period that begins, whose command is already known.
//! Without delay it is not: until they are done, the last command stands.

mod allowance;
mod figures_of_merit;
mod harmonics;
mod limit;
mod measure;
mod percent;
mod speed;
mod swing;
mod trace;
mod trip;

pub use allowance::{POINTS, RELATIVE, share_of_allowance};
pub use figures_of_merit::{FiguresOfMerit, figures_of_merit};
pub use harmonics::{
    amplitudes, harmonic_of_quasi_square, harmonics_of_current, harmonics_of_torque,
};
pub use limit::{
    Held, LimitOptions, LimitOutcome, Side, SpeedLimit, TOLERANCE, speed_limit, speed_limit_knowing,
};
pub use measure::{
    Aim, LoadStep, MOST_RECORDED, Measurement, RunOptions, STARTS, mean_torque, measure, record,
};
pub use percent::percent;
pub use speed::{LoadResponse, SETTLED, Speed};
pub use swing::voltage_swing;
pub use trace::{PeriodRow, Trace, hexagon, quasi_square};
pub use trip::{Cause, Trip};

use crate::plant::{Observer, Plant, Truth};
use hexagen::{Control, Drive, Fault, Sample};
pub use hexagen_reference::AnyCommand;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// A current controller, as seen by the plant: one call per control period.
pub trait CurrentLoop {
    /// Reads the sample and returns the command. `truth` is the plant's exact state at the same
    /// instant, for models without ADCs and sensors; real drives ignore it.
    fn step(&mut self, sample: &Sample, truth: &Truth) -> AnyCommand;

    /// The trip, if the controller has a supervisor and it tripped.
    fn fault(&self) -> Option<Fault> {
        None
    }
}

impl<F: FnMut(&Sample, &Truth) -> C, C: Into<AnyCommand>> CurrentLoop for F {
    fn step(&mut self, sample: &Sample, truth: &Truth) -> AnyCommand {
        self(sample, truth).into()
    }
}

/// A generated drive in the loop; sees the sample only.
#[derive(Debug)]
pub struct DriveLoop<C: Control>(pub Drive<C>);

impl<C: Control<Command: Into<AnyCommand>>> CurrentLoop for DriveLoop<C> {
    fn step(&mut self, sample: &Sample, _: &Truth) -> AnyCommand {
        self.0.step(sample).into()
    }

    fn fault(&self) -> Option<Fault> {
        self.0.status().fault
    }
}

/// Delay of a command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Delay {
    /// In the period whose sample it was computed from (`delay: 0`).
    None,
    /// One period later (`delay: 1`).
    #[default]
    OnePeriod,
}

/// One control period in the loop.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// The controller's sample.
    pub sample: &'a Sample,
    /// The plant's state at the sample.
    pub truth: &'a Truth,
    /// The applied command.
    pub applied: AnyCommand,
    /// The plant at the end of the period.
    pub plant: &'a Plant,
}

/// Observes the solution's segments and, after each period, the period as a whole.
pub trait Recorder: Observer {
    /// Called after the period's segments.
    fn period(&mut self, step: &Step<'_>);
}

impl Recorder for () {
    fn period(&mut self, _: &Step<'_>) {}
}

impl Recorder for crate::plant::EnergyMeter {
    fn period(&mut self, _: &Step<'_>) {}
}

impl<A: Recorder, B: Recorder> Recorder for (A, B) {
    fn period(&mut self, step: &Step<'_>) {
        self.0.period(step);
        self.1.period(step);
    }
}

impl<T: Recorder + ?Sized> Recorder for &mut T {
    fn period(&mut self, step: &Step<'_>) {
        (**self).period(step);
    }
}

/// A plant under a controller; can be continued.
#[derive(Debug)]
pub struct ClosedLoop<C> {
    plant: Plant,
    controller: C,
    delay: Delay,
    /// The last command: with a delay that of the period that begins.
    last: AnyCommand,
    tripped: Option<Trip>,
}

impl<C: CurrentLoop> ClosedLoop<C> {
    /// Closes the loop; all legs are off until the first command.
    pub fn new(plant: Plant, controller: C, delay: Delay) -> Self {
        Self {
            plant,
            controller,
            delay,
            last: AnyCommand::default(),
            tripped: None,
        }
    }

    /// The plant.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// The plant, for instance to change its load between two runs.
    pub fn plant_mut(&mut self) -> &mut Plant {
        &mut self.plant
    }

    /// The controller, for instance to change its set-point between two runs.
    pub fn controller(&mut self) -> &mut C {
        &mut self.controller
    }

    /// The controller's first trip, if it tripped.
    pub fn tripped(&self) -> Option<Trip> {
        self.tripped
    }

    /// Ends the loop and returns the controller.
    pub fn into_controller(self) -> C {
        self.controller
    }

    /// Runs a number of control periods.
    pub fn run<R: Recorder>(&mut self, periods: usize, recorder: &mut R) {
        for _ in 0..periods {
            let sample = self.plant.sample(self.last);
            let truth = self.plant.truth();
            let command = self.controller.step(&sample, &truth);
            if self.tripped.is_none() {
                self.tripped = self.controller.fault().map(|fault| Trip {
                    fault: Cause::of(fault),
                    time_s: truth.t,
                    rpm: truth.omega_m * 60.0 / TAU,
                });
            }
            let previous = std::mem::replace(&mut self.last, command);
            let applied = match self.delay {
                Delay::None => command,
                Delay::OnePeriod => previous,
            };
            self.plant.run_period(applied, recorder);
            recorder.period(&Step {
                sample: &sample,
                truth: &truth,
                applied,
                plant: &self.plant,
            });
        }
    }
}
