//! A control period that is too long for the motor, and the remedy.

use super::Spec;
use super::check::FEWEST_COUNTS;
use crate::diagnostics::{at_most, engineering};

/// Electrical degrees in a control period at rated speed, up to which a drive is right.
const TURN: f64 = 15.0;

/// Change of the current in a PWM period with the bus across two phases, over the rated current,
/// up to which a drive is right. Beyond it the pulses' ripple is so large, and decays so fast, that
/// the mean of the current is not its sample, whatever the control does.
const SWING: f64 = 5.0;

/// Period of the greatest `f_pwm`, second.
const SHORTEST: f64 = 2e-6;

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

    /// The shortest PWM period of this inverter, second: 100 counts of its timer, and 500 kHz at most.
    fn shortest_pwm_period(&self) -> f64 {
        let counts = f64::from(self.inverter.timer_period);
        (self.inverter.pwm_period() * FEWEST_COUNTS / counts).max(SHORTEST)
    }

    /// A clause on a control period that is too long for the motor; none where it is not. Of both limits the one that
    /// is missed by more. Its remedy is a period, as `f_pwm` and `sampling_time` both state one.
    pub fn long_period(&self) -> Option<String> {
        let [turn, swing] = [self.degrees_per_period() / TURN, self.swing() / SWING];
        let shortest = self.shortest_pwm_period();
        if turn > 1.0 && turn >= swing {
            let degrees = self.degrees_per_period();
            let most = self.inverter.t_s / turn;
            let remedy = if most < shortest * f64::from(self.inverter.pwm_per_control) {
                "none of this inverter is short enough: lower `rated_speed`".to_owned()
            } else {
                let per_control = self.inverter.pwm_per_control;
                let fewer = match per_control {
                    1 => "",
                    _ => ", or with a stated `f_pwm` a lower `pwm_per_control`",
                };
                format!(
                    "use one of at most {}{fewer}",
                    with_frequency(most, per_control)
                )
            };
            return Some(format!(
                "at rated speed the rotor turns {degrees:.1} electrical degrees in a control period: {remedy}"
            ));
        }
        (swing > 1.0).then(|| {
            let times = two_digits(swing * SWING, f64::round);
            let most = self.inverter.pwm_period() / swing;
            let remedy = if most < shortest {
                "none of this inverter is short enough: lower `bus_voltage`, or add inductance in the phases".to_owned()
            } else {
                format!("use one of at most {}", with_frequency(most, 1))
            };
            format!("a PWM period changes the current by {times} times the rated one: {remedy}")
        })
    }
}

/// A greatest period of so many PWM periods, second, with their frequency, both so that they are accepted when typed in.
fn with_frequency(period: f64, of_pwm: u32) -> String {
    let of_pwm = f64::from(of_pwm);
    let frequency = two_digits(of_pwm / period, f64::ceil);
    format!(
        "{} (`f_pwm` of at least {})",
        engineering(at_most(of_pwm / frequency), "s"),
        engineering(frequency, "Hz")
    )
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
