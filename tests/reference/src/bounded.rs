//! Words that prove their operations exact.
//!
//! Beside its value a word carries what all its values are multiples of (2^last) and an interval that holds them.
//! An operation is exact for all of them if their magnitude is below 2^(53+last), which every sum, difference and
//! product checks. The value only decides which way the program goes: a place of the program gives the union
//! of all intervals that it has ever given (module `ledger`), so that what is proven does not depend on the way.

use crate::ledger;
use std::cmp::Ordering;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};
use std::panic::Location;

pub use crate::ledger::here;

/// 2^51. Products below it can be taken whole: with half of their last bit added they still fit 53 bits.
pub const WHOLE: f64 = 2_251_799_813_685_248.0;
/// Numerators of quotients that are rounded down directly lie below.
const QUOTIENT: f64 = 2.0 * WHOLE;
const TWO_32: f64 = 4_294_967_296.0;

/// Stands for the last place of what has none, such as a quotient: no sum or product of it is exact.
const NO_LAST: i32 = -100_000;
/// The last place of zero.
const LAST_OF_ZERO: i32 = 1_023;

/// A word, or a number on the way to one.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    value: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// All values are multiples of 2^last.
    pub(crate) last: i32,
    /// What has made it last.
    pub(crate) made: Option<Made>,
}

/// The operation that made a word. Those of `a + b + c` stand in one place: they differ in how many of them have
/// come before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    pub(crate) location: &'static Location<'static>,
    pub(crate) before: u32,
}

impl Word {
    fn of(value: f64, low: f64, high: f64, last: i32) -> Self {
        Self {
            value,
            low,
            high,
            last,
            made: None,
        }
    }

    /// A whole number of an interval.
    pub(crate) fn whole(value: f64, [low, high]: [f64; 2]) -> Self {
        Self::of(value, low, high, 0)
    }

    /// Any whole number of an interval in which its value is.
    pub(crate) fn within(self, interval: [f64; 2]) -> Self {
        Self::whole(self.value, interval)
    }

    /// Bits from the last place of all values to the first of the largest.
    pub(crate) fn bits(self) -> i32 {
        let magnitude = self.low.abs().max(self.high.abs());
        if magnitude == 0.0 {
            return 0;
        }
        exponent(magnitude) + 1 - self.last
    }

    /// Whether the value is what is known of it.
    pub(crate) fn holds(self) -> bool {
        let last = f64::from(self.last.clamp(-1_000, 1_000)).exp2();
        (self.low..=self.high).contains(&self.value) && (self.value / last).fract() == 0.0
    }

    /// The magnitude.
    #[must_use]
    pub fn abs(self) -> Self {
        let (low, high) = (self.low.abs(), self.high.abs());
        let least = if self.low <= 0.0 && self.high >= 0.0 {
            0.0
        } else {
            low.min(high)
        };
        Self::of(self.value.abs(), least, low.max(high), self.last)
    }

    /// The lesser of two.
    #[must_use]
    pub fn min(self, other: impl Into<Self>) -> Self {
        lesser(self, other)
    }

    /// The greater of two.
    #[must_use]
    pub fn max(self, other: impl Into<Self>) -> Self {
        greater(self, other)
    }

    /// The nearest from `low` to `high`.
    #[must_use]
    pub fn clamp(self, low: impl Into<Self>, high: impl Into<Self>) -> Self {
        lesser(greater(self, low), high)
    }

    /// Which of two is greater, by their values.
    pub fn total_cmp(&self, other: &Self) -> Ordering {
        self.value.total_cmp(&other.value)
    }

    /// The value without its fraction.
    #[must_use]
    pub fn trunc(self) -> Self {
        word(self.value.trunc())
    }

    /// Both intervals.
    pub(crate) fn union(self, other: Self) -> Self {
        Self::of(
            self.value,
            self.low.min(other.low),
            self.high.max(other.high),
            self.last.min(other.last),
        )
    }

    /// With the bounds and the last place moved by a monotonic function that yields whole numbers.
    #[track_caller]
    fn rounded(self, what: &'static str, round: impl Fn(f64) -> f64) -> Self {
        if self.bits() > 53 {
            ledger::fault(&format!("{what} of a number of {} bits", self.bits()));
        }
        if self.low.abs().max(self.high.abs()) >= WHOLE {
            ledger::fault(&format!("{what} of a number of 2^51 or more"));
        }
        Self::whole(round(self.value), [round(self.low), round(self.high)])
    }
}

/// Exponent of the first bit of a number above zero.
fn exponent(x: f64) -> i32 {
    if x.is_finite() {
        (x.to_bits() >> 52) as i32 - 1023
    } else {
        1 << 20
    }
}

impl Default for Word {
    fn default() -> Self {
        word(0.0)
    }
}

impl From<f64> for Word {
    fn from(x: f64) -> Self {
        word(x)
    }
}

/// A constant as a word.
pub fn word(x: f64) -> Word {
    let last = if x == 0.0 {
        LAST_OF_ZERO
    } else {
        let zeros = (x.to_bits() & ((1 << 52) - 1) | 1 << 52).trailing_zeros();
        exponent(x.abs()) - 52 + zeros as i32
    };
    Word::of(x, x, x, last)
}

/// A type whose numbers come in from outside.
pub trait Outside: Into<f64> {
    /// Least and greatest number.
    const ENDS: [f64; 2];
}

impl Outside for u16 {
    const ENDS: [f64; 2] = [0.0, 65_535.0];
}

impl Outside for i32 {
    const ENDS: [f64; 2] = [-2_147_483_648.0, 2_147_483_647.0];
}

/// A number from outside: any of its type.
pub fn input<T: Outside>(x: T) -> Word {
    Word::whole(x.into(), T::ENDS)
}

/// `x`, which is known to lie from `low` to `high`.
#[track_caller]
pub fn known(x: Word, low: f64, high: f64) -> Word {
    if x.value < low || x.value > high {
        ledger::fault(&format!("{} is not from {low} to {high}", x.value));
    }
    Word::of(x.value, x.low.max(low), x.high.min(high), x.last)
}

/// Checks that `x` is whole.
#[track_caller]
pub fn debug_whole(x: Word) {
    if x.last < 0 || x.bits() > 53 {
        ledger::fault(&format!("not whole: {x:?}"));
    }
}

/// Nothing: the bits of what is computed of `x` tell whether it is too large.
pub fn debug_at_most(_x: Word, _most: f64) {}

/// Rows of a table, of which any may be taken: each has the union of its column.
pub fn tabulated(rows: &[[f64; 3]]) -> Vec<[Word; 3]> {
    let column = |place: usize| {
        let words = rows.iter().map(|row| word(row[place]));
        words.reduce(Word::union).unwrap_or_default()
    };
    let columns = [column(0), column(1), column(2)];
    let any = |row: &[f64; 3]| [0, 1, 2].map(|place| word(row[place]).union(columns[place]));
    rows.iter().map(any).collect()
}

/// The whole number nearest to `y`, |y| < 2^51, not half way between two.
#[track_caller]
pub fn nearest(y: Word) -> Word {
    // A tie comes with a last place of a half and goes to the even one: no bound may lie on one.
    y.rounded("rounding", f64::round_ties_even)
}

/// The greatest whole number not above `y`, |y| < 2^51. Of a quotient too: one of whole numbers, the upper
/// one below 2^52, does not round up to a whole number.
#[track_caller]
pub fn floor(y: Word) -> Word {
    if y.last == NO_LAST {
        return Word::whole(y.value.floor(), [y.low.floor(), y.high.floor()]);
    }
    y.rounded("floor", f64::floor)
}

/// x y where its magnitude is below `limit`: 2^51 or less, or any number for a product that is known to be exact.
#[track_caller]
pub fn product_below(x: Word, y: Word, limit: f64) -> Option<Word> {
    if limit.is_infinite() {
        return Some(x * y);
    }
    let product = product(x, y);
    let is_below = product.value.abs() < limit;
    if !is_below {
        ledger::go_another_way();
    }
    is_below.then(|| ledger::enter(known(product, -limit, limit), "product", x))
}

/// 1 with the sign of `x`.
pub fn sign(x: Word) -> Word {
    Word::whole(1f64.copysign(x.value), [-1.0, 1.0])
}

/// The two's complement word of a whole x, |x| < 2^31.
#[track_caller]
pub fn to_i32(x: Word) -> i32 {
    debug_whole(x);
    known(x, -2_147_483_648.0, 2_147_483_647.0).value as i32
}

/// The 16-bit count of a whole x, 0 <= x < 2^16.
#[track_caller]
pub fn to_u16(x: Word) -> u16 {
    debug_whole(x);
    known(x, 0.0, 65_535.0).value as u16
}

/// The index that a small whole x >= 0 is.
#[track_caller]
pub fn to_index(x: Word) -> usize {
    debug_whole(x);
    x.value as usize
}

/// The greater of two numbers, neither of which is NaN.
pub fn greater(a: impl Into<Word>, b: impl Into<Word>) -> Word {
    let (a, b) = (a.into(), b.into());
    let value = a.value.max(b.value);
    Word::of(
        value,
        a.low.max(b.low),
        a.high.max(b.high),
        a.last.min(b.last),
    )
}

/// The lesser of two numbers, neither of which is NaN.
pub fn lesser(a: impl Into<Word>, b: impl Into<Word>) -> Word {
    let (a, b) = (a.into(), b.into());
    let value = a.value.min(b.value);
    Word::of(
        value,
        a.low.min(b.low),
        a.high.min(b.high),
        a.last.min(b.last),
    )
}

/// `then` where the condition holds, else `otherwise`.
pub fn either(condition: bool, then: impl Into<Word>, otherwise: impl Into<Word>) -> Word {
    let (then, otherwise) = (then.into(), otherwise.into());
    if condition {
        then.union(otherwise)
    } else {
        otherwise.union(then)
    }
}

/// min(floor(n 2^s/den), limit) for words n >= 0, den > 0 and limit >= 0. That the steps of it are exact for all such
/// words is the argument that stands beside them, and what the test with 128-bit integers is about; here it is seen to
/// that they are such words.
#[track_caller]
pub fn divide(n: Word, s: u32, den: Word, limit: impl Into<Word>) -> Word {
    let limit = limit.into();
    for (what, x, least) in [
        ("numerator", n, 0.0),
        ("denominator", den, 1.0),
        ("limit", limit, 0.0),
    ] {
        debug_whole(x);
        if x.low < least || x.high >= TWO_32 {
            ledger::fault(&format!("{what} from {} to {}", x.low, x.high));
        }
    }
    let quotient = |n: f64, den: f64, limit: f64| {
        let exact = ((n as i128) << s) / (den as i128).max(1);
        exact.min(limit as i128) as f64
    };
    Word::whole(
        quotient(n.value, den.value, limit.value),
        [
            quotient(n.low, den.high, limit.low),
            quotient(n.high, den.low, limit.high),
        ],
    )
}

fn sum(a: Word, b: Word) -> Word {
    Word::of(
        a.value + b.value,
        a.low + b.low,
        a.high + b.high,
        a.last.min(b.last),
    )
}

fn product(a: Word, b: Word) -> Word {
    let corners = [
        a.low * b.low,
        a.low * b.high,
        a.high * b.low,
        a.high * b.high,
    ];
    Word::of(
        a.value * b.value,
        corners.into_iter().fold(f64::INFINITY, f64::min),
        corners.into_iter().fold(f64::NEG_INFINITY, f64::max),
        a.last + b.last,
    )
}

/// A quotient of whole numbers, the lower one above zero: good for [`floor`] alone.
#[track_caller]
fn quotient(a: Word, b: Word) -> Word {
    if a.last < 0 || b.last < 0 || b.low < 1.0 || a.low.abs().max(a.high.abs()) >= QUOTIENT {
        ledger::fault(&format!("quotient of {a:?} and {b:?}"));
    }
    let corners = [
        a.low / b.low,
        a.low / b.high,
        a.high / b.low,
        a.high / b.high,
    ];
    Word::of(
        a.value / b.value,
        corners.into_iter().fold(f64::INFINITY, f64::min),
        corners.into_iter().fold(f64::NEG_INFINITY, f64::max),
        NO_LAST,
    )
}

impl Neg for Word {
    type Output = Self;

    fn neg(self) -> Self {
        Self::of(-self.value, -self.high, -self.low, self.last)
    }
}

macro_rules! operator {
    ($($operator:ident $method:ident $what:literal $compute:expr;)*) => {$(
        impl $operator for Word {
            type Output = Self;

            #[track_caller]
            fn $method(self, other: Self) -> Self {
                ledger::enter($compute(self, other), $what, self)
            }
        }

        impl $operator<f64> for Word {
            type Output = Self;

            #[track_caller]
            fn $method(self, other: f64) -> Self {
                ledger::enter($compute(self, word(other)), $what, self)
            }
        }

        impl $operator<Word> for f64 {
            type Output = Word;

            #[track_caller]
            fn $method(self, other: Word) -> Word {
                ledger::enter($compute(word(self), other), $what, word(self))
            }
        }
    )*};
}

operator! {
    Add add "sum" sum;
    Sub sub "difference" |a, b: Word| sum(a, -b);
    Mul mul "product" product;
}

impl Div for Word {
    type Output = Self;

    #[track_caller]
    fn div(self, other: Self) -> Self {
        quotient(self, other)
    }
}

impl Div<f64> for Word {
    type Output = Self;

    #[track_caller]
    fn div(self, other: f64) -> Self {
        quotient(self, word(other))
    }
}

impl Div<Word> for f64 {
    type Output = Word;

    #[track_caller]
    fn div(self, other: Word) -> Word {
        quotient(word(self), other)
    }
}

impl AddAssign for Word {
    #[track_caller]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<'a> Sum<&'a Word> for Word {
    fn sum<I: Iterator<Item = &'a Word>>(words: I) -> Self {
        // One place would give the union of all partial sums, and add to it.
        let total = words.fold(word(0.0), |total, word| sum(total, *word));
        if total.bits() > 53 {
            ledger::fault(&format!("sum of {} bits", total.bits()));
        }
        total
    }
}

impl PartialEq for Word {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl PartialEq<f64> for Word {
    fn eq(&self, other: &f64) -> bool {
        self.value == *other
    }
}

impl PartialOrd for Word {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl PartialOrd<f64> for Word {
    fn partial_cmp(&self, other: &f64) -> Option<Ordering> {
        self.value.partial_cmp(other)
    }
}
