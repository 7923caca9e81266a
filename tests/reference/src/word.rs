//! The number type of model B, and its primitive operations.
//!
//! It is f64. The cross-crate tests build the same model over words with intervals, whose
//! operations prove themselves exact.
#![expect(
    clippy::inline_always,
    reason = "the models spend their time in these few instructions"
)]

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// 1.5 * 2^52: adding it to |y| < 2^51 rounds y to an integer.
const MAGIC: f64 = 6_755_399_441_055_744.0;
pub(crate) const TWO_16: f64 = 65_536.0;
pub(crate) const TWO_32: f64 = 4_294_967_296.0;
/// 2^51. Products below it need no splitting: with half of their last bit added they still fit 53
/// bits.
pub const WHOLE: f64 = 2_251_799_813_685_248.0;

/// 2^exponent, for |exponent| <= 1022.
#[inline]
pub fn pow2(exponent: i32) -> f64 {
    debug_assert!(exponent.abs() <= 1022);
    f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52)
}

/// A word, or an intermediate number. Sums, differences and products are exact; of a quotient only
/// [`Self::floor`] is.
pub trait Word:
    Copy
    + Debug
    + Default
    + From<f64>
    + PartialOrd
    + PartialOrd<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Add<f64, Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Sub<f64, Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Div<f64, Output = Self>
{
    /// Guard for the duration of an operation of several steps.
    type Site;

    /// Marks the present function's caller: its operations count as steps of that place.
    #[track_caller]
    fn here() -> Self::Site;

    /// The integer `value`, which stands for any from `low` to `high`.
    fn whole(value: f64, low: f64, high: f64) -> Self;

    /// The same number, known to lie from `low` to `high`.
    #[track_caller]
    #[must_use]
    fn known(self, low: f64, high: f64) -> Self;

    /// Asserts in debug builds that the number is an integer.
    #[track_caller]
    fn debug_whole(self);

    /// Asserts in debug builds that the magnitude is at most `most`.
    #[track_caller]
    fn debug_at_most(self, most: f64);

    /// The nearest integer, for a magnitude below 2^51, not half-way between two.
    #[track_caller]
    #[must_use]
    fn nearest(self) -> Self;

    /// The greatest integer not above this one, for a magnitude below 2^51. Of a quotient too: one
    /// of integers, the numerator below 2^52, does not round up to an integer.
    #[track_caller]
    #[must_use]
    fn floor(self) -> Self;

    /// The product if its magnitude is below `limit`: 2^51 or less, or any number for a product
    /// that is known to be exact. A product that is rounded is not below.
    #[track_caller]
    #[must_use]
    fn product_below(self, other: Self, limit: f64) -> Option<Self>;

    /// min(floor(n 2^s/den), limit) of a word n >= 0, for words den > 0 and limit >= 0.
    #[track_caller]
    #[must_use]
    fn divide(self, s: u32, den: Self, limit: Self) -> Self;

    /// 1 with the sign of the number.
    #[must_use]
    fn sign(self) -> Self;

    /// The magnitude.
    #[must_use]
    fn abs(self) -> Self;

    /// The greater of two numbers, neither of which is NaN.
    #[must_use]
    fn greater(self, other: Self) -> Self;

    /// The lesser of two numbers, neither of which is NaN.
    #[must_use]
    fn lesser(self, other: Self) -> Self;

    /// `then` if the condition holds, else `otherwise`.
    fn either(condition: bool, then: Self, otherwise: Self) -> Self;

    /// The two's complement word of an integer, its magnitude below 2^31.
    #[track_caller]
    fn to_i32(self) -> i32;
}

impl Word for f64 {
    /// No observer.
    type Site = ();

    #[inline(always)]
    fn here() {}

    #[inline(always)]
    fn whole(value: f64, low: f64, high: f64) -> Self {
        value.known(low, high)
    }

    #[inline(always)]
    fn known(self, low: f64, high: f64) -> Self {
        debug_assert!((low..=high).contains(&self), "{self} not in {low}..{high}");
        self
    }

    #[inline(always)]
    fn debug_whole(self) {
        debug_assert!(
            self.trunc() == self && self.abs() < 4.0 * WHOLE,
            "{self} is not exact"
        );
    }

    #[inline(always)]
    fn debug_at_most(self, most: f64) {
        debug_assert!(self.abs() <= most, "{self} is above {most}");
    }

    #[inline(always)]
    fn nearest(self) -> Self {
        debug_assert!(self.abs() < WHOLE, "{self} is too large to round");
        (self + MAGIC) - MAGIC
    }

    #[inline(always)]
    fn floor(self) -> Self {
        let nearest = self.nearest();
        // A mask, because a branch would be mispredicted every other time.
        let above = u64::from(nearest > self).wrapping_neg();
        nearest - f64::from_bits(1f64.to_bits() & above)
    }

    #[inline(always)]
    fn product_below(self, other: Self, limit: f64) -> Option<Self> {
        let product = self * other;
        (product.abs() < limit).then_some(product)
    }

    /// By one division: the rounded quotient is at most one off, which the remainder reveals.
    #[inline]
    fn divide(self, s: u32, den: Self, limit: Self) -> Self {
        self.debug_whole();
        debug_assert!(
            (0.0..TWO_32).contains(&self)
                && (1.0..TWO_32).contains(&den)
                && (0.0..TWO_32).contains(&limit),
            "{self}/{den}, at most {limit}"
        );
        let numerator = self * pow2(s as i32);
        let quotient = Word::floor((numerator / den).lesser(limit));
        // Each difference is exact: the upper half of the quotient leaves less than 2^49.
        let high = Word::floor(quotient * (1.0 / TWO_16)) * TWO_16;
        let remainder = (numerator - high * den) - (quotient - high) * den;
        let one = |off: bool| Self::either(off, 1.0, 0.0);
        (quotient + one(remainder >= den) - one(remainder < 0.0)).lesser(limit)
    }

    #[inline(always)]
    fn sign(self) -> Self {
        1f64.copysign(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }

    /// One instruction, where `f64::max` takes five.
    #[inline(always)]
    fn greater(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn lesser(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// A mask, because a branch would be mispredicted every other time.
    #[inline(always)]
    fn either(condition: bool, then: Self, otherwise: Self) -> Self {
        let mask = u64::from(condition).wrapping_neg();
        f64::from_bits(then.to_bits() & mask | otherwise.to_bits() & !mask)
    }

    #[inline(always)]
    fn to_i32(self) -> i32 {
        debug_assert!(
            self.trunc() == self && (-2_147_483_648.0..2_147_483_648.0).contains(&self),
            "{self} is no 32-bit word"
        );
        (self + MAGIC).to_bits() as i32
    }
}
