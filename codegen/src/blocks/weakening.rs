//! Field weakening (shared semantics page, "Field weakening").
//!
//! Where the voltage ends, the reference turns ahead of the EMF. The greatest current turned by the angle
//! alpha, less the part along the EMF that the set-point does not ask for, is
//!
//! i = sign(j) (I s(theta + sign(j) alpha) - max(0, I share(alpha) - |j|) s(theta)),
//!
//! with s the proportional reference per ampere and share(alpha) the torque that the turned current still
//! makes. So the current against the field is I sin(alpha) whatever the set-point, and the torque is that of
//! the set-point until |i| reaches I; then it falls with share(alpha).

use super::emf::{ProportionalShape, lifted};
use super::set_point::{SetPointWords, largest_set_point};
use super::{Lowering, round_half_up};
use crate::ir::{Exact, Expr, Flag, Interval, Memory, Phases, Real, named};
use crate::spec::{MOST_TURN, share_of_torque};

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
        l.b.guarded_stage(
            "weaken_field",
            weakens,
            true,
            &[
                "The greatest current, turned against the field, less what the set-point does not ask of its part along the EMF.",
            ],
        );
        let top = largest_set_point(l, self.top);
        named! {
            let pushes = set_point.is_at_least(0);
            let theta_weak = shape.theta.angle_add(pushes.sign(angle));
        }
        let turned = shape.at(l, "weak", theta_weak);
        named! {
            let share = share_at(l, angle);
            let j_along = share.mul_floor(top, SHARE_BITS);
            let surplus = (j_along - set_point.abs()).max(0);
        }
        let ([top, surplus_lifted], shift) =
            lifted([("j_largest_lifted", top), ("surplus_lifted", surplus)]);
        named! {
            let turned = turned.zip(shape.unit, |turned, unit| {
                top.mul_floor(turned, shift) - surplus_lifted.mul_floor(unit, shift)
            });
        }
        let doc = "Greatest change of the angle in a period.";
        let quick = l.number("weakening_step", step(), doc);
        named! {
            let j_weak = turned.map(|turned| pushes.sign(turned));
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
