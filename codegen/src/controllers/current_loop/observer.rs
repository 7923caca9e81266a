//! How an estimated EMF moves on from the period that it was seen in to the present one and to the target
//! (semantics page of predictive deadbeat, step 8): by the motor's shape, at the speed that its own magnitude says.

use super::CurrentLoop;
use crate::design::vectors::SECTOR_CURRENT;
use crate::ir::Value;
use crate::lower::{Coefficient, product_bound, round_down};
use crate::spec::EmfShape;

/// The line EMF's limit, words of voltage, and the shift to the left (to the right below 0) that makes it the
/// longest factor of a word, q.
#[derive(Clone, Copy, Debug)]
struct LineRange {
    limit: i64,
    shift: i32,
}

impl CurrentLoop<'_, '_> {
    fn line_range(&self) -> LineRange {
        let l = &self.lowering;
        let limit = round_down(self.design.line_limit * l.scale.voltage()) as i64;
        let limit = limit.min(l.bus_interval().high);
        let bits = i64::BITS - limit.leading_zeros();
        LineRange {
            limit,
            shift: self.options.word as i32 - 1 - bits as i32,
        }
    }

    /// `k_slope`: what the upper word of the square of a shifted line EMF is worth in words of voltage; of a sine, what
    /// a shifted line EMF is worth as a turn.
    fn slope_value(&self, range: LineRange) -> f64 {
        let word = 1.0 / self.lowering.scale.voltage();
        self.design.slope * word * f64::from(self.slope_exponent(range)).exp2()
    }

    fn slope_exponent(&self, range: LineRange) -> i32 {
        let factors = match self.lowering.spec.motor.emf_shape {
            EmfShape::Sinusoidal => 1,
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
        match self.lowering.spec.motor.emf_shape {
            EmfShape::Sinusoidal => {
                let turn = moved(factor);
                let across = upper(turn, 3 * e);
                across + upper(turn, 3 * across) / 2 + 1
            }
            EmfShape::Trapezoidal { .. } => moved(2 * upper(factor, factor)),
        }
    }

    /// The estimate `e` of the period that just ended, moved on to the target period and to the present one.
    pub(super) fn move_emf(&mut self, sector: Value, e: [Value; 2]) -> ([Value; 2], [Value; 2]) {
        let range = self.line_range();
        let value = self.slope_value(range);
        let exponent = self.slope_exponent(range);
        let shape = self.lowering.spec.motor.emf_shape;
        let delayed = self.options.delay == 1;
        let doc = match shape {
            EmfShape::Sinusoidal => {
                "Moves the estimate on by a period and more: a sinusoidal EMF turns, e + w e_across - w^2/2 e."
            }
            EmfShape::Trapezoidal { .. } => {
                "Moves the estimate on by a period and more: the EMF of the sector's off phase goes from one flat top to the other."
            }
        };
        let [doc_of_slope, unit] = match shape {
            EmfShape::Sinusoidal => [
                "Turn of the EMF in one period over sqrt(3), per line EMF.",
                "upper words per shifted line",
            ],
            EmfShape::Trapezoidal { .. } => [
                "Motion of the EMF in one period, per product of two line EMFs.",
                "words of voltage per upper word of the product, both lines shifted",
            ],
        };
        let slope = self.lowering.scaled_coefficient(
            "k_slope",
            value,
            self.options.word,
            [doc_of_slope, &format!("c = {:.4e} 1/V", self.design.slope)],
            [&format!("c w 2^({exponent} - f_v)"), unit],
        );
        self.lowering.b.stage(
            "move_emf",
            &[
                doc,
                "",
                "The line EMF of the conducting pair tells the speed; its sign, the sense of rotation.",
            ],
        );
        let lines = self.line_signs(sector);
        let l = &mut *self.lowering;
        let parts = [0, 1].map(|x| l.b.mul(lines[x], e[x], 0));
        let line = l.b.add(parts[0], parts[1]);
        let speed = self.shifted_line(["e_line", "e_line_factor"], line, range);
        let [once, twice] = match shape {
            EmfShape::Sinusoidal => self.turning(slope, speed, e, delayed),
            EmfShape::Trapezoidal { .. } => {
                let motion = self.ramping(slope, speed, lines);
                [motion, motion]
            }
        };
        let l = &mut *self.lowering;
        let mut ahead = |e: [Value; 2], motion: [Value; 2], names: [&str; 2]| {
            [0, 1].map(|x| {
                let moved = l.b.add(e[x], motion[x]);
                l.b.name(names[x], moved)
            })
        };
        if delayed {
            let present = ahead(e, once, ["e_a_now", "e_b_now"]);
            let before = match shape {
                EmfShape::Sinusoidal => e,
                EmfShape::Trapezoidal { .. } => present,
            };
            (ahead(before, twice, ["e_a", "e_b"]), present)
        } else {
            let present = ahead(e, once, ["e_a", "e_b"]);
            (present, present)
        }
    }

    /// Weights of the EMF of phases a and b in the line EMF of the conducting pair (c is minus their sum).
    fn line_signs(&mut self, sector: Value) -> [Value; 2] {
        let b = &mut self.lowering.b;
        let weights = |phase: usize| {
            let signs = SECTOR_CURRENT.iter();
            let weights = signs.map(|legs| legs[phase] - legs[2]);
            std::iter::once(0).chain(weights).collect::<Vec<i32>>()
        };
        [("line_a", "a", 0), ("line_b", "b", 1)].map(|(name, phase, index)| {
            let doc = format!(
                "Weight of the phase-{phase} EMF in the line EMF of the pair that conducts in sectors 1 to 6."
            );
            let table = b.program.column("sector", name, weights(index), &[doc]);
            let weight = b.lookup(table, sector);
            b.name(["line_weight_a", "line_weight_b"][index], weight)
        })
    }

    /// A line EMF up to its limit, shifted to the length of a factor.
    fn shifted_line(&mut self, names: [&str; 2], line: Value, range: LineRange) -> Value {
        let l = &mut *self.lowering;
        let doc = "Line EMF from which on its motion no longer grows";
        let held = l.within_volts(line, "line_max", range.limit, doc);
        l.b.name(names[0], held);
        let factor = match range.shift {
            0 => held,
            shift @ 1.. => l.b.shift_left(held, shift.unsigned_abs()),
            shift => l.b.shift_right(held, shift.unsigned_abs()),
        };
        l.b.name(names[1], factor)
    }

    /// Two thirds of the ramp for the phase that is off, a third against it for the two others: against the off
    /// phase's outgoing sign, which is what the weights of the other phase say. They come before the product, whose
    /// rounding they would double.
    fn ramping(&mut self, slope: Coefficient, speed: Value, lines: [Value; 2]) -> [Value; 2] {
        let word = self.options.word;
        let l = &mut *self.lowering;
        let square = l.b.mul_floor(speed, speed, word);
        l.b.name("e_line_square", square);
        let [with_b, with_a] = lines.map(|weight| {
            let weighted = l.b.mul(weight, square, 0);
            l.times(slope, weighted)
        });
        let motion_a = l.b.neg(with_a);
        [l.b.name("motion_a", motion_a), l.b.name("motion_b", with_b)]
    }

    /// Motions of a sine over one period, and over two where the target is the second one. At right angles to itself
    /// alone it would grow in length by half the turn's square, again in every period that the estimate is fed back:
    /// the motion turns by half as well. Over two periods that counts four times.
    fn turning(
        &mut self,
        slope: Coefficient,
        speed: Value,
        e: [Value; 2],
        delayed: bool,
    ) -> [[Value; 2]; 2] {
        let turn = self.lowering.times(slope, speed);
        self.lowering.b.name("e_turn", turn);
        let across = self.turned(turn, e, ["e_across_a", "e_across_b"]);
        let bend = self.turned(turn, across, ["bend_a", "bend_b"]);
        let b = &mut self.lowering.b;
        let once = [0, 1].map(|x| {
            let half = b.shift_right(bend[x], 1);
            let motion = b.add(across[x], half);
            b.name(["motion_a", "motion_b"][x], motion)
        });
        if !delayed {
            return [once, once];
        }
        let twice = [0, 1].map(|x| {
            let half = b.add(across[x], bend[x]);
            let motion = b.shift_left(half, 1);
            b.name(["motion_twice_a", "motion_twice_b"][x], motion)
        });
        [once, twice]
    }

    /// At right angles to `e`, by the turn: sqrt(3) times a phase's voltage across is that between the two others.
    fn turned(&mut self, turn: Value, e: [Value; 2], names: [&str; 2]) -> [Value; 2] {
        let word = self.options.word;
        let b = &mut self.lowering.b;
        let twice_b = b.shift_left(e[1], 1);
        let sum = b.add(e[0], twice_b);
        let line_a = b.neg(sum);
        let twice_a = b.shift_left(e[0], 1);
        let line_b = b.add(twice_a, e[1]);
        [0, 1].map(|x| {
            let turned = b.mul(turn, [line_a, line_b][x], word);
            b.name(names[x], turned)
        })
    }
}
