//! What the dead time costs each leg, as a share of the period (section 11).

use super::Inputs;
use crate::model::ideal::vector::phases;
use crate::model::variant::Variant;
use crate::{DiscretePhase, Spec};
use nalgebra::Vector3;

/// Compensation of the dead time; none with a share of 0.
#[derive(Clone, Copy, Debug)]
pub struct DeadTime {
    /// Dead time over the period.
    share: f64,
    /// Current up to which the shift is in proportion, ampere.
    band: f64,
}

impl DeadTime {
    pub fn new(spec: &Spec) -> Self {
        let inverter = &spec.inverter;
        let compensated = Variant::new(spec).compensates();
        Self {
            share: if compensated {
                inverter.dead_time / inverter.t_s
            } else {
                0.0
            },
            band: 0.1 * inverter.max_current,
        }
    }

    /// Shares of the period by which duties grow; `kept` is what of the measured current the law counts with.
    pub fn shifts(self, now: &Inputs, kept: f64) -> Vector3<f64> {
        let mean = (phases(&now.i_ref) + phases(&now.i) * kept) / 2.0;
        mean.map(|i| (i / self.band).clamp(-1.0, 1.0) * self.share)
    }
}

/// The share of the current that deadbeat control counts with when its voltage takes effect.
pub fn kept_by_deadbeat(now: &Inputs) -> f64 {
    let DiscretePhase { a, .. } = now.phase;
    if now.delayed { a * a } else { a }
}
