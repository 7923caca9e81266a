//! Torque ripple of a drive whose Hall edges are seen at samples only.

use super::{ControllerSpec, Reference, RotorSensing, Spec};

/// Greatest ripple of a drive that is right, over the mean torque, where the rotor turns little in a control period.
pub const MOST_RIPPLE: f64 = 0.03;

/// Ripple per radian of a jump of the angle and per unit of [`Spec::coarseness`] (simulated over the library's motors
/// at speeds from 22 to 100 % of the rated one): of a law that predicts the current, and of PI, whose integrator
/// follows later.
const OF_CURRENT: [f64; 2] = [0.75, 1.6];

impl Spec {
    /// Peak-to-peak ripple at rated speed over the mean torque, of a proportional current and an EMF that both follow
    /// the rotor's angle, with Hall edges that are seen at samples only; `None` for any other drive. It is that of the
    /// mode that ripples more.
    ///
    /// An edge is late by up to a control period, in which the rotor turns by d radians, so the angle jumps by up to
    /// d. The set-point then misses the proportional current by d times the steepness of the EMF's length, and the
    /// modelled EMF misses the EMF's length by as much, which moves the current by that times the coarseness before
    /// the next sample shows it: in braking both have one sign. The modelled EMF also turns by d, which moves the
    /// current across the torque's and so, turned on, the torque.
    pub fn sampled_ripple(&self) -> Option<f64> {
        let common = self.controller.common();
        let is_sampled = self.inverter.rotor_sensing == RotorSensing::SampledHalls;
        let follows = common.emf.is_modelled() && common.reference == Reference::Proportional;
        (is_sampled && follows && self.controller.modulates()).then(|| {
            let jump = self.motor.rated_turn(self.inverter.t_s).to_radians();
            let (steep, coarse) = (self.motor.emf_shape.steepness(), self.coarseness());
            let [predicted, integrated] = OF_CURRENT;
            let across = match self.controller {
                ControllerSpec::PiPwm(_) => integrated,
                _ => predicted,
            };
            jump * (steep * (1.0 + coarse) + across * coarse)
        })
    }

    /// The same where it is told of: where it is more than [`MOST_RIPPLE`] in full percent, as the estimate is good to a
    /// tenth.
    pub fn told_sampled_ripple(&self) -> Option<f64> {
        let is_told = |ripple: &f64| (100.0 * ripple).round() > 100.0 * MOST_RIPPLE;
        self.sampled_ripple().filter(is_told)
    }

    /// Change of the current in a control period with the EMF of the rated speed across a phase, over the rated current.
    fn coarseness(&self) -> f64 {
        let motor = &self.motor;
        let emf = motor.emf_constant * motor.rated_speed;
        emf * self.inverter.t_s / (motor.inductance * motor.rated_current)
    }
}
