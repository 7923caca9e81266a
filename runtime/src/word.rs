//! The word of emitted code: a 32-bit two's complement number with operators.
//!
//! The generator proves for each value that it fits its word, so the operators have no checks: they
//! wrap whatever the compiler's overflow checks, and cost one instruction each. Small numbers need
//! no conversion: `countdown - 1`, `sector == 3`.
//!
//! From `opt-level = 1` on, with overflow checks and debug assertions too, an emitted step or
//! setter has no panic path. Unoptimised, `core` keeps checks inside its own functions (orderings
//! of atomics; with debug assertions, lengths of shifts); none of them can fail.
#![expect(
    clippy::inline_always,
    reason = "each is one instruction, and firmware is debugged unoptimised, too"
)]

use core::ops::{Add, Mul, Neg, Shl, Shr, Sub};

/// A 32-bit word.
///
/// ```
/// use hexagen::arith::Word;
///
/// let count = Word::from(2100_u16);
/// assert_eq!((count << 3) - 2048 * 8, 416);
/// assert_eq!(count.clamp(0, 2047), 2047);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(transparent)]
pub struct Word(pub i32);

impl Word {
    /// Minimum.
    #[inline(always)]
    #[must_use]
    pub fn min(self, other: impl Into<Self>) -> Self {
        Self(self.0.min(other.into().0))
    }

    /// Maximum.
    #[inline(always)]
    #[must_use]
    pub fn max(self, other: impl Into<Self>) -> Self {
        Self(self.0.max(other.into().0))
    }

    /// Minimum of two words whose difference fits a word: without a comparison, and sharing the
    /// difference with [`greater`](Self::greater).
    #[inline(always)]
    #[must_use]
    pub fn lesser(self, other: Self) -> Self {
        other + (self - other).negative_part()
    }

    /// Maximum of two words whose difference fits a word.
    #[inline(always)]
    #[must_use]
    pub fn greater(self, other: Self) -> Self {
        self - (self - other).negative_part()
    }

    /// min(word, 0).
    #[inline(always)]
    pub(crate) fn negative_part(self) -> Self {
        Self(self.0 & self.0 >> 31)
    }

    /// Clamps to `low` to `high`. Unlike [`i32::clamp`] it has no panic path: limits in the wrong
    /// order give `high`.
    #[inline(always)]
    #[must_use]
    pub fn clamp(self, low: impl Into<Self>, high: impl Into<Self>) -> Self {
        self.max(low).min(high)
    }

    /// The magnitude. Wraps for the least word.
    #[inline(always)]
    #[must_use]
    pub fn abs(self) -> Self {
        Self(self.0.wrapping_abs())
    }

    /// Whether the magnitude exceeds `limit`, which is not negative: one comparison, of the
    /// distance from `-limit`.
    #[inline(always)]
    #[must_use]
    pub fn exceeds(self, limit: impl Into<Self>) -> bool {
        let limit = limit.into().0;
        self.0.wrapping_add(limit) as u32 > (limit as u32).wrapping_mul(2)
    }

    /// The lower half, for words in 0..=65535.
    #[inline(always)]
    #[must_use]
    pub const fn to_u16(self) -> u16 {
        self.0 as u16
    }
}

macro_rules! from {
    ($($small:ty),*) => {$(
        impl From<$small> for Word {
            #[inline(always)]
            fn from(value: $small) -> Self {
                Self(i32::from(value))
            }
        }
    )*};
}
from!(bool, i8, u8, i16, u16, i32);

macro_rules! operator {
    ($($trait:ident::$method:ident = $wrapping:ident;)*) => {$(
        impl<T: Into<Self>> $trait<T> for Word {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: T) -> Self {
                Self(self.0.$wrapping(other.into().0))
            }
        }
    )*};
}
operator! {
    Add::add = wrapping_add;
    Sub::sub = wrapping_sub;
    Mul::mul = wrapping_mul;
}

impl Neg for Word {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

impl Shl<u32> for Word {
    type Output = Self;

    /// Times 2^`bits`.
    #[inline(always)]
    fn shl(self, bits: u32) -> Self {
        Self(self.0.wrapping_shl(bits))
    }
}

impl Shr<u32> for Word {
    type Output = Self;

    /// Divided by 2^`bits`, rounded towards minus infinity.
    #[inline(always)]
    fn shr(self, bits: u32) -> Self {
        Self(self.0.wrapping_shr(bits))
    }
}

impl PartialEq<i32> for Word {
    #[inline(always)]
    fn eq(&self, other: &i32) -> bool {
        self.0 == *other
    }
}

impl PartialOrd<i32> for Word {
    #[inline(always)]
    fn partial_cmp(&self, other: &i32) -> Option<core::cmp::Ordering> {
        self.0.partial_cmp(other)
    }

    // Written out, so that unoptimised firmware does not build an `Ordering` first.
    #[inline(always)]
    fn lt(&self, other: &i32) -> bool {
        self.0 < *other
    }

    #[inline(always)]
    fn le(&self, other: &i32) -> bool {
        self.0 <= *other
    }

    #[inline(always)]
    fn gt(&self, other: &i32) -> bool {
        self.0 > *other
    }

    #[inline(always)]
    fn ge(&self, other: &i32) -> bool {
        self.0 >= *other
    }
}
