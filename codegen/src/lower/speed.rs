//! The speed regulator: the current that the speed's error asks for (semantics of predictive deadbeat, "Speed loop").

use super::set_point::SpeedWords;
use super::{Lowering, round_down};
use crate::diagnostics::{engineering, significant};
use crate::interface::Rounding;
use crate::ir::{Exact, Interval, Real, StateId, Value};
use crate::spec::{Spec, SpeedLoop};
use std::f64::consts::TAU;

/// Bits of the integral: one is kept free for what is added to it.
const INTEGRAL_BITS: u32 = 29;
/// Base-2 logarithm of how many times faster the integral follows the limit than it integrates.
const TRACKING_LOG2: u32 = 2;

/// The mechanical speed of one word of `omega`, rad/s.
pub(super) fn speed_word(spec: &Spec) -> f64 {
    let tick = spec.inverter.t_s / spec.inverter.hall_capture.ticks_per_period();
    TAU / (32_f64.exp2() * tick * f64::from(spec.motor.pole_pairs))
}

/// The state of the regulator.
#[derive(Clone, Copy, Debug)]
pub struct SpeedState {
    integral: StateId,
    /// Fraction bits that the integral has beyond those of voltages.
    extra: u32,
    top: i64,
}

/// What the regulator decides.
#[derive(Clone, Copy, Debug)]
pub struct Regulated {
    /// The set-point, in place of the one that is set.
    pub j: Value,
    /// The speed, signed, words of speed.
    pub speed: Value,
    /// Its integral, and the state that keeps it.
    pub integral: (StateId, Value),
}

impl Lowering<'_> {
    /// Declares the integral; the greatest set-point is `top`.
    pub fn speed_state(&mut self, top: i64) -> SpeedState {
        let bits = Interval::symmetric(top).bits();
        let extra = INTEGRAL_BITS.saturating_sub(bits).min(12);
        let frac_bits = (self.scale.voltage_bits + extra) as i32;
        let meaning = "integral of the speed regulator, base one timer count of voltage";
        self.format(
            "speed_integral",
            32,
            frac_bits,
            Rounding::RoundHalfUp,
            meaning,
        );
        let integral = self.state(
            "speed_integral",
            0,
            Interval::symmetric(top << extra),
            "Integral of the speed regulator, words of voltage with more fraction bits.",
        );
        SpeedState {
            integral,
            extra,
            top,
        }
    }

    /// The set-point that the error of the speed asks for.
    pub fn regulate_speed(
        &mut self,
        options: SpeedLoop,
        stiffness: f64,
        words: SpeedWords,
        state: SpeedState,
        [direction, omega, most]: [Value; 3],
    ) -> Regulated {
        let (spec, word) = (self.spec, speed_word(self.spec));
        let bandwidth = TAU * options.bandwidth;
        let gain = bandwidth * options.inertia / spec.torque_constant();
        let k_speed = self.scaled_coefficient(
            "k_speed",
            gain * word * stiffness * self.scale.voltage(),
            32,
            [
                "Set-point per error of speed: 2 pi f J/k_t.",
                &format!("2 pi f J/k_t = {}", engineering(gain, "A s/rad")),
            ],
            [
                "2 pi f J/k_t W K/w 2^f_v",
                "words of voltage per word of speed",
            ],
        );
        let share = bandwidth * spec.inverter.t_s / 4.0;
        let k_share = self.coefficient(
            "k_speed_share",
            share * f64::from(state.extra).exp2(),
            32,
            "Share of it that one period integrates, in the integral's words.",
            &format!("2 pi f Ts/4 2^n = {} 2^{}", significant(share), state.extra),
        );
        self.b.stage(
            "regulate_speed",
            &[
                "PI regulator of the speed: what it asks for is limited to the current that is set, and where it is the integral follows",
                "the limit. Until the speed is known it counts as none.",
            ],
        );
        let speed = self.b.mul(direction, omega, 0);
        self.b.name("speed", speed);
        let wanted = self.b.param(words.reference);
        let error = self.b.sub(wanted, speed);
        let most_error = 2.0 * spec.inverter.max_current / (gain * word);
        let raw = round_down(most_error).min(30_f64.exp2()) as i64;
        let doc = format!(
            "Greatest error of speed that counts, {}: it asks for twice the greatest current, words of speed.",
            engineering(raw as f64 * word, "rad/s")
        );
        let exact = Exact::Number(Real::of(most_error));
        let limit = self.rounded_number("error_max", raw, exact, &doc);
        let error = self.b.clamp_both(error, limit);
        self.b.name("speed_error", error);
        let part = self.times(k_speed, error);
        self.b.name("speed_part", part);
        let integral = self.b.state(state.integral);
        let whole = match state.extra {
            0 => integral,
            extra => self.b.shift_right(integral, extra),
        };
        let open = self.b.add(part, whole);
        self.b.name("j_open", open);
        let high = self.b.abs(most);
        self.b.name("j_most", high);
        let low = self.b.neg(high);
        let j = self.b.clamp(open, low, high);
        self.b.name("j_regulated", j);
        let excess = self.b.sub(j, open);
        let tracking = self.b.shift_left(excess, TRACKING_LOG2);
        let taken = self.b.add(part, tracking);
        let step = self.times(k_share, taken);
        let moved = self.b.add(integral, step);
        let top = state.top << state.extra;
        let exact = spec.inverter.max_current
            * stiffness
            * self.scale.voltage()
            * f64::from(state.extra).exp2();
        let doc = "The integral that alone asks for the greatest current.";
        let exact = Exact::Number(Real::of(exact));
        let limit = self.rounded_number("speed_integral_max", top, exact, doc);
        let moved = self.b.clamp_both(moved, limit);
        self.b.name("speed_integral_moved", moved);
        Regulated {
            j,
            speed,
            integral: (state.integral, moved),
        }
    }
}
