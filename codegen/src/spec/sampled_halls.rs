//! Torque ripple of a drive whose Hall edges are seen at samples only.

use super::{Reference, RotorSensing, Spec};

/// Greatest ripple of a drive that is right, over the mean torque, where the rotor turns little in a control period.
pub const MOST_RIPPLE: f64 = 0.03;

/// Ripple per radian of such a jump and per unit of [`Spec::coarseness`] (simulated over the library's motors at
/// speeds from 37 to 100 % of the rated one).
const OF_CURRENT: f64 = 0.75;

impl Spec {
    /// Peak-to-peak ripple at rated speed over the mean torque, of a proportional current and an EMF that both follow
    /// the rotor's angle, with Hall edges that are seen at samples only; `None` for any other drive.
    ///
    /// An edge is late by up to a control period, in which the rotor turns by d radians, so the angle jumps by up to
    /// d. The proportional current no longer fits the EMF then, by d times the steepness of the EMF's length; and
    /// the modelled EMF jumps by d times the EMF, which moves the current before the next sample shows it.
    pub fn sampled_ripple(&self) -> Option<f64> {
        let common = self.controller.common();
        let is_sampled = self.inverter.rotor_sensing == RotorSensing::SampledHalls;
        let follows = common.emf.is_modelled() && common.reference == Reference::Proportional;
        (is_sampled && follows && self.controller.modulates()).then(|| {
            let jump = self.motor.rated_turn(self.inverter.t_s).to_radians();
            jump * self
                .motor
                .emf_shape
                .steepness()
                .hypot(OF_CURRENT * self.coarseness())
        })
    }

    /// Change of the current in a control period with the EMF of the rated speed across a phase, over the rated current.
    fn coarseness(&self) -> f64 {
        let motor = &self.motor;
        let emf = motor.emf_constant * motor.rated_speed;
        emf * self.inverter.t_s / (motor.inductance * motor.rated_current)
    }
}
