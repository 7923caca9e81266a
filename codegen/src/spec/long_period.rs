//! A control period that is too long for the motor, and the remedy.

use super::Spec;
use crate::diagnostics::{at_most, engineering};

/// Electrical degrees in a control period at rated speed, up to which a drive is right.
const TURN: f64 = 15.0;

/// Change of the current in a PWM period with the bus across two phases, over the rated current,
/// up to which a drive is right. Beyond it the pulses' ripple is so large, and decays so fast, that
/// the mean of the current is not its sample, whatever the control does.
const SWING: f64 = 5.0;

impl Spec {
    /// Turn of the rotor in a control period at rated speed, electrical degrees.
    pub fn degrees_per_period(&self) -> f64 {
        self.motor.rated_turn(self.inverter.t_s)
    }

    /// Change of the current in a PWM period with the bus across two phases, over the rated current.
    fn swing(&self) -> f64 {
        let rise = self.inverter.v_bus * self.inverter.pwm_period() / (2.0 * self.motor.inductance);
        rise / self.motor.rated_current
    }

    /// A clause on a control period that is too long for the motor; none where it is not. Of both limits the one that
    /// is missed by more.
    pub fn long_period(&self) -> Option<String> {
        let [turn, swing] = [self.degrees_per_period() / TURN, self.swing() / SWING];
        if turn > 1.0 && turn >= swing {
            return Some(self.far_turn(turn));
        }
        (swing > 1.0).then(|| {
            let least = two_digits(swing / self.inverter.pwm_period(), f64::ceil);
            format!(
                "a PWM period changes the current by {} times the rated one: use `f_pwm` of at least {}",
                two_digits(swing * SWING, f64::round),
                engineering(least, "Hz"),
            )
        })
    }

    /// A rotor that turns too far by the factor `excess`. Its remedy: fewer PWM periods in a control period, if it has
    /// several, or else a PWM frequency.
    fn far_turn(&self, excess: f64) -> String {
        let degrees = self.degrees_per_period();
        let per_control = f64::from(self.inverter.pwm_per_control);
        let fewer = (per_control / excess).floor();
        let remedy = if fewer >= 1.0 {
            let then = two_digits(degrees * fewer / per_control, f64::round);
            format!("lower `pwm_per_control` to {fewer} ({then} degrees)")
        } else {
            let f_pwm = two_digits(excess / self.inverter.t_s, f64::ceil);
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
        format!(
            "at rated speed the rotor turns {} electrical degrees in a control period: {remedy}",
            two_digits(degrees, f64::round)
        )
    }
}

/// A number of two digits near to this one.
fn two_digits(value: f64, round: fn(f64) -> f64) -> f64 {
    let digits = 1 - value.abs().log10().floor() as i32;
    // Divided by a whole power of ten, so that no digit of rounding is left.
    if digits >= 0 {
        let scale = 10_f64.powi(digits);
        round(value * scale) / scale
    } else {
        let scale = 10_f64.powi(-digits);
        round(value / scale) * scale
    }
}
