//! Operations on words with intervals, each checked to be exact.
//!
//! The value only decides the program's path: an operation returns the union of all its intervals
//! so far (module `ledger`), so that the proof does not depend on the path.

use super::bounded::Bounded;
use super::ledger::{self, Site};
use hexagen_reference::exact::{WHOLE, Word};
use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Limit of numerators whose quotients are floored directly.
const QUOTIENT: f64 = 2.0 * WHOLE;
const TWO_32: f64 = 4_294_967_296.0;

/// The last place of numbers without one, such as a quotient: no sum or product of it is exact.
const NO_LAST: i32 = -100_000;

impl Bounded {
    /// With the bounds and the last place mapped by a monotonic function with integer results.
    #[track_caller]
    fn rounded(self, what: &'static str, round: impl Fn(f64) -> f64) -> Self {
        if self.bits() > 53 {
            ledger::fault(&format!("{what} of a number of {} bits", self.bits()));
        }
        if self.low.abs().max(self.high.abs()) >= WHOLE {
            ledger::fault(&format!("{what} of a number of 2^51 or more"));
        }
        Self::whole(round(self.value), round(self.low), round(self.high))
    }
}

impl Word for Bounded {
    type Site = Site;

    fn here() -> Site {
        ledger::here()
    }

    fn whole(value: f64, low: f64, high: f64) -> Self {
        Self::of(value, low, high, 0)
    }

    fn known(self, low: f64, high: f64) -> Self {
        if self.value < low || self.value > high {
            ledger::fault(&format!("{} is not from {low} to {high}", self.value));
        }
        Self::of(
            self.value,
            self.low.max(low),
            self.high.min(high),
            self.last,
        )
    }

    fn debug_whole(self) {
        if self.last < 0 || self.bits() > 53 {
            ledger::fault(&format!("not whole: {self:?}"));
        }
    }

    /// No check here: the bits of results show whether the number is too large.
    fn debug_at_most(self, _most: f64) {}

    fn nearest(self) -> Self {
        // A tie has a last place of a half and goes to the even one: no bound may lie on one.
        self.rounded("rounding", f64::round_ties_even)
    }

    fn floor(self) -> Self {
        if self.last == NO_LAST {
            return Self::whole(self.value.floor(), self.low.floor(), self.high.floor());
        }
        self.rounded("floor", f64::floor)
    }

    fn product_below(self, other: Self, limit: f64) -> Option<Self> {
        if limit.is_infinite() {
            return Some(self * other);
        }
        let product = product(self, other);
        let is_below = product.value.abs() < limit;
        if !is_below {
            ledger::go_another_way();
        }
        is_below.then(|| ledger::enter(product.known(-limit, limit), "product", self))
    }

    /// The proof that the steps of f64's division are exact for all words is in the comments next
    /// to them, and tested with 128-bit integers; here their operands are checked to be words.
    fn divide(self, s: u32, den: Self, limit: Self) -> Self {
        for (what, x, least) in [
            ("numerator", self, 0.0),
            ("denominator", den, 1.0),
            ("limit", limit, 0.0),
        ] {
            x.debug_whole();
            if x.low < least || x.high >= TWO_32 {
                ledger::fault(&format!("{what} from {} to {}", x.low, x.high));
            }
        }
        let quotient = |n: f64, den: f64, limit: f64| {
            let exact = ((n as i128) << s) / (den as i128).max(1);
            exact.min(limit as i128) as f64
        };
        Self::whole(
            quotient(self.value, den.value, limit.value),
            quotient(self.low, den.high, limit.low),
            quotient(self.high, den.low, limit.high),
        )
    }

    fn sign(self) -> Self {
        Self::whole(1f64.copysign(self.value), -1.0, 1.0)
    }

    fn abs(self) -> Self {
        let (low, high) = (self.low.abs(), self.high.abs());
        let least = if self.low <= 0.0 && self.high >= 0.0 {
            0.0
        } else {
            low.min(high)
        };
        Self::of(self.value.abs(), least, low.max(high), self.last)
    }

    fn greater(self, other: Self) -> Self {
        Self::of(
            self.value.max(other.value),
            self.low.max(other.low),
            self.high.max(other.high),
            self.last.min(other.last),
        )
    }

    fn lesser(self, other: Self) -> Self {
        Self::of(
            self.value.min(other.value),
            self.low.min(other.low),
            self.high.min(other.high),
            self.last.min(other.last),
        )
    }

    fn either(condition: bool, then: Self, otherwise: Self) -> Self {
        if condition {
            then.union(otherwise)
        } else {
            otherwise.union(then)
        }
    }

    fn to_i32(self) -> i32 {
        self.debug_whole();
        self.known(-TWO_32 / 2.0, TWO_32 / 2.0 - 1.0).value as i32
    }
}

fn sum(a: Bounded, b: Bounded) -> Bounded {
    Bounded::of(
        a.value + b.value,
        a.low + b.low,
        a.high + b.high,
        a.last.min(b.last),
    )
}

fn product(a: Bounded, b: Bounded) -> Bounded {
    let corners = [
        a.low * b.low,
        a.low * b.high,
        a.high * b.low,
        a.high * b.high,
    ];
    Bounded::of(
        a.value * b.value,
        corners.into_iter().fold(f64::INFINITY, f64::min),
        corners.into_iter().fold(f64::NEG_INFINITY, f64::max),
        a.last + b.last,
    )
}

/// A quotient of integers, the denominator above zero: valid for [`floor`] only.
#[track_caller]
fn quotient(a: Bounded, b: Bounded) -> Bounded {
    if a.last < 0 || b.last < 0 || b.low < 1.0 || a.low.abs().max(a.high.abs()) >= QUOTIENT {
        ledger::fault(&format!("quotient of {a:?} and {b:?}"));
    }
    let corners = [
        a.low / b.low,
        a.low / b.high,
        a.high / b.low,
        a.high / b.high,
    ];
    Bounded::of(
        a.value / b.value,
        corners.into_iter().fold(f64::INFINITY, f64::min),
        corners.into_iter().fold(f64::NEG_INFINITY, f64::max),
        NO_LAST,
    )
}

impl Neg for Bounded {
    type Output = Self;

    fn neg(self) -> Self {
        Self::of(-self.value, -self.high, -self.low, self.last)
    }
}

macro_rules! operator {
    ($($operator:ident $method:ident $what:literal $compute:expr;)*) => {$(
        impl<T: Into<Bounded>> $operator<T> for Bounded {
            type Output = Self;

            #[track_caller]
            fn $method(self, other: T) -> Self {
                ledger::enter($compute(self, other.into()), $what, self)
            }
        }
    )*};
}

operator! {
    Add add "sum" sum;
    Sub sub "difference" |a, b: Self| sum(a, -b);
    Mul mul "product" product;
}

impl<T: Into<Self>> Div<T> for Bounded {
    type Output = Self;

    #[track_caller]
    fn div(self, other: T) -> Self {
        quotient(self, other.into())
    }
}

impl AddAssign for Bounded {
    #[track_caller]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Copy + Into<Self>> PartialEq<T> for Bounded {
    fn eq(&self, other: &T) -> bool {
        self.value == (*other).into().value
    }
}

impl<T: Copy + Into<Self>> PartialOrd<T> for Bounded {
    fn partial_cmp(&self, other: &T) -> Option<Ordering> {
        self.value.partial_cmp(&(*other).into().value)
    }
}
