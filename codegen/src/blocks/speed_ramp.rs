//! Ramp of the speed set-point (shared semantics page, "Acceleration limit").

use super::rotor::{greatest_speed, speed_word};
use super::slew::approached;
use super::{Lowering, Rotor};
use crate::diagnostics::rpm;
use crate::interface::Rounding;
use crate::ir::{Exact, Expr, Interval, Memory, Named, Param, Real, named};

/// Bits of the set-point in force: with a slow ramp a period's step still has several.
const BITS: u32 = 29;

/// Fraction bits of a speed.
const SPEED_BITS: i32 = 32;

/// The speed set-point in force, which follows the set-point at a limited rate.
#[derive(Clone, Copy, Debug)]
pub struct SpeedRamp<'b> {
    /// Mechanical rad/s2.
    limit: f64,
    in_force: Memory<'b>,
    /// 1 once controlled, 2 once the speed is known, too: the ramp begins at the rotor's speed then.
    begun: Memory<'b>,
    /// Fraction bits beyond those of speeds.
    extra: u32,
}

/// Results of the ramp.
#[derive(Clone, Copy, Debug)]
pub struct Ramped<'b> {
    /// The set-point in force, words of speed.
    pub wanted: Expr<'b>,
    /// The speed, signed, words of speed.
    pub speed: Expr<'b>,
    /// State words and their new values.
    pub words: [(Memory<'b>, Expr<'b>); 2],
}

impl<'b> SpeedRamp<'b> {
    /// Declares the words; `limit` in rad/s2, `most` the greatest set-point.
    pub fn new(l: &Lowering<'b>, limit: f64, most: i64) -> Self {
        let fastest = greatest_speed(l.spec);
        let range = Interval::symmetric(most.max(fastest));
        let extra = BITS.saturating_sub(range.bits());
        let meaning = "speed set-point in force, base one turn per tick";
        let bits = SPEED_BITS + extra as i32;
        l.format("speed_in_force", 32, bits, Rounding::RoundHalfUp, meaning);
        let range = Interval::symmetric(range.high << extra);
        let doc = "Speed set-point in force, words of speed with additional fraction bits.";
        let in_force = l.b.memory("speed_in_force", 0, range, doc);
        let doc = "0 without control, then 1, and 2 once the speed is known: the ramp begins at the rotor's speed.";
        let begun = l.b.memory("ramp_begun", 0, Interval::new(0, 2), doc);
        Self {
            limit,
            in_force,
            begun,
            extra,
        }
    }

    /// Greatest change in a period; at least one word, at most what reaches every set-point at once.
    fn step(&self, l: &Lowering<'b>) -> Expr<'b> {
        let words = f64::from(self.extra).exp2() / speed_word(l.spec);
        let t_s = l.spec.inverter.t_s;
        let exact = self.limit * t_s * words;
        let most = 2 * self.in_force.read().interval().high;
        let raw = (exact + 0.5).floor().clamp(1.0, most as f64) as i64;
        let doc = format!(
            "Greatest change of the speed set-point in a period: {}/s.",
            rpm(raw as f64 / words / t_s)
        );
        l.rounded_number("speed_step", raw, Exact::Number(Real::of(exact)), &doc)
    }

    /// The set-point in force, from the set-point.
    pub fn follow(&self, l: &Lowering<'b>, rotor: &Rotor<'b>, reference: Param<'b>) -> Ramped<'b> {
        l.b.stage(
            "limit_acceleration",
            &[
                "The speed set-point in force approaches the set-point by at most one step a period. It begins at the",
                "rotor's speed, at the latest when that is known.",
            ],
        );
        let step = self.step(l);
        let shifted = |word: Expr<'b>| match self.extra {
            0 => word,
            extra => word << extra,
        };
        let speed = rotor.signed_speed();
        named! {
            let ramp_known = rotor.tracking.choose(2, 1);
            let begins = self.begun.read().is_below(ramp_known);
            let speed_before = begins.choose(shifted(speed), self.in_force.read());
            let speed_followed = approached(shifted(reference.read()), speed_before, step);
            let ramp_begun_next = self.begun.read().max(ramp_known);
        }
        let wanted = match self.extra {
            0 => speed_followed,
            extra => (speed_followed >> extra).named("speed_wanted"),
        };
        Ramped {
            wanted,
            speed,
            words: [
                (self.in_force, speed_followed),
                (self.begun, ramp_begun_next),
            ],
        }
    }
}
