//! The common mode of three pulsed legs (sections 10 and 11).

use super::Inputs;
use crate::model::ideal::limit::{Limited, limit};
use crate::model::ideal::vector::phases;
use crate::{CommonMode, Error, Saturation, Spec};
use nalgebra::{Vector2, Vector3};

/// Policy and largest duty.
#[derive(Clone, Copy, Debug)]
pub struct CommonModeRule {
    mode: CommonMode,
    /// Largest duty.
    pub top: f64,
    /// Largest duty of the second highest leg.
    second: f64,
}

/// The leg between the highest and the lowest.
fn second(legs: &Vector3<f64>) -> f64 {
    legs.sum() - legs.max() - legs.min()
}

impl CommonModeRule {
    pub fn new(spec: &Spec, mode: CommonMode) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let duty = |counts: u32| f64::from(counts) / f64::from(inverter.timer_period);
        let readable = inverter.largest_compare()?;
        let top = match mode {
            CommonMode::Centred => readable,
            CommonMode::Readable | CommonMode::ClampedLow => inverter.highest_compare()?,
        };
        Ok(Self {
            mode,
            top: duty(top),
            second: duty(readable),
        })
    }

    /// That of whole vectors, whose high legs are alike and of which one leg is low throughout.
    pub fn of_vectors(spec: &Spec) -> Result<Self, Error> {
        let rule = Self::new(spec, CommonMode::ClampedLow)?;
        Ok(Self {
            top: rule.second,
            ..rule
        })
    }

    /// The spread of phase voltages that fits, of a bus of `v_bus`.
    pub fn reach(self, v_bus: f64) -> f64 {
        match self.mode {
            CommonMode::Centred => (2.0 * self.top - 1.0) * v_bus,
            CommonMode::Readable | CommonMode::ClampedLow => self.top * v_bus,
        }
    }

    /// A voltage within the hexagon of these legs; `e`: the EMF.
    pub fn limited(
        self,
        now: &Inputs,
        rule: Saturation,
        u: &Vector2<f64>,
        e: &Vector2<f64>,
    ) -> Limited {
        let limited = limit(rule, &phases(u), &phases(e), self.reach(now.v_bus));
        Limited {
            u: self.readable(&limited.u, now.v_bus),
            ..limited
        }
    }

    /// Phase voltages of which the second highest is where its leg's sensor can be read.
    fn readable(self, u: &Vector3<f64>, v_bus: f64) -> Vector3<f64> {
        let most = u.min() + self.second * v_bus;
        let above = second(u) - most;
        if above <= 0.0 || self.second >= self.top {
            return *u;
        }
        let highest = u.imax();
        Vector3::from_fn(|x, _| if x == highest { u[x] } else { u[x].min(most) })
            .add_scalar(above / 3.0)
    }

    /// What duties of zero middle are lifted by.
    pub fn lift(self, duties: &Vector3<f64>) -> f64 {
        let lift = match self.mode {
            CommonMode::Centred => 0.5,
            CommonMode::Readable => (self.top - duties.max()).min(0.5),
            CommonMode::ClampedLow => -duties.min(),
        };
        if self.second < self.top {
            lift.min(self.second - second(duties))
        } else {
            lift
        }
    }
}
