//! Coverage of a bit-for-bit test.

use crate::{BitTrue, Mode, Reach};
use std::fmt;

/// Number of steps of a passed test by path, counted in the model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// All steps.
    pub steps: u64,
    /// Steps in control.
    pub running: u64,
    /// Steps with offset calibration in progress.
    pub calibrating: u64,
    /// Calibrations completed with plausible offsets.
    pub calibrations: u64,
    /// Steps with bootstrap pre-charge in progress.
    pub precharging: u64,
    /// Steps of a start that waits for the rotor's angle.
    pub starting: u64,
    /// Steps coasting and braking without control.
    pub stopped: u64,
    /// Steps braking in control.
    pub opposing: u64,
    /// Steps tripped.
    pub tripped: u64,
    /// Steps in control and limited to the hexagon.
    pub limited: u64,
    /// Of these, steps beyond the limit along the EMF (torque priority).
    pub past_reach: u64,
    /// Steps in control with a commutation in progress (if tracked).
    pub commutating: u64,
    /// Steps in control with an interpolated rotor angle.
    pub timed: u64,
    /// Of these, steps with the rotor turning backward.
    pub backward: u64,
    /// Steps with a measured bus voltage that is not stale.
    pub fresh_bus: u64,
    /// Calls between the steps: set-points, reset, calibration, pre-charge, state jumps.
    pub actions: u64,
}

impl Report {
    /// Counts the model's last step; `before` is its mode before that.
    #[inline]
    pub(super) fn count(&mut self, model: &BitTrue, before: Mode) {
        self.steps += 1;
        let calibrated =
            before == Mode::Calibrate && !matches!(model.mode(), Mode::Calibrate | Mode::Tripped);
        self.calibrations += u64::from(calibrated);
        self.fresh_bus += u64::from(model.has_measured_bus() && !model.bus_is_stale());
        match model.mode() {
            Mode::Run => {
                let seen = model.course();
                self.running += 1;
                self.limited += u64::from(seen.reach != Reach::Inside);
                self.past_reach += u64::from(seen.reach == Reach::PastReach);
                self.commutating += u64::from(seen.commutating);
                self.timed += u64::from(seen.step_angle != 0.0);
                self.backward += u64::from(seen.step_angle < 0.0);
            }
            Mode::Calibrate => self.calibrating += 1,
            Mode::Precharge => self.precharging += 1,
            Mode::Start => self.starting += 1,
            Mode::Brake if model.is_in_control() => self.opposing += 1,
            Mode::Coast | Mode::Brake => self.stopped += 1,
            Mode::Tripped => self.tripped += 1,
        }
    }

    /// Adds another run's counts.
    pub fn add(&mut self, other: &Self) {
        self.steps += other.steps;
        self.running += other.running;
        self.calibrating += other.calibrating;
        self.calibrations += other.calibrations;
        self.precharging += other.precharging;
        self.starting += other.starting;
        self.stopped += other.stopped;
        self.opposing += other.opposing;
        self.tripped += other.tripped;
        self.limited += other.limited;
        self.past_reach += other.past_reach;
        self.commutating += other.commutating;
        self.timed += other.timed;
        self.backward += other.backward;
        self.fresh_bus += other.fresh_bus;
        self.actions += other.actions;
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = |count: u64| 100.0 * count as f64 / self.steps.max(1) as f64;
        write!(
            f,
            "{} steps: {:.1} % in control ({:.1} % limited, {:.1} % past reach, {:.1} % commutating, {:.1} % with angle), \
             {:.1} % calibrating, {:.1} % pre-charging, {:.1} % starting, {:.1} % off or braking, {:.1} % tripped; {} calls, {} calibrations",
            self.steps,
            share(self.running),
            share(self.limited),
            share(self.past_reach),
            share(self.commutating),
            share(self.timed),
            share(self.calibrating),
            share(self.precharging),
            share(self.starting),
            share(self.stopped + self.opposing),
            share(self.tripped),
            self.actions,
            self.calibrations
        )
    }
}
