//! The integer primitives of emitted code, besides the operators of [`Word`].
//!
//! Each is exact and branch-free, contains no panic path, no loop and no float, and divides only
//! where its name says so. The generator proves that every result fits its word; the `_narrow`
//! forms are chosen where the product (or dividend) itself fits 32 bits, which saves a 64-bit
//! product on small cores. On a Cortex-M4 `mul_round::<32>` is one SMMULR.
#![expect(
    clippy::inline_always,
    reason = "each is a handful of instructions, and firmware is debugged unoptimised, too"
)]

pub use crate::word::Word;

/// `floor((coefficient signal + 2^(SHIFT-1)) / 2^SHIFT)`: rounded half up. `SHIFT` is 1 to 62.
#[inline(always)]
#[must_use]
pub fn mul_round<const SHIFT: u32>(coefficient: Word, signal: Word) -> Word {
    const { assert!(1 <= SHIFT && SHIFT <= 62) };
    let product = i64::from(coefficient.0).wrapping_mul(i64::from(signal.0));
    Word((product.wrapping_add(1 << (SHIFT - 1)) >> SHIFT) as i32)
}

/// As [`mul_round`], for products that fit 32 bits together with their rounding. `SHIFT` is 1 to 30.
#[inline(always)]
#[must_use]
pub fn mul_round_narrow<const SHIFT: u32>(coefficient: Word, signal: Word) -> Word {
    const { assert!(1 <= SHIFT && SHIFT <= 30) };
    (coefficient * signal + (1 << (SHIFT - 1))) >> SHIFT
}

/// `floor(a b / 2^SHIFT)`. `SHIFT` is 1 to 62.
#[inline(always)]
#[must_use]
pub fn mul_floor<const SHIFT: u32>(a: Word, b: Word) -> Word {
    const { assert!(1 <= SHIFT && SHIFT <= 62) };
    Word((i64::from(a.0).wrapping_mul(i64::from(b.0)) >> SHIFT) as i32)
}

/// `min(a b, limit)` for factors that are not negative; the product may exceed the word.
#[inline(always)]
#[must_use]
pub fn mul_limited(a: Word, b: Word, limit: Word) -> Word {
    let product = i64::from(a.0).wrapping_mul(i64::from(b.0));
    Word(product.min(i64::from(limit.0)) as i32)
}

/// `min(floor(numerator 2^SHIFT / denominator), limit)`, numerator not negative, denominator at least 1.
/// `SHIFT` is 0 to 31. Divides 64 bits: for rare paths.
#[inline(always)]
#[must_use]
pub fn divide<const SHIFT: u32>(numerator: Word, denominator: Word, limit: Word) -> Word {
    const { assert!(SHIFT <= 31) };
    // The proven lower limit, repeated where the compiler sees it: no division by zero to check.
    let denominator = denominator.0.max(1) as u64;
    let quotient = ((numerator.0 as u32 as u64) << SHIFT) / denominator;
    Word(quotient.min(limit.0 as u32 as u64) as i32)
}

/// As [`divide`], where the shifted numerator fits 32 unsigned bits: one UDIV where the core has it.
#[inline(always)]
#[must_use]
pub fn divide_narrow<const SHIFT: u32>(numerator: Word, denominator: Word, limit: Word) -> Word {
    const { assert!(SHIFT <= 31) };
    let denominator = denominator.0.max(1) as u32;
    let quotient = ((numerator.0 as u32) << SHIFT) / denominator;
    Word(quotient.min(limit.0 as u32) as i32)
}

/// `floor((2^32 - 1) / ticks)`: the angle per tick, one turn being 2^32, where a turn lasts
/// `ticks`, at least 2.
#[inline(always)]
#[must_use]
pub fn turn_over(ticks: Word) -> Word {
    Word((u32::MAX / ticks.0.max(2) as u32) as i32)
}

/// Which of `SEGMENTS` equal parts of a turn the angle lies in, from 0. `SEGMENTS` is 1 to 65536.
///
/// Angles are words that wrap: one turn is 2^32, so `theta + advance` needs no care.
#[inline(always)]
#[must_use]
pub fn angle_index<const SEGMENTS: u32>(angle: Word) -> Word {
    const { assert!(1 <= SEGMENTS && SEGMENTS <= 1 << 16) };
    Word(((angle.0 as u32 as u64).wrapping_mul(SEGMENTS as u64) >> 32) as i32)
}

/// The position within that part, 2^31 being its whole width. `SEGMENTS` is 1 to 65536.
#[inline(always)]
#[must_use]
pub fn angle_fraction<const SEGMENTS: u32>(angle: Word) -> Word {
    const { assert!(1 <= SEGMENTS && SEGMENTS <= 1 << 16) };
    Word(((angle.0 as u32).wrapping_mul(SEGMENTS) >> 1) as i32)
}

/// `table[index mod N]`; `N` is a power of two, so no index is out of bounds.
#[inline(always)]
#[must_use]
pub fn lookup<T: Copy + Into<Word>, const N: usize>(table: &[T; N], index: Word) -> Word {
    const { assert!(N.is_power_of_two()) };
    table[index.0 as usize & (N - 1)].into()
}

/// `then` where the condition holds, else `otherwise`; both are evaluated.
#[inline(always)]
#[must_use]
pub fn select<T>(condition: bool, then: T, otherwise: T) -> T {
    if condition { then } else { otherwise }
}
