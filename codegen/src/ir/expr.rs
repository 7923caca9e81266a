//! Expressions: the values of a function under construction, in which laws are written.
//!
//! Each operator adds a node, in Rust's order of evaluation, with the meaning of [`Op::apply`]. The
//! product `k * x` with a [`Coefficient`] rounds half up at its shift, [`Expr::mul_floor`] rounds
//! down. A named value becomes a `let` of the emitted code; `named!` takes names from bindings:
//!
//! ```text
//! named! {
//!     let di = (i - i_prev).clamp(di_min, di_max);
//!     let e_seen = v_prev - k_di * di - k_r * i_prev;
//! }
//! ```

use super::draft::ProgramBuilder;
use super::interval::Interval;
use super::op::{Comparison, ConstantId, Op, ParamId, StateId, TableId, Value};
use std::array;
use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Shl, Shr, Sub};

/// A word of a function under construction.
#[derive(Clone, Copy, Debug)]
pub struct Expr<'b> {
    pub(super) b: &'b ProgramBuilder,
    pub(super) value: Value,
}

/// A flag of a function under construction: true or false.
#[derive(Clone, Copy, Debug)]
pub struct Flag<'b> {
    pub(super) b: &'b ProgramBuilder,
    pub(super) value: Value,
}

/// A word that outlives a control period.
#[derive(Clone, Copy, Debug)]
pub struct Memory<'b> {
    pub(super) b: &'b ProgramBuilder,
    pub(super) id: StateId,
}

/// A word of the set-point.
#[derive(Clone, Copy, Debug)]
pub struct Param<'b> {
    pub(super) b: &'b ProgramBuilder,
    pub(super) id: ParamId,
}

/// A table of words, read modulo its length.
#[derive(Clone, Copy, Debug)]
pub struct Lut<'b> {
    pub(super) b: &'b ProgramBuilder,
    pub(super) id: TableId,
}

/// A constant and the shift of the products with it.
#[derive(Clone, Copy, Debug)]
pub struct Coefficient {
    /// The constant.
    pub id: ConstantId,
    /// Shift of the products, rounded half up.
    pub shift: u32,
}

/// Values of phases a and b (N = 2; c is minus their sum) or of all three legs.
#[derive(Clone, Copy, Debug)]
pub struct Phases<'b, const N: usize = 2>(pub [Expr<'b>; N]);

/// An operand: an expression or a number.
pub trait Operand<'b>: Copy {
    /// The value, as a node of the function.
    fn node(self, b: &'b ProgramBuilder) -> Value;
}

impl<'b> Operand<'b> for Expr<'b> {
    fn node(self, _: &'b ProgramBuilder) -> Value {
        self.value
    }
}

impl<'b> Operand<'b> for i32 {
    fn node(self, b: &'b ProgramBuilder) -> Value {
        b.push("", Op::Literal(self))
    }
}

/// Values that `named!` can name.
pub trait Named {
    /// The value under this name, a `let` of the emitted code.
    #[must_use]
    fn named(self, name: &str) -> Self;
}

/// `let`s whose values have the same names in the emitted code.
macro_rules! named {
    ($(let $name:ident = $value:expr;)*) => {
        $(let $name = $crate::ir::Named::named($value, stringify!($name));)*
    };
}
pub(crate) use named;

/// Letters of the phases.
const LETTERS: [&str; 3] = ["a", "b", "c"];

/// The name of a phase's value, with the letter after the first word: `u_a_limited`.
fn phase_name(name: &str, phase: usize) -> String {
    let letter = LETTERS[phase];
    match name.split_once('_') {
        Some((first, rest)) => format!("{first}_{letter}_{rest}"),
        None => format!("{name}_{letter}"),
    }
}

impl Named for Expr<'_> {
    fn named(self, name: &str) -> Self {
        self.b.name(self.value, name);
        self
    }
}

impl Named for Flag<'_> {
    fn named(self, name: &str) -> Self {
        self.b.name(self.value, name);
        self
    }
}

impl<const N: usize> Named for Phases<'_, N> {
    fn named(self, name: &str) -> Self {
        Self(array::from_fn(|phase| {
            self.0[phase].named(&phase_name(name, phase))
        }))
    }
}

impl<'b> Expr<'b> {
    fn op(self, op: Op) -> Self {
        Self {
            value: self.b.push("", op),
            ..self
        }
    }

    fn flag(self, op: Op) -> Flag<'b> {
        Flag {
            b: self.b,
            value: self.b.push("", op),
        }
    }

    fn node(self, operand: impl Operand<'b>) -> Value {
        operand.node(self.b)
    }

    /// The builder of its function.
    pub fn builder(self) -> &'b ProgramBuilder {
        self.b
    }

    /// The proven interval.
    pub fn interval(self) -> Interval {
        self.b.interval(self.value)
    }

    /// |x|
    #[must_use]
    pub fn abs(self) -> Self {
        self.op(Op::Abs(self.value))
    }

    /// The lesser of the two.
    #[must_use]
    pub fn min(self, other: impl Operand<'b>) -> Self {
        let other = self.node(other);
        self.op(Op::Min(self.value, other))
    }

    /// The greater of the two.
    #[must_use]
    pub fn max(self, other: impl Operand<'b>) -> Self {
        let other = self.node(other);
        self.op(Op::Max(self.value, other))
    }

    /// min(max(x, low), high)
    #[must_use]
    pub fn clamp(self, low: impl Operand<'b>, high: impl Operand<'b>) -> Self {
        let (low, high) = (self.node(low), self.node(high));
        self.op(Op::Clamp {
            x: self.value,
            low,
            high,
        })
    }

    /// min(max(x, -limit), limit)
    #[must_use]
    pub fn within(self, limit: Self) -> Self {
        self.clamp(-limit, limit)
    }

    /// floor((k x + half) / 2^shift) for a factor `k`; the bare product for shift 0.
    #[must_use]
    pub fn mul_round(self, factor: Self, shift: u32) -> Self {
        let (coefficient, signal) = (factor.value, self.value);
        self.op(match shift {
            0 => Op::Product(coefficient, signal),
            _ => Op::MulRound {
                coefficient,
                signal,
                shift,
            },
        })
    }

    /// floor(x y / 2^shift)
    #[must_use]
    pub fn mul_floor(self, other: Self, shift: u32) -> Self {
        self.op(Op::MulFloor {
            a: self.value,
            b: other.value,
            shift,
        })
    }

    /// min(x y, limit), neither factor negative
    #[must_use]
    pub fn mul_limited(self, other: Self, limit: Self) -> Self {
        self.op(Op::MulLimited {
            a: self.value,
            b: other.value,
            limit: limit.value,
        })
    }

    /// min(floor(x 2^shift / denominator), limit)
    #[must_use]
    pub fn divide(self, shift: u32, denominator: Self, limit: impl Operand<'b>) -> Self {
        let limit = self.node(limit);
        self.op(Op::Divide {
            numerator: self.value,
            shift,
            denominator: denominator.value,
            limit,
        })
    }

    /// x - 2^n floor(x / 2^n)
    #[must_use]
    pub fn remainder(self, n: u32) -> Self {
        self.op(Op::Remainder(self.value, n))
    }

    /// floor((2^32 - 1) / x)
    #[must_use]
    pub fn turn_over(self) -> Self {
        self.op(Op::TurnOver(self.value))
    }

    /// (x + y) mod 2^32: of angles
    #[must_use]
    pub fn angle_add(self, other: Self) -> Self {
        self.op(Op::AngleAdd(self.value, other.value))
    }

    /// (x - y) mod 2^32: of angles
    #[must_use]
    pub fn angle_sub(self, other: Self) -> Self {
        self.op(Op::AngleSub(self.value, other.value))
    }

    /// The segment of an angle, of `segments` in a turn.
    #[must_use]
    pub fn angle_index(self, segments: u32) -> Self {
        self.op(Op::AngleIndex {
            angle: self.value,
            segments,
        })
    }

    /// The position of an angle in its segment, 31 bits.
    #[must_use]
    pub fn angle_fraction(self, segments: u32) -> Self {
        self.op(Op::AngleFraction {
            angle: self.value,
            segments,
        })
    }

    /// The two compared.
    pub fn compare(self, how: Comparison, other: impl Operand<'b>) -> Flag<'b> {
        let other = self.node(other);
        self.flag(Op::Compare(how, self.value, other))
    }

    /// x < y
    pub fn is_below(self, other: impl Operand<'b>) -> Flag<'b> {
        self.compare(Comparison::Less, other)
    }

    /// x <= y
    pub fn is_at_most(self, other: impl Operand<'b>) -> Flag<'b> {
        self.compare(Comparison::LessEqual, other)
    }

    /// x > y
    pub fn is_above(self, other: impl Operand<'b>) -> Flag<'b> {
        let other = self.node(other);
        self.flag(Op::Compare(Comparison::Less, other, self.value))
    }

    /// x >= y
    pub fn is_at_least(self, other: impl Operand<'b>) -> Flag<'b> {
        let other = self.node(other);
        self.flag(Op::Compare(Comparison::LessEqual, other, self.value))
    }

    /// x == y
    pub fn is(self, other: impl Operand<'b>) -> Flag<'b> {
        self.compare(Comparison::Equal, other)
    }

    /// x != y
    pub fn is_not(self, other: impl Operand<'b>) -> Flag<'b> {
        self.compare(Comparison::NotEqual, other)
    }
}

/// floor((a b + c d) / 2^shift) of factors a, b and c, d
pub fn mul_add_floor<'b>([a, b]: [Expr<'b>; 2], [c, d]: [Expr<'b>; 2], shift: u32) -> Expr<'b> {
    a.op(Op::MulAddFloor {
        first: [a.value, b.value],
        second: [c.value, d.value],
        shift,
    })
}

/// Operands of a choice: words or flags.
pub trait Choice<'b>: Copy {
    /// `then` where the flag holds, else `otherwise`.
    fn choose(flag: Flag<'b>, then: Self, otherwise: Self) -> Self;
}

impl<'b> Choice<'b> for Expr<'b> {
    fn choose(flag: Flag<'b>, then: Self, otherwise: Self) -> Self {
        Self {
            value: flag.select(then.value, otherwise.value),
            ..then
        }
    }
}

impl<'b> Choice<'b> for Flag<'b> {
    fn choose(flag: Flag<'b>, then: Self, otherwise: Self) -> Self {
        Self {
            value: flag.select(then.value, otherwise.value),
            ..then
        }
    }
}

impl<'b, const N: usize> Choice<'b> for Phases<'b, N> {
    fn choose(flag: Flag<'b>, then: Self, otherwise: Self) -> Self {
        then.zip(otherwise, |then, otherwise| {
            Expr::choose(flag, then, otherwise)
        })
    }
}

impl<'b> Flag<'b> {
    fn select(self, then: Value, otherwise: Value) -> Value {
        let op = Op::Select {
            condition: self.value,
            then,
            otherwise,
        };
        self.b.push("", op)
    }

    /// `then` where the flag holds, else `otherwise`; either may be a number.
    #[must_use]
    pub fn choose(self, then: impl Operand<'b>, otherwise: impl Operand<'b>) -> Expr<'b> {
        let (then, otherwise) = (then.node(self.b), otherwise.node(self.b));
        Expr {
            b: self.b,
            value: self.select(then, otherwise),
        }
    }

    /// The flag `then` where this one holds, else the flag `otherwise`.
    #[must_use]
    pub fn choose_flag(self, then: Self, otherwise: Self) -> Self {
        Choice::choose(self, then, otherwise)
    }

    /// The value where the flag holds, else minus the value.
    #[must_use]
    pub fn sign(self, value: Expr<'b>) -> Expr<'b> {
        self.choose(value, -value)
    }
}

/// The value of a if `is_a`, else that of b if `is_b`, else that of c.
pub fn pick<'b, T: Choice<'b>>([is_a, is_b]: [Flag<'b>; 2], [a, b, c]: [T; 3]) -> T {
    let rest = T::choose(is_b, b, c);
    T::choose(is_a, a, rest)
}

impl<'b> Memory<'b> {
    /// The word as it was before the step; a second read is the same value.
    pub fn read(self) -> Expr<'b> {
        Expr {
            b: self.b,
            value: self.b.read_word(Op::State(self.id)),
        }
    }

    /// Sets the word's new value.
    pub fn set(self, value: Expr<'b>) {
        self.b.set_state(self.id, value.value);
    }
}

impl<'b> Param<'b> {
    /// The word; a second read is the same value.
    pub fn read(self) -> Expr<'b> {
        Expr {
            b: self.b,
            value: self.b.read_word(Op::Param(self.id)),
        }
    }

    /// Sets the word's new value.
    pub fn set(self, value: Expr<'b>) {
        self.b.set_param(self.id, value.value);
    }

    /// The word's interval.
    pub fn interval(self) -> Interval {
        self.b.param_interval(self.id)
    }
}

impl<'b> Lut<'b> {
    /// table[index mod length]
    #[must_use]
    pub fn at(self, index: Expr<'b>) -> Expr<'b> {
        index.op(Op::Lookup {
            table: self.id,
            index: index.value,
            is_masked: true,
        })
    }

    /// Puts the table into a `row` of tables with a common index.
    #[must_use]
    pub fn in_row(self, row: &'static str) -> Self {
        self.b.put_in_row(self.id, row);
        self
    }

    /// Marks the entries as leg states.
    #[must_use]
    pub fn of_legs(self) -> Self {
        self.b.hold_legs(self.id);
        self
    }
}

impl<'b, const N: usize> Phases<'b, N> {
    /// A function of each phase's value.
    #[must_use]
    pub fn map(self, f: impl FnMut(Expr<'b>) -> Expr<'b>) -> Self {
        Self(self.0.map(f))
    }

    /// A function of the values of each phase in both.
    #[must_use]
    pub fn zip(self, other: Self, mut f: impl FnMut(Expr<'b>, Expr<'b>) -> Expr<'b>) -> Self {
        Self(array::from_fn(|phase| f(self.0[phase], other.0[phase])))
    }

    /// The value of each phase, from its number.
    pub fn each(f: impl FnMut(usize) -> Expr<'b>) -> Self {
        Self(array::from_fn(f))
    }

    /// Phase a.
    pub fn a(self) -> Expr<'b> {
        self.0[0]
    }

    /// Phase b.
    pub fn b(self) -> Expr<'b> {
        self.0[1]
    }
}

impl<'b> Phases<'b> {
    /// All three phases, with c minus the sum of the two others; `name` is that of the quantity.
    #[must_use]
    pub fn with_c(self, name: &str) -> Phases<'b, 3> {
        let [a, b] = self.0;
        Phases([a, b, (-(a + b)).named(&phase_name(name, 2))])
    }
}

impl<'b> Phases<'b, 3> {
    /// Phases a and b.
    #[must_use]
    pub fn pair(self) -> Phases<'b> {
        let [a, b, _] = self.0;
        Phases([a, b])
    }

    /// Phase c.
    pub fn c(self) -> Expr<'b> {
        self.0[2]
    }

    /// The sum of all three.
    #[must_use]
    pub fn sum(self) -> Expr<'b> {
        let [a, b, c] = self.0;
        a + b + c
    }

    /// The greatest and the least, by name, in the form of the spread rule
    /// ([`Function::interval_where_not`](super::Function::interval_where_not)).
    pub fn extremes(self, [greatest, least]: [&str; 2]) -> [Expr<'b>; 2] {
        let [a, b, c] = self.0;
        let greatest = a.max(b).max(c).named(greatest);
        [greatest, a.min(b).min(c).named(least)]
    }
}

macro_rules! binary {
    ($($trait:ident::$method:ident = $op:ident;)*) => {$(
        impl<'b, T: Operand<'b>> $trait<T> for Expr<'b> {
            type Output = Self;

            fn $method(self, other: T) -> Self {
                let other = self.node(other);
                self.op(Op::$op(self.value, other))
            }
        }

        impl<'b> $trait<Expr<'b>> for i32 {
            type Output = Expr<'b>;

            fn $method(self, other: Expr<'b>) -> Expr<'b> {
                let number = other.node(self);
                other.op(Op::$op(number, other.value))
            }
        }

        impl<const N: usize> $trait for Phases<'_, N> {
            type Output = Self;

            fn $method(self, other: Self) -> Self {
                self.zip(other, |a, b| $trait::$method(a, b))
            }
        }
    )*};
}
binary! {
    Add::add = Add;
    Sub::sub = Sub;
}

impl<'b> Mul<Expr<'b>> for i32 {
    type Output = Expr<'b>;

    fn mul(self, other: Expr<'b>) -> Expr<'b> {
        let number = other.node(self);
        other.op(Op::Product(number, other.value))
    }
}

/// The product in one word.
impl<'b> Mul for Expr<'b> {
    type Output = Expr<'b>;

    fn mul(self, other: Self) -> Self {
        self.op(Op::Product(self.value, other.value))
    }
}

/// The product rounded half up at the coefficient's shift.
impl<'b> Mul<Expr<'b>> for Coefficient {
    type Output = Expr<'b>;

    fn mul(self, signal: Expr<'b>) -> Expr<'b> {
        let factor = Expr {
            b: signal.b,
            value: signal.b.push("", Op::Constant(self.id)),
        };
        signal.mul_round(factor, self.shift)
    }
}

impl<'b, const N: usize> Mul<Phases<'b, N>> for Coefficient {
    type Output = Phases<'b, N>;

    fn mul(self, signals: Phases<'b, N>) -> Phases<'b, N> {
        signals.map(|signal| self * signal)
    }
}

impl Neg for Expr<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        self.op(Op::Neg(self.value))
    }
}

impl<const N: usize> Neg for Phases<'_, N> {
    type Output = Self;

    fn neg(self) -> Self {
        self.map(Neg::neg)
    }
}

/// x 2^n
impl Shl<u32> for Expr<'_> {
    type Output = Self;

    fn shl(self, bits: u32) -> Self {
        self.op(Op::ShiftLeft(self.value, bits))
    }
}

/// floor(x / 2^n)
impl Shr<u32> for Expr<'_> {
    type Output = Self;

    fn shr(self, bits: u32) -> Self {
        self.op(Op::ShiftRight(self.value, bits))
    }
}

impl<const N: usize> Shl<u32> for Phases<'_, N> {
    type Output = Self;

    fn shl(self, bits: u32) -> Self {
        self.map(|value| value << bits)
    }
}

impl<const N: usize> Shr<u32> for Phases<'_, N> {
    type Output = Self;

    fn shr(self, bits: u32) -> Self {
        self.map(|value| value >> bits)
    }
}

impl BitAnd for Flag<'_> {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self {
            value: self.b.push("", Op::And(self.value, other.value)),
            ..self
        }
    }
}

impl BitOr for Flag<'_> {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self {
            value: self.b.push("", Op::Or(self.value, other.value)),
            ..self
        }
    }
}

impl Not for Flag<'_> {
    type Output = Self;

    fn not(self) -> Self {
        Self {
            value: self.b.push("", Op::Not(self.value)),
            ..self
        }
    }
}
