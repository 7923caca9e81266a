//! The PI speed regulator (shared semantics page, "Speed loop").

use super::rotor::speed_word;
use super::set_point::{SetPointWords, SpeedWords};
use super::speed_ramp::SpeedRamp;
use super::{Allowed, Lowering, Rotor, round_down};
use crate::diagnostics::{engineering, significant};
use crate::ir::{Coefficient, Exact, Expr, Interval, Memory, Named, Real, named};
use crate::spec::{Spec, SpeedLoop};
use std::f64::consts::TAU;

/// Bits of the integral, with headroom of one bit for its increment.
const INTEGRAL_BITS: u32 = 29;
/// Base-2 logarithm of the anti-windup gain over the integral gain.
const TRACKING_LOG2: u32 = 2;

/// The regulator: options and integral.
#[derive(Clone, Copy, Debug)]
pub struct SpeedRegulator<'b> {
    options: SpeedLoop,
    integral: Memory<'b>,
    /// Fraction bits of the integral beyond those of voltages.
    extra: u32,
    words: SpeedWords<'b>,
    ramp: Option<SpeedRamp<'b>>,
    /// The greatest set-point word.
    top: i64,
    /// The set-point's gain, V/A.
    stiffness: f64,
}

/// Results of the regulator.
#[derive(Clone, Debug)]
pub struct Regulated<'b> {
    /// The regulated current set-point, words of voltage.
    pub j: Expr<'b>,
    /// The speed, signed, words of speed.
    pub speed: Expr<'b>,
    /// State words of integral and ramp, and their new values.
    pub words: Vec<(Memory<'b>, Expr<'b>)>,
}

impl<'b> SpeedRegulator<'b> {
    /// Declares the integral.
    pub fn new(
        l: &Lowering<'b>,
        options: SpeedLoop,
        words: SpeedWords<'b>,
        set_point: &SetPointWords<'b>,
    ) -> Self {
        let top = set_point.top;
        let range = Interval::symmetric(top);
        let meaning = "integral of the speed regulator";
        let extra = l.extra_bits("speed_integral", range, INTEGRAL_BITS, meaning);
        let range = Interval::symmetric(top << extra);
        let doc =
            "Integral of the speed regulator, words of voltage with additional fraction bits.";
        let integral = l.b.memory("speed_integral", 0, range, doc);
        let limit = options.acceleration_limit;
        let ramp = limit.map(|limit| SpeedRamp::new(l, limit, words.most));
        Self {
            options,
            integral,
            extra,
            words,
            ramp,
            top,
            stiffness: set_point.gain.value,
        }
    }

    /// 2 pi f J/k_t, A s/rad.
    fn gain(&self, spec: &Spec) -> f64 {
        TAU * self.options.bandwidth * self.options.inertia / spec.torque_constant()
    }

    fn coefficients(&self, l: &Lowering<'b>) -> [Coefficient; 2] {
        let gain = self.gain(l.spec);
        let k_speed = l.scaled_coefficient(
            "k_speed",
            gain * speed_word(l.spec) * self.stiffness * l.scale.voltage(),
            32,
            [
                "Proportional gain of the speed regulator: 2 pi f J/k_t.",
                &format!("2 pi f J/k_t = {}", engineering(gain, "A s/rad")),
            ],
            [
                "2 pi f J/k_t W K/w 2^f_v",
                "words of voltage per word of speed",
            ],
        );
        let share = TAU * self.options.bandwidth * l.spec.inverter.t_s / 4.0;
        let k_share = l.coefficient(
            "k_speed_share",
            share * f64::from(self.extra).exp2(),
            32,
            "Integral gain of the speed regulator per period, over the proportional gain.",
            &format!("2 pi f Ts/4 2^n = {} 2^{}", significant(share), self.extra),
        );
        [k_speed, k_share]
    }

    /// Limit of the speed error.
    fn greatest_error(&self, l: &Lowering<'b>) -> Expr<'b> {
        let word = speed_word(l.spec);
        let error = 2.0 * l.spec.inverter.max_current / (self.gain(l.spec) * word);
        let raw = round_down(error).min(30_f64.exp2()) as i64;
        let doc = format!(
            "Limit of the speed error, {}: the proportional part is then twice the largest current; words of speed.",
            engineering(raw as f64 * word, "rad/s")
        );
        l.rounded_number("error_max", raw, Exact::Number(Real::of(error)), &doc)
    }

    fn greatest_integral(&self, l: &Lowering<'b>) -> Expr<'b> {
        let exact = l.spec.inverter.max_current
            * self.stiffness
            * l.scale.voltage()
            * f64::from(self.extra).exp2();
        let doc = "Limit of the integral: the largest current by itself.";
        let (name, top) = ("speed_integral_max", self.top << self.extra);
        l.rounded_number(name, top, Exact::Number(Real::of(exact)), doc)
    }

    /// The current set-point from the speed error, within +-`most` and what the bus allows.
    pub fn regulate(
        &self,
        l: &Lowering<'b>,
        rotor: &Rotor<'b>,
        most: Expr<'b>,
        allowed: Option<Allowed<'b>>,
    ) -> Regulated<'b> {
        let [k_speed, k_share] = self.coefficients(l);
        let reference = self.words.reference;
        let ramped = (self.ramp).map(|ramp| ramp.follow(l, rotor, reference));
        l.b.stage(
            "regulate_speed",
            &[
                "PI speed regulator. Its output is limited to the current set-point; at the limit the integral tracks it",
                "(anti-windup). An unknown speed counts as 0.",
            ],
        );
        let integral = self.integral.read();
        let whole = match self.extra {
            0 => integral,
            extra => integral >> extra,
        };
        let (speed, wanted) = if let Some(ramped) = ramped {
            (ramped.speed, ramped.wanted)
        } else {
            (rotor.signed_speed(), reference.read())
        };
        named! {
            let speed_error = (wanted - speed).within(self.greatest_error(l));
            let speed_part = k_speed * speed_error;
            let j_open = speed_part + whole;
            let j_most = most.abs();
            let j_regulated = j_open.within(j_most);
        }
        let j_regulated = match allowed {
            Some(allowed) => allowed.limit(j_regulated).named("j_faded"),
            None => j_regulated,
        };
        let tracking = (j_regulated - j_open) << TRACKING_LOG2;
        let moved = integral + k_share * (speed_part + tracking);
        named! {
            let speed_integral_moved = moved.within(self.greatest_integral(l));
        }
        let mut words = vec![(self.integral, speed_integral_moved)];
        words.extend(ramped.map(|ramped| ramped.words).into_iter().flatten());
        Regulated {
            j: j_regulated,
            speed,
            words,
        }
    }
}
