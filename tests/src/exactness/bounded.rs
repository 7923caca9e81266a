//! Words that prove their operations exact.
//!
//! Besides its value a word has an interval that contains all its values, and the power of two,
//! 2^last, that divides them. An operation is exact for all of them if their magnitude is below
//! 2^(53+last), which every sum, difference and product checks (module `operations`).

use std::panic::Location;

/// The last place of zero.
const LAST_OF_ZERO: i32 = 1_023;

/// A word, or an intermediate number, with its interval.
#[derive(Clone, Copy, Debug)]
pub struct Bounded {
    pub(crate) value: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
    /// All values are multiples of 2^last.
    pub(crate) last: i32,
    /// Its last operation.
    pub(crate) made: Option<Made>,
}

/// The operation that made a word. Those of `a + b + c` are at one place: they differ in the number
/// of earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    pub(crate) location: &'static Location<'static>,
    pub(crate) before: u32,
}

impl Bounded {
    pub(crate) fn of(value: f64, low: f64, high: f64, last: i32) -> Self {
        Self {
            value,
            low,
            high,
            last,
            made: None,
        }
    }

    /// Bits from the last place of all values to the first of the largest.
    pub(crate) fn bits(self) -> i32 {
        let magnitude = self.low.abs().max(self.high.abs());
        if magnitude == 0.0 {
            return 0;
        }
        exponent(magnitude) + 1 - self.last
    }

    /// Whether the value lies in its interval.
    pub(crate) fn holds(self) -> bool {
        let last = f64::from(self.last.clamp(-1_000, 1_000)).exp2();
        (self.low..=self.high).contains(&self.value) && (self.value / last).fract() == 0.0
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
}

/// Exponent of the first bit of a number above zero.
fn exponent(x: f64) -> i32 {
    if x.is_finite() {
        (x.to_bits() >> 52) as i32 - 1023
    } else {
        1 << 20
    }
}

impl Default for Bounded {
    fn default() -> Self {
        Self::from(0.0)
    }
}

/// A constant.
impl From<f64> for Bounded {
    fn from(x: f64) -> Self {
        let last = if x == 0.0 {
            LAST_OF_ZERO
        } else {
            let zeros = (x.to_bits() & ((1 << 52) - 1) | 1 << 52).trailing_zeros();
            exponent(x.abs()) - 52 + zeros as i32
        };
        Self::of(x, x, x, last)
    }
}
