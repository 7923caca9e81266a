//! The integer primitives of emitted code, besides the operators of [`Word`].
//!
//! Each is exact for arguments within the stated ranges; none panics for any argument. None has a
//! loop or a float, nor, from `opt-level = 1` on, a panic path; only those with `divide` in their
//! names divide. Coefficients, shifts and segments are constants in emitted code; with constants
//! none needs a branch, except [`divide`] on 32-bit cores. The generator proves that every result
//! fits its word; it uses the `_narrow` forms where the product (or dividend) fits 32 bits, which
//! saves a 64-bit product on small cores. On a Cortex-M4 `mul_round(c, x, 32)` is one SMMULR.
#![expect(
    clippy::inline_always,
    reason = "each is a handful of instructions, and firmware is debugged unoptimised, too"
)]

pub use crate::word::Word;

/// Whether the core is an ARMv6-M one, which has no 64-bit product. No other Arm core without compare-and-swap is a target.
const MULTIPLIES_BY_HALVES: bool = cfg!(all(target_arch = "arm", not(target_has_atomic = "32")));

/// The whole product.
#[inline(always)]
fn product(a: Word, b: Word) -> i64 {
    if MULTIPLIES_BY_HALVES {
        return product_by_halves(a, b);
    }
    i64::from(a.0).wrapping_mul(i64::from(b.0))
}

/// The whole product from 32-bit products of half words, a third of the library function's instructions; if only its
/// upper word is used, the compiler leaves the lower one out.
#[doc(hidden)]
#[inline(always)]
#[must_use]
pub fn product_by_halves(a: Word, b: Word) -> i64 {
    let ([a_upper, a_lower], [b_upper, b_lower]) = (halves(a), halves(b));
    let carried = (a_lower * b_lower).0 as u32 >> 16;
    let crossed = a_upper * b_lower + carried as i32;
    let [carried, rest] = halves(crossed);
    let upper = a_upper * b_upper + carried + ((a_lower * b_upper + rest) >> 16);
    i64::from(upper.0) << 32 | i64::from((a * b).0 as u32)
}

/// Upper half, signed, and lower half.
#[inline(always)]
fn halves(word: Word) -> [Word; 2] {
    [word >> 16, Word(word.0 & 0xFFFF)]
}

/// `floor((coefficient signal + 2^(shift-1)) / 2^shift)`: rounded half up. `shift` is 1 to 62.
#[inline(always)]
#[must_use]
pub fn mul_round(coefficient: Word, signal: Word, shift: u32) -> Word {
    if cfg!(target_arch = "riscv32") {
        return mul_round_without_carry(coefficient, signal, shift);
    }
    let product = product(coefficient, signal);
    let half = 1_i64.wrapping_shl(shift.wrapping_sub(1));
    Word(product.wrapping_add(half).wrapping_shr(shift) as i32)
}

/// [`mul_round`] for cores without a carry flag, where a 64-bit sum is slow. Which of the two ways it takes is
/// decided by the compiler where `coefficient` is a constant.
#[doc(hidden)]
#[inline(always)]
#[must_use]
pub fn mul_round_without_carry(coefficient: Word, signal: Word, shift: u32) -> Word {
    // If twice the coefficient fits a word, the upper word of its product is the result and the bit
    // below it.
    if shift == 32 && coefficient.0.unsigned_abs() < 1 << 30 {
        let twice = i64::from(coefficient.0 << 1).wrapping_mul(i64::from(signal.0));
        return (Word((twice >> 32) as i32) + 1) >> 1;
    }
    let product = i64::from(coefficient.0).wrapping_mul(i64::from(signal.0));
    let below = product.wrapping_shr(shift.wrapping_sub(1));
    Word(product.wrapping_shr(shift) as i32) + (below & 1) as i32
}

/// A torque, bits of a number with 16 fraction bits, times a ratio with 28 fraction bits, at most 1.5: stated over learnt
/// torque constant. The torque saturates at 16384 Nm.
#[inline]
#[must_use]
pub fn scaled_torque(bits: Word, ratio: Word) -> Word {
    const MOST: i32 = 1 << 30;
    mul_round(ratio, bits.clamp(-MOST, MOST), TORQUE_RATIO_BITS)
}

/// Fraction bits of a learnt ratio.
pub const TORQUE_RATIO_BITS: u32 = 28;

/// [`mul_round`] for products that fit 32 bits including their rounding. `shift` is 1 to 30.
#[inline(always)]
#[must_use]
pub fn mul_round_narrow(coefficient: Word, signal: Word, shift: u32) -> Word {
    (coefficient * signal + 1_i32.wrapping_shl(shift.wrapping_sub(1))) >> shift
}

/// `floor(a b / 2^shift)`. `shift` is 1 to 62.
#[inline(always)]
#[must_use]
pub fn mul_floor(a: Word, b: Word, shift: u32) -> Word {
    Word(product(a, b).wrapping_shr(shift) as i32)
}

/// `floor((a b + c d) / 2^shift)` for a sum that fits 64 bits: depends on the sum only.
#[inline(always)]
#[must_use]
pub fn mul_add_floor(a: Word, b: Word, c: Word, d: Word, shift: u32) -> Word {
    Word(
        product(a, b)
            .wrapping_add(product(c, d))
            .wrapping_shr(shift) as i32,
    )
}

/// `min(a b, limit)` for non-negative factors; the product may exceed the word.
#[inline(always)]
#[must_use]
pub fn mul_limited(a: Word, b: Word, limit: Word) -> Word {
    Word(product(a, b).min(i64::from(limit.0)) as i32)
}

/// `min(floor(numerator 2^shift / denominator), limit)`, numerator and limit not negative,
/// denominator at least 1. `shift` is 0 to 31. For use off the normal path.
#[inline(always)]
#[must_use]
pub fn divide(numerator: Word, denominator: Word, limit: Word, shift: u32) -> Word {
    if cfg!(not(target_pointer_width = "64")) {
        return divide_by_digits(numerator, denominator, limit, shift);
    }
    // The proven lower limit, repeated for the compiler, which then needs no check for division by
    // zero. Unoptimised, `checked_div` has no panic path either.
    let denominator = denominator.0.max(1) as u64;
    let numerator = (numerator.0 as u32 as u64).wrapping_shl(shift);
    let quotient = numerator.checked_div(denominator).unwrap_or(0);
    Word(quotient.min(limit.0 as u32 as u64) as i32)
}

/// [`divide`] for cores with a 32-bit divider, whose library takes hundreds of instructions for 64
/// bits: two digits of 16 bits, or one where the limit needs no more (Knuth, The Art of Computer
/// Programming, volume 2, 4.3.1, algorithm D).
#[doc(hidden)]
#[inline(always)]
#[must_use]
pub fn divide_by_digits(numerator: Word, denominator: Word, limit: Word, shift: u32) -> Word {
    let denominator = denominator.0.max(1) as u32;
    let numerator = (numerator.0 as u32 as u64).wrapping_shl(shift);
    // The limit is a constant in emitted code, so that this is decided there.
    let is_one_digit = limit.0 <= 0xffff;
    let above = numerator.wrapping_shr(if is_one_digit { 16 } else { 32 });
    if above >= u64::from(denominator) {
        // The quotient is 2^16 or more, or 2^32.
        return limit;
    }
    let zeros = denominator.leading_zeros();
    // `zeros` is at most 31; unoptimised, a plain shift by a variable is checked.
    let (dividend, divisor) = (
        numerator.wrapping_shl(zeros),
        denominator.wrapping_shl(zeros),
    );
    let (high, rest) = if is_one_digit {
        (0, (dividend >> 16) as u32)
    } else {
        divide_digit((dividend >> 32) as u32, (dividend >> 16) as u16, divisor)
    };
    let (low, _) = divide_digit(rest, dividend as u16, divisor);
    let quotient = high << 16 | low;
    Word(quotient.min(limit.0 as u32) as i32)
}

/// Quotient, below 2^16, and remainder of `above 2^16 + next` and a divisor above `above` with its
/// highest bit set.
#[inline(always)]
fn divide_digit(above: u32, next: u16, divisor: u32) -> (u32, u32) {
    // The divisor's proven range, repeated for the compiler.
    let (top, bottom) = (divisor >> 16 | 0x8000, divisor & 0xffff);
    // An estimate by the divisor's upper half alone is up to two too large.
    let mut digit = above.checked_div(top).unwrap_or(0);
    let mut rest = above.wrapping_sub(digit.wrapping_mul(top));
    let is_too_large =
        |digit: u32, rest: u32| digit.wrapping_mul(bottom) > (rest << 16 | u32::from(next));
    if is_too_large(digit, rest) {
        digit = digit.wrapping_sub(1);
        rest = rest.wrapping_add(top);
        if rest >> 16 == 0 && is_too_large(digit, rest) {
            digit = digit.wrapping_sub(1);
        }
    }
    let whole = above << 16 | u32::from(next);
    (digit, whole.wrapping_sub(digit.wrapping_mul(divisor)))
}

/// [`divide`] for a shifted numerator that fits 32 unsigned bits: one UDIV if the core has it.
#[inline(always)]
#[must_use]
pub fn divide_narrow(numerator: Word, denominator: Word, limit: Word, shift: u32) -> Word {
    let denominator = denominator.0.max(1) as u32;
    let numerator = (numerator.0 as u32).wrapping_shl(shift);
    let quotient = numerator.checked_div(denominator).unwrap_or(0);
    Word(quotient.min(limit.0 as u32) as i32)
}

/// `x - 2^bits floor(x / 2^bits)`: what a shift by `bits`, 1 to 30, leaves over.
#[inline(always)]
#[must_use]
pub fn remainder(x: Word, bits: u32) -> Word {
    Word(x.0 & 1_i32.wrapping_shl(bits).wrapping_sub(1))
}

/// `floor((2^32 - 1) / ticks)`: angle per tick if a turn, 2^32, lasts `ticks`, at least 2.
#[inline(always)]
#[must_use]
pub fn turn_over(ticks: Word) -> Word {
    let ticks = ticks.0.max(2) as u32;
    Word(u32::MAX.checked_div(ticks).unwrap_or(0) as i32)
}

/// Index, from 0, of the one of `segments` equal parts of a turn that contains the angle.
/// `segments` is 1 to 65536.
///
/// Angles wrap at 2^32, one turn, so `theta + advance` needs no modulo.
#[inline(always)]
#[must_use]
pub fn angle_index(angle: Word, segments: u32) -> Word {
    if MULTIPLIES_BY_HALVES {
        return angle_index_by_halves(angle, segments);
    }
    Word(((angle.0 as u32 as u64).wrapping_mul(segments as u64) >> 32) as i32)
}

/// [`angle_index`] from products of half words.
#[doc(hidden)]
#[inline(always)]
#[must_use]
pub fn angle_index_by_halves(angle: Word, segments: u32) -> Word {
    let (upper, lower) = (angle.0 as u32 >> 16, angle.0 as u32 & 0xFFFF);
    let carried = lower.wrapping_mul(segments) >> 16;
    Word((upper.wrapping_mul(segments).wrapping_add(carried) >> 16) as i32)
}

/// Position within that part from its middle; its width is 2^32. `segments` is 1 to 65536.
#[inline(always)]
#[must_use]
pub fn angle_fraction(angle: Word, segments: u32) -> Word {
    Word(((angle.0 as u32).wrapping_mul(segments) ^ 1 << 31) as i32)
}

/// `table[index mod N]`; `N` is a power of two, so no index is out of bounds.
#[inline(always)]
#[must_use]
pub fn lookup<T: Copy + Into<Word>, const N: usize>(table: &[T; N], index: Word) -> Word {
    const { assert!(N.is_power_of_two()) };
    table[index.0 as usize & (N - 1)].into()
}

/// `rows[index mod N]`; `N` is a power of two, so no index is out of bounds.
#[inline(always)]
#[must_use]
pub fn row<T, const N: usize>(rows: &[T; N], index: Word) -> &T {
    const { assert!(N.is_power_of_two()) };
    &rows[index.0 as usize & (N - 1)]
}

/// `then` if the condition holds, else `otherwise`; both are evaluated.
#[inline(always)]
#[must_use]
pub fn select<T>(condition: bool, then: T, otherwise: T) -> T {
    if condition { then } else { otherwise }
}
