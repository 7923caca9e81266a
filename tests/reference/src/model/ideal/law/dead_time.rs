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
    /// Current beyond the quiet one over which the shift grows in proportion, ampere.
    band: f64,
    /// Current that loses nothing over the spread of the voltages, A/V; 0 unless three legs are pulsed in every period.
    quiet: f64,
}

impl DeadTime {
    /// `three`: whether three legs are pulsed in every period.
    pub fn new(spec: &Spec, three: bool) -> Self {
        let inverter = &spec.inverter;
        let compensated = Variant::new(spec).compensates();
        Self {
            share: if compensated {
                inverter.dead_time / inverter.pwm_period()
            } else {
                0.0
            },
            band: 0.1 * inverter.max_current,
            quiet: if three {
                inverter.pwm_period() / (24.0 * spec.motor.inductance)
            } else {
                0.0
            },
        }
    }

    /// Fractions of the period added to duties; `kept` is the part of the measured current that the
    /// law uses, and `spread` that of the limited voltages.
    pub fn shifts(self, now: &Inputs, kept: f64, spread: f64) -> Vector3<f64> {
        let (wanted, held) = (phases(&now.i_ref), phases(&now.i) * kept);
        let at_the_middle = if now.delayed {
            (wanted * 3.0 + held) / 4.0
        } else {
            (wanted + held) / 2.0
        };
        let quiet = self.quiet * spread;
        at_the_middle.map(|i| {
            let driven = i - i.clamp(-quiet, quiet);
            (driven / self.band).clamp(-1.0, 1.0) * self.share
        })
    }
}

/// The part of the current left when the deadbeat voltage takes effect.
pub fn kept_by_deadbeat(now: &Inputs) -> f64 {
    let DiscretePhase { a, .. } = now.phase;
    if now.delayed { a * a } else { a }
}
