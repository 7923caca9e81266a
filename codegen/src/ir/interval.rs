//! Intervals of integers.

use std::fmt;

/// A closed integer interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// Least value.
    pub low: i64,
    /// Greatest value.
    pub high: i64,
}

impl Interval {
    /// The interval of all 32-bit words.
    pub const WORD: Self = Self {
        low: i32::MIN as i64,
        high: i32::MAX as i64,
    };
    /// False and true.
    pub const FLAG: Self = Self { low: 0, high: 1 };
    /// Numbers of an unsigned halfword.
    pub const HALFWORD: Self = Self {
        low: 0,
        high: u16::MAX as i64,
    };

    /// `low..=high`.
    pub fn new(low: i64, high: i64) -> Self {
        Self { low, high }
    }

    /// `-bound..=bound`.
    pub fn symmetric(bound: i64) -> Self {
        Self {
            low: -bound,
            high: bound,
        }
    }

    /// One value.
    pub fn point(value: i64) -> Self {
        Self {
            low: value,
            high: value,
        }
    }

    /// Whether every value of `inner` lies in `self`.
    pub fn contains(self, inner: Self) -> bool {
        self.low <= inner.low && inner.high <= self.high
    }

    /// The smallest interval that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }

    /// Largest magnitude.
    pub fn magnitude(self) -> i64 {
        self.low.abs().max(self.high.abs())
    }

    /// Bits of the smallest two's complement word that holds the interval.
    pub fn bits(self) -> u32 {
        let of = |x: i64| {
            65 - if x < 0 {
                x.leading_ones()
            } else {
                x.leading_zeros()
            }
        };
        of(self.low).max(of(self.high))
    }

    /// The interval of `f`, monotonic in each argument, from its values at the ends.
    pub(crate) fn corners(self, other: Self, f: impl Fn(i64, i64) -> i64) -> Self {
        let all = [
            f(self.low, other.low),
            f(self.low, other.high),
            f(self.high, other.low),
            f(self.high, other.high),
        ];
        Self {
            low: all.into_iter().fold(i64::MAX, i64::min),
            high: all.into_iter().fold(i64::MIN, i64::max),
        }
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}]", self.low, self.high)
    }
}
