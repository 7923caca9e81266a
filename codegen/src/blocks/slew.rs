//! Slew rate of the current set-point (shared semantics page, "Slew rate").

use super::Lowering;
use super::set_point::SetPointWords;
use crate::diagnostics::engineering;
use crate::ir::{Exact, Expr, Interval, Memory, Named, Real, named};

/// Bits of the set-point in force: with a rate of the rated current in a minute a period's step still
/// has several.
const BITS: u32 = 29;

/// The set-point in force, which follows the set-point word at a limited rate.
#[derive(Clone, Copy, Debug)]
pub struct SlewLimit<'b> {
    /// Ampere per second.
    rate: f64,
    in_force: Memory<'b>,
    /// Its fraction bits beyond those of voltages.
    extra: u32,
    /// Greatest set-point word that a setter makes.
    top: i64,
    /// The set-point's gain, V/A.
    gain: f64,
}

/// A word that approaches a goal by at most a step.
pub(super) fn approached<'b>(goal: Expr<'b>, before: Expr<'b>, step: Expr<'b>) -> Expr<'b> {
    goal.max(before - step).min(before + step)
}

impl<'b> SlewLimit<'b> {
    /// Declares the word; `rate` in A/s.
    pub fn new(l: &Lowering<'b>, rate: f64, set_point: &SetPointWords<'b>) -> Self {
        let range = set_point.j.interval();
        let extra = l.extra_bits("j_in_force", range, BITS, "set-point in force");
        let doc = "Set-point in force, words of voltage with additional fraction bits.";
        let range = Interval::symmetric(range.high << extra);
        Self {
            rate,
            in_force: l.b.memory("j_in_force", 0, range, doc),
            extra,
            top: set_point.top,
            gain: set_point.gain.value,
        }
    }

    /// Greatest change in a period; at least one word, at most what reaches every set-point at once.
    fn step(&self, l: &Lowering<'b>) -> Expr<'b> {
        let words = self.gain * l.scale.voltage() * f64::from(self.extra).exp2();
        let exact = self.rate * l.spec.inverter.t_s * words;
        let most = 2 * (self.top << self.extra);
        let raw = (exact + 0.5).floor().clamp(1.0, most as f64) as i64;
        let doc = format!(
            "Greatest change of the set-point in a period, {}.",
            engineering(raw as f64 / words, "A")
        );
        l.rounded_number("slew_step", raw, Exact::Number(Real::of(exact)), &doc)
    }

    /// The set-point in force, and the word's new value, from the set-point word.
    pub fn follow(&self, l: &Lowering<'b>, j: Expr<'b>) -> (Expr<'b>, (Memory<'b>, Expr<'b>)) {
        let doc = "The set-point in force approaches the set-point by at most one step a period.";
        l.b.stage("limit_slew", &[doc]);
        let in_force = self.in_force.read();
        let step = self.step(l);
        let (goal, whole) = match self.extra {
            0 => (j, None),
            extra => (j << extra, Some(extra)),
        };
        named! {
            let j_followed = approached(goal, in_force, step);
        }
        let j_slewed = whole.map_or(j_followed, |extra| j_followed >> extra);
        (j_slewed.named("j_slewed"), (self.in_force, j_followed))
    }
}
