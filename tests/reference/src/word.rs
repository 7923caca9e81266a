//! The numbers that model B computes with, and what only a number itself can do.
//!
//! They are f64. The crate `hexagen-exactness` is this crate built once more with `bounded` set: there a
//! word carries an interval beside its value, and every operation proves itself exact (module `bounded`).
#![expect(
    clippy::inline_always,
    reason = "the models spend their time in these few instructions"
)]

/// A word, or a number on the way to one.
pub type Word = f64;

/// 1.5 * 2^52: adding it to |y| < 2^51 rounds y to a whole number.
const MAGIC: f64 = 6_755_399_441_055_744.0;
/// 2^51. Products below it can be taken whole: with half of their last bit added they still fit 53 bits.
pub const WHOLE: f64 = 2_251_799_813_685_248.0;

/// A constant as a word.
#[inline(always)]
pub fn word(x: f64) -> Word {
    x
}

/// A number from outside: any of its type.
#[inline(always)]
pub fn input(x: impl Into<f64>) -> Word {
    x.into()
}

/// Where an operation of several steps is called; nobody asks.
pub struct Site;

/// Marks the place from where the present function is called.
#[inline(always)]
pub fn here() -> Site {
    Site
}

/// `x`, which is known to lie from `low` to `high`.
#[inline(always)]
pub fn known(x: Word, low: f64, high: f64) -> Word {
    debug_assert!((low..=high).contains(&x), "{x} not in {low}..{high}");
    x
}

/// Asserts in debug builds that `x` is whole.
#[inline]
pub fn debug_whole(x: Word) {
    debug_assert!(
        x.trunc() == x && x.abs() < 9_007_199_254_740_992.0,
        "{x} is not exact"
    );
}

/// Asserts in debug builds that |x| <= most.
#[inline]
pub fn debug_at_most(x: Word, most: f64) {
    debug_assert!(x.abs() <= most, "{x} is above {most}");
}

/// Rows of a table, of which any may be taken.
pub fn tabulated(rows: &[[f64; 3]]) -> Vec<[Word; 3]> {
    rows.to_vec()
}

/// The whole number nearest to `y`, |y| < 2^51, not half way between two.
#[inline]
pub fn nearest(y: Word) -> Word {
    debug_assert!(y.abs() < WHOLE, "{y} is too large to round");
    (y + MAGIC) - MAGIC
}

/// The greatest whole number not above `y`, |y| < 2^51. Of a quotient too: one of whole numbers, the upper
/// one below 2^52, does not round up to a whole number.
#[inline]
pub fn floor(y: Word) -> Word {
    debug_assert!(y.abs() < WHOLE, "{y} is too large for floor");
    let nearest = (y + MAGIC) - MAGIC;
    // A mask, because a branch would be mispredicted every other time.
    let above = u64::from(nearest > y).wrapping_neg();
    nearest - f64::from_bits(1f64.to_bits() & above)
}

/// x y where its magnitude is below `limit`: 2^51 or less, or any number for a product that is known to be exact.
/// A product that is rounded is not below.
#[inline(always)]
pub fn product_below(x: Word, y: Word, limit: f64) -> Option<Word> {
    let product = x * y;
    (product.abs() < limit).then_some(product)
}

/// 1 with the sign of `x`.
#[inline(always)]
pub fn sign(x: Word) -> Word {
    1f64.copysign(x)
}

/// The two's complement word of a whole x, |x| < 2^31.
#[inline]
pub fn to_i32(x: Word) -> i32 {
    debug_assert!(
        x.trunc() == x && (-2_147_483_648.0..2_147_483_648.0).contains(&x),
        "{x} is no 32-bit word"
    );
    (x + MAGIC).to_bits() as i32
}

/// The 16-bit count of a whole x, 0 <= x < 2^16.
#[inline]
pub fn to_u16(x: Word) -> u16 {
    debug_assert!(
        x.trunc() == x && (0.0..65_536.0).contains(&x),
        "{x} is no 16-bit count"
    );
    (x + MAGIC).to_bits() as u16
}

/// The index that a small whole x >= 0 is.
#[inline(always)]
pub fn to_index(x: Word) -> usize {
    x as usize
}

/// The greater of two numbers, neither of which is NaN: one instruction, where `f64::max` takes five.
#[inline(always)]
pub fn greater(a: impl Into<Word>, b: impl Into<Word>) -> Word {
    let (a, b) = (a.into(), b.into());
    if a > b { a } else { b }
}

/// The lesser of two numbers, neither of which is NaN.
#[inline(always)]
pub fn lesser(a: impl Into<Word>, b: impl Into<Word>) -> Word {
    let (a, b) = (a.into(), b.into());
    if a < b { a } else { b }
}

/// `then` where the condition holds, else `otherwise`: a mask, because a branch would be mispredicted every other time.
#[inline]
pub fn either(condition: bool, then: impl Into<Word>, otherwise: impl Into<Word>) -> Word {
    let (then, otherwise) = (then.into(), otherwise.into());
    let mask = u64::from(condition).wrapping_neg();
    f64::from_bits(then.to_bits() & mask | otherwise.to_bits() & !mask)
}
