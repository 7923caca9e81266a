//! The common mode of three pulsed legs (sections 10 and 11).

use crate::{CommonMode, Error, Spec};
use nalgebra::Vector3;

/// Policy and largest duty.
#[derive(Clone, Copy, Debug)]
pub struct CommonModeRule {
    mode: CommonMode,
    /// Largest duty.
    pub top: f64,
}

impl CommonModeRule {
    pub fn new(spec: &Spec, mode: CommonMode) -> Result<Self, Error> {
        let inverter = &spec.inverter;
        let top = f64::from(inverter.largest_compare()?) / f64::from(inverter.timer_period);
        Ok(Self { mode, top })
    }

    /// The spread of phase voltages that fits, of a bus of `v_bus`.
    pub fn reach(self, v_bus: f64) -> f64 {
        match self.mode {
            CommonMode::Centred => (2.0 * self.top - 1.0) * v_bus,
            CommonMode::Readable | CommonMode::ClampedLow => self.top * v_bus,
        }
    }

    /// What duties of zero middle are lifted by.
    pub fn lift(self, duties: &Vector3<f64>) -> f64 {
        match self.mode {
            CommonMode::Centred => 0.5,
            CommonMode::Readable => (self.top - duties.max()).min(0.5),
            CommonMode::ClampedLow => -duties.min(),
        }
    }
}
