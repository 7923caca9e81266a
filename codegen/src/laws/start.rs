//! How fast the rotor may turn when control begins, so that no current trips the drive.

use super::current_loop::LoopDesign;
use super::law::{Period, law};
use super::trust::TRAPEZOID_PER_FILTER;
use crate::design::emf::zero_sum_shape;
use crate::spec::{EmfShape, EmfSource, Spec};
use std::f64::consts::{FRAC_PI_3, TAU};

/// Where a turn exceeds so many times the share that the filter lets in, an estimate, which is moved on at the speed that
/// its own length tells, can stay behind the EMF for good. Of a sine w^2/f^2 = (1 + r)/(r^2 (1 - r)) has a solution r
/// below 1, for r of the EMF's length, from 3.33 on; trapezoids were simulated.
fn loses(shape: EmfShape) -> f64 {
    match shape {
        EmfShape::Sinusoidal => 10.0 / 3.0,
        EmfShape::Trapezoidal { .. } => TRAPEZOID_PER_FILTER,
    }
}

/// Greatest lack of such an estimate, of the EMF: it swings past its rest. (Without moving on it is at most 1; found by
/// iterating z' = (1 - f) z exp(j (|z| - 1) w) + f from 0 for filters from 0.005 to 0.1 and turns up to 30 degrees.) The
/// integral beside a modelled EMF that the sensors begin to tell swings as well: it still holds what the model lacked.
const LACK: f64 = 1.17;

/// Part of the bus that leaves room for an integral that has to stand for the EMF: a PI regulator's behind a filter that
/// follows more slowly than the EMF turns, or a modelled EMF's until the sensors tell it. It overshoots, and past the bus
/// the limit keeps the voltage along an EMF that is not there (simulated: trips from 0.88 on).
pub(super) const INTEGRATED_EMF: f64 = 0.85;

/// Greatest current of a braking speed loop over the greatest that it asks for: commutations overshoot (simulated).
const BRAKING: f64 = 1.15;

/// [`start_speed`] in whole rpm, at most the greatest speed of the drive.
pub(super) fn start_rpm(spec: &Spec, design: &LoopDesign) -> i64 {
    let speed = start_speed(spec, design).min(spec.inverter.maximum_speed);
    (speed * 60.0 / TAU + 1e-6).floor() as i64
}

/// Greatest speed of the rotor, mechanical rad/s, at which control may begin with set-point 0 without a trip.
///
/// The first command finds no EMF: none was estimated yet, and the Hall sensors have told no speed. What is found out
/// of it later only helps, if it ever is: a slow filter loses an EMF that turns faster than it follows. So the current
/// is what the closed loop lets an EMF drive that appears at once, and turns: of prediction without knowledge, one period
/// of it before the sample that shows it and, with a delay, one more. The inverter can hold that current where its lowest
/// bus can meet the whole EMF; beyond, diodes conduct or the voltage is missing, and nothing is promised. Controllers of
/// whole vectors add the step of one vector, modulated the greatest distance from the line of two. A speed loop
/// brakes as soon as it knows the speed, a sector later at the earliest: a filter that follows more slowly than the EMF
/// turns has not met it by then. Samples lie where the ripple of pulses crosses its mean.
fn start_speed(spec: &Spec, design: &LoopDesign) -> f64 {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let line = motor.emf_shape.line_to_line_peak() * motor.emf_constant;
    let options = spec.controller.common();
    let most = (inverter.lowest_bus() / line).min(inverter.maximum_speed);
    let turn = most * f64::from(motor.pole_pairs) * inverter.t_s;
    let filter = options.emf_filter;
    let estimates = options.emf == EmfSource::Estimated;
    let loses = estimates && turn > loses(motor.emf_shape) * filter;
    let slow = estimates && turn > filter;
    let law = law(&spec.controller);
    let start = law.start(slow);
    let met = most.min(start.part_of_bus * inverter.lowest_bus() / line);
    let periods = f64::from(options.delay + 1);
    let vector = design.plant.gain * 2.0 / 3.0 * inverter.greatest_bus();
    let per_volt = law
        .linear(spec, design)
        .map_or(design.plant.gain * periods, |linear| {
            linear.greatest_response(spec, turn)
        });
    let own = start.current
        + match law.period() {
            Period::Pulses => 0.0,
            // A pair shares the period with its own zero alone: a voltage of that length may lie 30 degrees off their line.
            Period::TwoVectors => vector * 3_f64.sqrt() / 4.0,
            Period::OneVector => vector,
        };
    let lack = if loses || start.integrates { LACK } else { 1.0 };
    // A leg that floats hides its EMF for one period more.
    let hidden = if loses && start.hides_leg {
        1.0 + 1.0 / periods
    } else {
        1.0
    };
    let per_volt = per_volt * lack * hidden;
    // The third phase's current is the sum of two, each half a count off; of three compare values, each half a count off, a
    // phase has two thirds of a count.
    let count = inverter.greatest_bus() / f64::from(inverter.timer_period);
    let rounded = inverter.adc_gain.abs() + design.plant.gain * periods * 2.0 / 3.0 * count;
    let room = (inverter.trip_current - rounded - own).max(0.0);
    let room = if options.speed.is_some() && slow {
        (room - BRAKING * inverter.max_current).max(0.0)
    } else {
        room
    };
    let peak = peak(motor.emf_shape) * motor.emf_constant;
    (room / (peak * per_volt)).min(met)
}

/// Peak of the part of a phase's unit EMF that drives current.
fn peak(shape: EmfShape) -> f64 {
    match shape {
        EmfShape::Sinusoidal => 1.0,
        // Made of straight lines, it peaks at the end of a ramp of one of the phases.
        EmfShape::Trapezoidal { flat_top_deg } => {
            let ramp = (180.0 - flat_top_deg).to_radians() / 2.0;
            let crossings = (0..6).map(|n| f64::from(n) * FRAC_PI_3);
            let ends = crossings.flat_map(|angle| [angle - ramp, angle + ramp]);
            ends.map(|angle| zero_sum_shape(shape, angle).abs())
                .fold(0.0, f64::max)
        }
    }
}
