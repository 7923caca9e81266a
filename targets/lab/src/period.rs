//! Whether the control period is short enough for the motor, and the remedy where it is not.

use crate::text::significant;
use hexagen_codegen::diagnostics::{at_most, engineering};
use hexagen_codegen::spec::{RotorSensing, Spec};

/// Electrical degrees in a control period at rated speed, up to which a drive is right.
const TURN: f64 = 15.0;

/// Change of the current in a PWM period with the bus across two phases, over the rated current,
/// up to which a drive is right. Beyond it the pulses' ripple is so large, and decays so fast, that
/// the mean of the current is not its sample, whatever the control does.
const SWING: f64 = 5.0;

/// Turn of the rotor in a control period at rated speed, electrical degrees.
pub fn degrees_per_period(spec: &Spec) -> f64 {
    spec.motor.rated_turn(spec.inverter.t_s)
}

fn pwm_period(spec: &Spec) -> f64 {
    spec.inverter.t_s / f64::from(spec.inverter.pwm_per_control)
}

fn swing(spec: &Spec) -> f64 {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let rise = inverter.v_bus * pwm_period(spec) / (2.0 * motor.inductance);
    rise / motor.rated_current
}

/// Whether a default drive can be right: it has an edge timer or an angle sensor, and its period is
/// short enough for the motor.
pub fn can_be_right(spec: &Spec) -> bool {
    let is_short = degrees_per_period(spec) <= TURN && swing(spec) <= SWING;
    spec.inverter.rotor_sensing != RotorSensing::SampledHalls && is_short
}

/// A clause on a period that is too long for the motor; none where it is not. Of both limits the one
/// that is missed by more.
pub(crate) fn long_period(spec: &Spec) -> Option<String> {
    let [turn, swing] = [degrees_per_period(spec) / TURN, swing(spec) / SWING];
    if turn > 1.0 && turn >= swing {
        return Some(far_turn(spec, turn));
    }
    (swing > 1.0).then(|| {
        format!(
            "a PWM period changes the current by {} times the rated one: use `f_pwm` of at least {}",
            significant(swing * SWING, 2),
            engineering(two_digits(swing / pwm_period(spec)), "Hz"),
        )
    })
}

/// A rotor that turns too far by the factor `excess`. Its remedy: fewer PWM periods in a control
/// period, if it has several, or else a PWM frequency.
fn far_turn(spec: &Spec, excess: f64) -> String {
    let degrees = degrees_per_period(spec);
    let per_control = f64::from(spec.inverter.pwm_per_control);
    let fewer = (per_control / excess).floor();
    let remedy = if fewer >= 1.0 {
        let then = significant(degrees * fewer / per_control, 2);
        format!("lower `pwm_per_control` to {fewer} ({then} degrees)")
    } else {
        let f_pwm = two_digits(excess / spec.inverter.t_s);
        let of_each = if per_control > 1.0 {
            " and `pwm_per_control` of 1"
        } else {
            ""
        };
        let (least, period) = (engineering(f_pwm, "Hz"), at_most(1.0 / f_pwm));
        format!(
            "use `f_pwm` of at least {least}{of_each} ({})",
            engineering(period, "s")
        )
    };
    let finer = match spec.inverter.rotor_sensing {
        RotorSensing::SampledHalls => ", or state `hall_timer_clock`, a timer of the Hall edges",
        _ => "",
    };
    format!(
        "at rated speed the rotor turns {} electrical degrees in a control period: {remedy}{finer}",
        significant(degrees, 2)
    )
}

/// The least number of two digits that is not below.
fn two_digits(least: f64) -> f64 {
    let step = 10_f64.powf(least.log10().floor() - 1.0);
    (least / step).ceil() * step
}
