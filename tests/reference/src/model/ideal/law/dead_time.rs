//! Cost of the dead time per leg, as a fraction of the period (section 11).

use super::Inputs;
use crate::model::ideal::vector::phases;
use crate::model::variant::Variant;
use crate::{DiscretePhase, Spec};
use nalgebra::Vector3;

/// Compensation of the dead time; none with a fraction of 0.
#[derive(Clone, Copy, Debug)]
pub struct DeadTime {
    /// Dead time over the period.
    share: f64,
    /// Current up to which the shift is proportional, ampere.
    band: f64,
}

impl DeadTime {
    pub fn new(spec: &Spec) -> Self {
        let inverter = &spec.inverter;
        let compensated = Variant::new(spec).compensates();
        Self {
            share: if compensated {
                inverter.dead_time / inverter.pwm_period()
            } else {
                0.0
            },
            band: 0.1 * inverter.max_current,
        }
    }

    /// Fractions of the period added to duties; `kept` is the part of the measured current that the
    /// law uses.
    pub fn shifts(self, now: &Inputs, kept: f64) -> Vector3<f64> {
        let mean = (phases(&now.i_ref) + phases(&now.i) * kept) / 2.0;
        mean.map(|i| (i / self.band).clamp(-1.0, 1.0) * self.share)
    }
}

/// The part of the current left when the deadbeat voltage takes effect.
pub fn kept_by_deadbeat(now: &Inputs) -> f64 {
    let DiscretePhase { a, .. } = now.phase;
    if now.delayed { a * a } else { a }
}
