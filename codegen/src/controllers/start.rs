//! How fast the rotor may turn when control begins, so that no current trips the drive.

use super::current_loop::LoopDesign;
use crate::design::emf::zero_sum_shape;
use crate::spec::{ControllerSpec, EmfSource, Spec};
use std::f64::consts::TAU;

/// Angles at which the EMF is looked at.
const ANGLES: u32 = 720;

/// A proportional regulator that meets an EMF that it learns late, or not at all, overshoots what it settles at
/// by this factor.
const OVERSHOOT: f64 = 1.3;

/// [`start_speed`] in whole rpm, at most the greatest speed of the drive.
pub(super) fn start_rpm(spec: &Spec, design: &LoopDesign) -> i64 {
    let speed = start_speed(spec, design).min(spec.inverter.maximum_speed);
    (speed * 60.0 / TAU + 1e-6).floor() as i64
}

/// Greatest speed of the rotor, mechanical rad/s, at which control may begin with set-point 0 without a trip.
///
/// The first command finds no EMF: none was estimated yet, and the Hall sensors have told no speed. So the
/// EMF, at most z k_phase omega (z the peak of the shape's zero-sum part), moves a current by b z k_phase omega
/// per period, until the command that knows it, or the current, takes effect. What a controller of whole
/// vectors adds of its own is the step of one vector.
fn start_speed(spec: &Spec, design: &LoopDesign) -> f64 {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let angles = (0..ANGLES).map(|n| f64::from(n) * TAU / f64::from(ANGLES));
    let peak = angles
        .map(|angle| zero_sum_shape(motor.emf_shape, angle).abs())
        .fold(0.0, f64::max);
    let options = spec.controller.common();
    let periods = f64::from(options.delay + 1);
    let vector = design.plant.gain * 2.0 / 3.0 * inverter.v_bus;
    let (per_volt, own) = match &spec.controller {
        ControllerSpec::Pdcc(_) => (design.plant.gain * periods, 0.0),
        ControllerSpec::FcsMpc(_) => (design.plant.gain * periods, vector),
        ControllerSpec::Phcc(phcc) => (design.plant.gain * periods, vector + phcc.band),
        ControllerSpec::PiPwm(pi) => {
            let settled = OVERSHOOT / pi.proportional_gain(motor);
            let at_once = design.plant.gain * periods;
            let knows =
                pi.feed_forward && options.emf == EmfSource::Estimated && options.emf_filter >= 1.0;
            (if knows { at_once } else { settled.max(at_once) }, 0.0)
        }
    };
    let room = (inverter.trip_current - own).max(0.0);
    room / (peak * motor.emf_constant * per_volt)
}
