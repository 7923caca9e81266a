//! Greatest rotor speed at which control may begin without a trip.

use super::current_loop::LoopDesign;
use super::law::{Period, law};
use super::trust::TRAPEZOID_PER_FILTER;
use crate::spec::{EmfShape, EmfSource, InverterSpec, Spec};
use std::f64::consts::{FRAC_PI_3, TAU};

/// Turn per period over the filter's share beyond which the estimate, which is advanced at the
/// speed of its own length, can lag the EMF for good. For a sine, w^2/f^2 = (1 + r)/(r^2 (1 - r)),
/// with r of the EMF's length, has a solution below 1 from 3.33 on; trapezoids were simulated.
fn loses(shape: EmfShape) -> f64 {
    match shape {
        EmfShape::Sinusoidal | EmfShape::Harmonics(_) => 10.0 / 3.0,
        EmfShape::Trapezoidal { .. } => TRAPEZOID_PER_FILTER,
    }
}

/// Greatest error of such an estimate over the EMF: it overshoots. (Without the advance at most 1;
/// found by iterating z' = (1 - f) z exp(j (|z| - 1) w) + f from 0 for filters from 0.005 to 0.1
/// and turns up to 30 degrees.) The integral of a PI regulator beside a modelled EMF overshoots as
/// well when the sensors begin to give the angle.
const LACK: f64 = 1.17;

/// Largest line EMF over the bus for the integral of a PI regulator with a slow filter, which has to
/// learn the EMF. It overshoots, and beyond the bus the limit keeps a component along a wrong EMF
/// (simulated: trips from 0.88 on).
pub(super) const INTEGRATED_EMF: f64 = 0.85;

/// Largest line EMF over the bus that pair vectors outweigh at every angle: a phase voltage of half the bus is their
/// most, and at the edge of a sector the trapezoid's EMFs E, -E, -E have a zero-sum part of 4/3 E, 2/3 of the line EMF 2 E.
pub(super) const EMF_BY_PAIRS: f64 = 0.75;

/// Current of a braking speed loop over its limit: commutations overshoot (simulated).
const BRAKING: f64 = 1.15;

/// [`start_speed`] in whole rpm, at most the greatest speed of the drive.
pub(super) fn start_rpm(spec: &Spec, design: &LoopDesign) -> i64 {
    let speed = start_speed(spec, design).min(spec.inverter.maximum_speed);
    (speed * 60.0 / TAU + 1e-6).floor() as i64
}

/// Greatest rotor speed, mechanical rad/s, at which control may begin at set-point 0 without a
/// trip.
///
/// A drive that models the EMF waits for the rotor's angle where it turns fast
/// ([`Spec::waiting_speed`]), and knows the EMF then. Its sensors measure no speed below `minimum_speed`, so
/// up to there it must be able to begin without the EMF.
fn start_speed(spec: &Spec, design: &LoopDesign) -> f64 {
    let begins = blind_start(spec, design);
    let inverter = &spec.inverter;
    let has_angle = spec.angle_sensor().is_some();
    match spec.waiting_speed() {
        Some(from) if has_angle || inverter.minimum_speed <= from.max(begins) => {
            emf_within_bus(spec, 1.0)
        }
        _ => begins,
    }
}

/// Speed up to which a part of the lowest bus, as far as legs reach, exceeds the EMF between two terminals; at most
/// the greatest speed of the drive.
fn emf_within_bus(spec: &Spec, part: f64) -> f64 {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let line = motor.emf_shape.line_to_line_peak() * motor.emf_constant;
    let lowest = spec.reach_share() * inverter.lowest_bus();
    (part * lowest / line).min(inverter.maximum_speed)
}

/// Greatest rotor speed, mechanical rad/s, at which control may begin without the EMF.
///
/// The EMF is unknown at the first command: no estimate yet, no speed from the
/// Hall sensors. Later knowledge only helps, and a slow filter may never gain it. So the current
/// is the closed loop's response to an EMF that appears at once and turns: for prediction without
/// an EMF, one period of it before the first sample that shows it and, with delay 1, one more. The
/// part of the lowest bus that legs reach must exceed the whole EMF; beyond that diodes conduct or voltage is missing, and
/// nothing is promised. Controllers of whole vectors add the step of one vector, or with two
/// vectors the greatest distance from the line between them. A speed loop brakes once it knows the
/// speed, a sector later at the earliest, when a slow filter has not learned the EMF yet. Samples
/// lie where the pulse ripple crosses its mean.
fn blind_start(spec: &Spec, design: &LoopDesign) -> f64 {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let options = spec.controller.common();
    let most = emf_within_bus(spec, 1.0);
    let turn = most * f64::from(motor.pole_pairs) * inverter.t_s;
    let filter = options.emf_filter;
    let estimates = options.emf == EmfSource::Estimated;
    let loses = estimates && turn > loses(motor.emf_shape) * filter;
    let slow = estimates && turn > filter;
    let law = law(&spec.controller);
    // The observer starts when the sensors give the speed.
    let resting = LoopDesign {
        observer_gain: 0.0,
        ..design.clone()
    };
    let start = law.start(slow);
    let met = emf_within_bus(spec, start.part_of_bus);
    let periods = f64::from(options.delay + 1);
    let vector = design.plant.gain * 2.0 / 3.0 * spec.reach_share() * inverter.greatest_bus();
    let per_volt = law
        .linear(spec, &resting)
        .map_or(design.plant.gain * periods, |linear| {
            linear.greatest_response(spec, turn)
        });
    let own = start.current
        + match law.period() {
            Period::Pulses | Period::Intervals => 0.0,
            // A pair shares the period with its own zero only: the voltage may lie 30 degrees off
            // that line.
            Period::TwoVectors => vector * 3_f64.sqrt() / 4.0,
            Period::OneVector => vector,
        };
    let lack = if loses || start.integrates { LACK } else { 1.0 };
    // A floating leg hides its EMF for one period more.
    let hidden = if loses && start.hides_leg {
        1.0 + 1.0 / periods
    } else {
        1.0
    };
    let per_volt = per_volt * lack * hidden;
    let rounded = rounding(inverter, design.plant.gain * periods);
    let room = (inverter.trip_current - rounded - own).max(0.0);
    let room = if options.speed.is_some() && slow {
        (room - BRAKING * inverter.max_current).max(0.0)
    } else {
        room
    };
    let peak = peak(motor.emf_shape) * motor.emf_constant;
    (room / (peak * per_volt)).min(met)
}

/// What rounding adds to a current, ampere; `gain`: ampere per volt until the next command takes effect.
///
/// The third phase's current is the sum of two, each half a count off; three compare values, each half a count off,
/// put a phase voltage two thirds of a count off.
fn rounding(inverter: &InverterSpec, gain: f64) -> f64 {
    let count = inverter.greatest_bus() / f64::from(inverter.timer_period);
    inverter.adc_gain.abs() + gain * 2.0 / 3.0 * count
}

/// Peak of the zero-sum part of a phase's unit EMF, which drives current.
fn peak(shape: EmfShape) -> f64 {
    match shape {
        EmfShape::Sinusoidal => 1.0,
        // Piecewise linear, it peaks at the end of a ramp of one of the phases.
        EmfShape::Trapezoidal { flat_top_deg } => {
            let ramp = (180.0 - flat_top_deg).to_radians() / 2.0;
            let crossings = (0..6).map(|n| f64::from(n) * FRAC_PI_3);
            let ends = crossings.flat_map(|angle| [angle - ramp, angle + ramp]);
            ends.map(|angle| shape.zero_sum(angle)[0].abs())
                .fold(0.0, f64::max)
        }
        EmfShape::Harmonics(_) => {
            let angles = (0..3600).map(|step| f64::from(step).to_radians() / 10.0);
            angles
                .map(|angle| shape.zero_sum(angle)[0].abs())
                .fold(0.0, f64::max)
        }
    }
}
