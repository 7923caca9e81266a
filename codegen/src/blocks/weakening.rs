//! Field weakening (shared semantics page, "Field weakening").
//!
//! Where the voltage ends, the reference turns ahead of the EMF. The greatest current turned by the angle
//! alpha, less the part along the EMF that the set-point does not ask for, is
//!
//! i = sign(j) (I s(theta + sign(j) alpha) - max(0, I share(alpha) - |j|) s(theta)),
//!
//! with s the proportional reference per ampere and share(alpha) the torque that the turned current still
//! makes. So, of a sine, the current against the field is I sin(alpha) whatever the set-point, and the torque is
//! that of the set-point until |i| reaches I; then it falls with share(alpha).
//!
//! Of a shape with harmonics the difference of two turned shapes has its current in pulses at the edges of one phase at a
//! time. Their voltage is cut where that of an even current is not, and their torque cancels in the mean only. While
//! current is left, this one flows in place of i:
//!
//! i = j s(theta) + d s'(theta),
//!
//! where s' is s turned by a quarter turn in the plane: across the EMF at each angle, so that d makes no torque at all.

use super::emf::{ProportionalShape, lifted};
use super::set_point::{SetPointWords, largest_set_point};
use super::{Lowering, round_half_up};
use crate::ir::{Exact, Expr, Flag, Interval, Memory, Phases, Real, named};
use crate::spec::{EmfShape, MOST_TURN, share_of_torque};

/// Periods in which the angle rises from none to its greatest while current is left.
const RISE: f64 = 128.0;
/// Binary logarithm of the ratio of the angle's two rates. While current is left the angle falls at the lower one,
/// and rests where a fifth of the voltages are cut, which keeps the torque. With the greatest current it rises at the
/// lower one, and rests where four fifths are cut: a current turned further would make less torque.
const SLOWER: u32 = 2;
/// Fraction bits of the share of the torque.
const SHARE_BITS: u32 = 30;
/// Fraction bits of its slope.
const SLOPE_BITS: u32 = 26;
/// Fraction bits of an angle in turns, and of its square.
const ANGLE_BITS: u32 = 32;
/// Current left, over the greatest one, from which on the current against the field is even.
const EVEN: f64 = 0.25;
/// Fraction bits of the part of the current that is.
const EVEN_BITS: u32 = 15;

/// The angle by which the reference is turned, and the greatest current.
#[derive(Clone, Copy, Debug)]
pub struct FieldWeakening<'b> {
    angle: Memory<'b>,
    /// The greatest set-point word.
    top: i64,
}

/// The angle of a step, and by how much it rises if the voltage is cut, and falls if not.
#[derive(Clone, Copy, Debug)]
pub struct Weakened<'b> {
    angle: Memory<'b>,
    rise: Expr<'b>,
    fall: Expr<'b>,
}

/// An angle of so many turns as a word.
fn turn_word(turns: f64) -> i64 {
    round_half_up(turns * f64::from(ANGLE_BITS).exp2()) as i64
}

/// Greatest change of the angle in a period.
fn step() -> i64 {
    turn_word(MOST_TURN / RISE)
}

impl<'b> FieldWeakening<'b> {
    /// Declares the word.
    pub fn new(l: &Lowering<'b>, set_point: &SetPointWords<'b>) -> Self {
        let doc =
            "Electrical angle by which the reference is turned against the field, 2^32 a turn.";
        let range = Interval::new(0, turn_word(MOST_TURN));
        Self {
            angle: l.b.memory("weakening", 0, range, doc),
            top: set_point.top,
        }
    }

    /// The reference as voltage words of phases a and b from the one along the EMF, `along`.
    pub fn reference(
        self,
        l: &Lowering<'b>,
        shape: &ProportionalShape<'b>,
        set_point: Expr<'b>,
        along: Phases<'b>,
    ) -> (Phases<'b>, Weakened<'b>) {
        let angle = self.angle.read();
        named! {
            let weakens = angle.is_above(0);
        }
        let turned = "The greatest current, turned against the field, less what the set-point does not ask of its part along the EMF.";
        let even = "While current is left, the set-point's current and one across the EMF instead, which makes no torque.";
        let is_sine = l.spec.motor.emf_shape == EmfShape::Sinusoidal;
        let docs = if is_sine {
            &[turned][..]
        } else {
            &[turned, even]
        };
        l.b.guarded_stage("weaken_field", weakens, true, docs);
        let largest = largest_set_point(l, self.top);
        named! {
            let pushes = set_point.is_at_least(0);
            let theta_weak = shape.theta.angle_add(pushes.sign(angle));
        }
        let turned = shape.at(l, "weak", theta_weak);
        named! {
            let share = share_at(l, angle);
            let j_along = share.mul_floor(largest, SHARE_BITS);
            let surplus = (j_along - set_point.abs()).max(0);
        }
        let ([top, surplus_lifted], shift) =
            lifted([("j_largest_lifted", largest), ("surplus_lifted", surplus)]);
        named! {
            let turned = turned.zip(shape.unit, |turned, unit| {
                top.mul_floor(turned, shift) - surplus_lifted.mul_floor(unit, shift)
            });
        }
        let doc = "Greatest change of the angle in a period.";
        let quick = l.number("weakening_step", step(), doc);
        named! {
            let j_weak = turned.map(|turned| pushes.sign(turned));
        }
        let j_weak = if is_sine {
            j_weak
        } else {
            let left = [surplus, largest - set_point.abs()];
            self.evened(l, shape, [along, j_weak], left)
        };
        named! {
            let slow = quick >> SLOWER;
            let rise_weak = surplus.is_above(0).choose(quick, slow);
            let fall_weak = surplus.is_above(0).choose(slow, quick);
        }
        let [a, b, rise, fall] = l.b.join([
            ("j_a_now", j_weak.a(), along.a()),
            ("j_b_now", j_weak.b(), along.b()),
            ("weakening_rise", rise_weak, quick),
            ("weakening_fall", fall_weak, quick),
        ]);
        let weakened = Weakened {
            angle: self.angle,
            rise,
            fall,
        };
        (Phases([a, b]), weakened)
    }

    /// The turned reference, evened as far as current is left: what the set-point leaves of the turned current's torque,
    /// and of the current. Added to the open stage.
    fn evened(
        self,
        l: &Lowering<'b>,
        shape: &ProportionalShape<'b>,
        [along, turned]: [Phases<'b>; 2],
        [surplus, left]: [Expr<'b>; 2],
    ) -> Phases<'b> {
        let top = self.top as f64;
        let against = top / (3f64.sqrt() * turn_word(MOST_TURN) as f64);
        let doc = "Current against the field at an angle, over sqrt(3): the greatest one at the greatest angle.";
        let k_against = l.coefficient("k_against", against, 32, doc, &format!("{against:.6}"));
        let even = f64::from(EVEN_BITS).exp2() / (EVEN * top);
        let doc = "Part of the reference that is even, over the current left, 15 fraction bits.";
        let k_even = l.coefficient("k_even", even, 32, doc, &format!("{even:.6}"));
        let doc = "All of the reference, 15 fraction bits.";
        let all = l.number("even_most", 1 << EVEN_BITS, doc);
        named! {
            // Half the current left is less than its part by sqrt(3).
            let against = (k_against * self.angle.read()).min(left >> 1);
            let even = (k_even * surplus).min(all);
        }
        let ([against], shift) = lifted([("against_lifted", against)]);
        named! {
            // No likely shape has a reference with such a peak.
            let j_weak_most = largest_set_point(l, self.top) << 2;
            let across = shape.unit.map(|unit| against.mul_floor(unit, shift));
            let j_even = Phases([
                along.a() - (across.a() + (across.b() << 1)),
                along.b() + ((across.a() << 1) + across.b()),
            ]);
            let j_evened = turned.zip(j_even, |turned, even_now| {
                (turned + (even_now - turned).mul_floor(even, EVEN_BITS)).clamp(-j_weak_most, j_weak_most)
            });
        }
        j_evened
    }
}

impl<'b> Weakened<'b> {
    /// The angle's new value; `cut`: whether the voltage was limited.
    pub fn follow(self, l: &Lowering<'b>, cut: Flag<'b>) -> (Memory<'b>, Expr<'b>) {
        let doc = "The reference turns further where the voltage is cut, else back.";
        l.b.stage("turn_reference", &[doc]);
        let doc = "Greatest angle by which the reference is turned, 2^32 a turn.";
        let most = l.number("weakening_max", turn_word(MOST_TURN), doc);
        named! {
            let weakening_new = (self.angle.read() + cut.choose(self.rise, -self.fall)).clamp(0, most);
        }
        (self.angle, weakening_new)
    }
}

/// Share of the torque that a current turned by the angle makes.
fn share_at<'b>(l: &Lowering<'b>, angle: Expr<'b>) -> Expr<'b> {
    let [square, fourth] = share_of_torque(l.spec.motor.emf_shape);
    let doc = "Torque lost per squared turn: share = 1 - a^2 (c2 - c4 a^2), a in turns.";
    let exact = square * f64::from(SLOPE_BITS).exp2();
    let raw = round_half_up(exact) as i64;
    let slope = l.rounded_number("weakening_c2", raw, Exact::Number(Real::of(exact)), doc);
    let k_fourth = l.coefficient(
        "k_weakening",
        fourth * (f64::from(SLOPE_BITS) - f64::from(ANGLE_BITS)).exp2(),
        32,
        "c4 2^-6, for the slope of the share of the torque.",
        &format!("c4 = {fourth:.4}"),
    );
    let doc = "All of the torque, 30 fraction bits.";
    let one = l.number("weakening_one", 1 << SHARE_BITS, doc);
    named! {
        let angle_square = angle.mul_floor(angle, ANGLE_BITS);
        let slope = slope - k_fourth * angle_square;
    }
    one - angle_square.mul_floor(slope, ANGLE_BITS + SLOPE_BITS - SHARE_BITS)
}
