//! Inputs of a drive besides samples.

use hexagen_reference::BitTrue;
use hexagen_reference::verify::Subject;

/// Calls of firmware from outside the step.
#[derive(Clone, Copy, Debug)]
pub struct Set {
    /// Set-point, bits of an `I16F16`.
    pub bits: i32,
    /// It is a torque, else a current.
    pub is_torque: bool,
    /// Bus voltage, ADC counts, if measured.
    pub bus: Option<u16>,
    /// Speed, bits of an `I16F16` in rpm, with a speed loop.
    pub speed: Option<i32>,
}

impl Set {
    /// Applies it to the model.
    pub fn tell(self, model: &mut BitTrue) {
        if let Some(counts) = self.bus {
            model.set_bus(counts);
        }
        if let Some(bits) = self.speed {
            model.set_speed(bits);
        }
        if self.is_torque {
            model.set_torque(self.bits);
        } else {
            model.set_current(self.bits);
        }
    }

    /// Applies it to a subject.
    pub fn apply<S: Subject>(self, subject: &mut S) {
        if let Some(counts) = self.bus {
            subject.set_bus(counts);
        }
        if let Some(bits) = self.speed {
            subject.set_speed(bits);
        }
        if self.is_torque {
            subject.set_torque(self.bits);
        } else {
            subject.set_current(self.bits);
        }
    }
}
