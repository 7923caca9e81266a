//! Advance of an estimated EMF from the last period to the present and the target period, by the
//! motor's shape at the speed of its own magnitude (shared semantics page, step 8).

use super::CurrentLoop;
use crate::blocks::{product_bound, round_down};
use crate::design::vectors::SECTOR_CURRENT;
use crate::ir::{Coefficient, Expr, Named, Phases, named};
use crate::spec::EmfShape;

/// The line EMF's limit, words of voltage, and the left shift (right if negative) that scales it to
/// a full word, q.
#[derive(Clone, Copy, Debug)]
struct LineRange {
    limit: i64,
    shift: i32,
}

impl<'b> CurrentLoop<'_, 'b> {
    fn line_range(&self) -> LineRange {
        let l = self.l;
        let limit = round_down(self.design.line_limit * l.scale.voltage()) as i64;
        let limit = limit.min(l.bus_interval().high);
        let bits = i64::BITS - limit.leading_zeros();
        LineRange {
            limit,
            shift: self.options.word as i32 - 1 - bits as i32,
        }
    }

    /// `k_slope`: words of voltage per upper word of the square of a shifted line EMF; of a sine,
    /// turn per shifted line EMF.
    fn slope_value(&self, range: LineRange) -> f64 {
        let word = 1.0 / self.l.scale.voltage();
        self.design.slope * word * f64::from(self.slope_exponent(range)).exp2()
    }

    fn slope_exponent(&self, range: LineRange) -> i32 {
        let factors = match self.l.spec.motor.emf_shape {
            EmfShape::Sinusoidal | EmfShape::Harmonics(_) => 1,
            EmfShape::Trapezoidal { .. } => 2,
        };
        self.options.word as i32 - factors * range.shift
    }

    /// Largest motion over one period of a phase EMF of at most `e`, words of voltage.
    pub(super) fn motion_bound(&self, e: i64) -> i64 {
        let (range, word) = (self.line_range(), self.options.word);
        let factor = if range.shift < 0 {
            (range.limit >> -range.shift) + 1
        } else {
            range.limit << range.shift
        };
        // A negative product is rounded away from zero.
        let upper = |a: i64, b: i64| ((i128::from(a) * i128::from(b)) >> word) as i64 + 1;
        let moved = |factor: i64| product_bound(self.slope_value(range), word, factor);
        match self.l.spec.motor.emf_shape {
            EmfShape::Sinusoidal | EmfShape::Harmonics(_) => {
                let turn = moved(factor);
                let across = upper(turn, 3 * e);
                across + upper(turn, 3 * across) / 2 + 1
            }
            EmfShape::Trapezoidal { .. } => moved(2 * upper(factor, factor)),
        }
    }

    fn k_slope(&self, range: LineRange) -> Coefficient {
        let exponent = self.slope_exponent(range);
        let [doc, unit] = match self.l.spec.motor.emf_shape {
            EmfShape::Sinusoidal | EmfShape::Harmonics(_) => [
                "Turn of the EMF in one period over sqrt(3), per line EMF.",
                "upper words per shifted line",
            ],
            EmfShape::Trapezoidal { .. } => [
                "Motion of the EMF in one period, per product of two line EMFs.",
                "words of voltage per upper word of the product, both lines shifted",
            ],
        };
        self.l.scaled_coefficient(
            "k_slope",
            self.slope_value(range),
            self.options.word,
            [doc, &format!("c = {:.4e} 1/V", self.design.slope)],
            [&format!("c w 2^({exponent} - f_v)"), unit],
        )
    }

    /// The estimate `e` of the period that just ended, advanced to the target and to the present
    /// period.
    pub(super) fn move_emf(&self, sector: Expr<'b>, e: Phases<'b>) -> (Phases<'b>, Phases<'b>) {
        let (range, shape) = (self.line_range(), self.l.spec.motor.emf_shape);
        let doc = match shape {
            EmfShape::Sinusoidal | EmfShape::Harmonics(_) => {
                "Advances the estimate by a period or more: a sinusoidal EMF turns, e + w e_across - w^2/2 e."
            }
            EmfShape::Trapezoidal { .. } => {
                "Advances the estimate by a period or more: the EMF of the sector's off phase ramps from one flat top to the other."
            }
        };
        let k_slope = self.k_slope(range);
        let how = "The line EMF of the conducting pair is proportional to the speed; its sign is the direction of rotation.";
        self.l.b.stage("move_emf", &[doc, "", how]);
        let weights = self.line_weights(sector);
        let [line_a, line_b] = weights.zip(e, |weight, e| weight * e).0;
        let doc = "Line EMF above which the motion no longer grows";
        let most = self.l.voltage("line_max", range.limit, doc);
        named! {
            let e_line = (line_a + line_b).within(most);
            let e_line_factor = match range.shift {
                0 => e_line,
                shift @ 1.. => e_line << shift.unsigned_abs(),
                shift => e_line >> shift.unsigned_abs(),
            };
        }
        let [once, twice] = match shape {
            EmfShape::Sinusoidal | EmfShape::Harmonics(_) => {
                self.turning(k_slope, e_line_factor, e)
            }
            EmfShape::Trapezoidal { .. } => [self.ramping(k_slope, e_line_factor, weights); 2],
        };
        if self.options.delay == 0 {
            let e = (e + once).named("e");
            return (e, e);
        }
        named! {
            let e_now = e + once;
        }
        let before = match shape {
            EmfShape::Sinusoidal | EmfShape::Harmonics(_) => e,
            EmfShape::Trapezoidal { .. } => e_now,
        };
        ((before + twice).named("e"), e_now)
    }

    /// Weights of the EMF of phases a and b in the line EMF of the conducting pair (c is minus
    /// their sum).
    fn line_weights(&self, sector: Expr<'b>) -> Phases<'b> {
        named! {
            let line_weight = Phases::<2>::each(|phase| {
                let letter = ["a", "b"][phase];
                let weights = SECTOR_CURRENT.iter().map(|legs| legs[phase] - legs[2]);
                let weights = std::iter::once(0).chain(weights).collect();
                let doc = format!(
                    "Weight of the phase-{letter} EMF in the conducting pair's line EMF in sectors 1 to 6."
                );
                self.l.b.column("sector", &format!("line_{letter}"), weights, &doc).at(sector)
            });
        }
        line_weight
    }

    /// Zero-sum motion of a ramp: two thirds for the off phase, minus one third for the two others.
    /// The weights are applied before the product, so that they do not double its rounding.
    fn ramping(&self, k_slope: Coefficient, line: Expr<'b>, weights: Phases<'b>) -> Phases<'b> {
        named! {
            let e_line_square = line.mul_floor(line, self.options.word);
        }
        let by_weight = k_slope * weights.map(|weight| weight * e_line_square);
        named! {
            let motion = Phases([-by_weight.b(), by_weight.a()]);
        }
        motion
    }

    /// Motions of a sine over one period, and over two with delay 1. To first order the length
    /// would grow by half the turn's square in every period of the feedback, so the second order is
    /// included; over two periods it counts four times.
    fn turning(&self, k_slope: Coefficient, line: Expr<'b>, e: Phases<'b>) -> [Phases<'b>; 2] {
        named! {
            let e_turn = k_slope * line;
            let e_across = self.turned(e_turn, e);
            let bend = self.turned(e_turn, e_across);
            let motion = e_across + (bend >> 1);
        }
        if self.options.delay == 0 {
            return [motion, motion];
        }
        named! {
            let motion_twice = (e_across + bend) << 1;
        }
        [motion, motion_twice]
    }

    /// `e` turned by 90 degrees, times the turn: sqrt(3) times a phase of it is the line value of
    /// the two others.
    fn turned(&self, turn: Expr<'b>, e: Phases<'b>) -> Phases<'b> {
        let [a, b] = e.0;
        let lines = Phases([-(a + (b << 1)), (a << 1) + b]);
        lines.map(|line| line.mul_round(turn, self.options.word))
    }
}
