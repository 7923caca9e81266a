//! Exact integer operations in f64, for words of 32 bits.
//!
//! A word is an f64 with a whole value of at most 32 bits and sign. Sums and products that stay
//! below 2^53 are exact in f64; longer products are split at 16 bits first (floor(C x/2^s) =
//! floor((Ch x + floor(Cl x/2^16))/2^(s-16)) with C = Ch 2^16 + Cl), so every intermediate is
//! exact. Debug builds assert the bounds; the tests compare with 128-bit integers.
#![expect(
    clippy::inline_always,
    reason = "the models spend their time in these few instructions"
)]

/// 1.5 * 2^52: adding it to |y| < 2^51 rounds y to a whole number.
const MAGIC: f64 = 6_755_399_441_055_744.0;
/// 2^51. Products below it can be taken whole: with half of their last bit added they still fit 53 bits.
const WHOLE: f64 = 2_251_799_813_685_248.0;
const TWO_16: f64 = 65_536.0;
const TWO_32: f64 = 4_294_967_296.0;

#[inline]
fn debug_whole(x: f64) {
    debug_assert!(
        x.trunc() == x && x.abs() < 9_007_199_254_740_992.0,
        "{x} is not exact"
    );
}

/// What `of` says of phases a and b. Unlike `map` of an array it leaves nothing for the optimiser to unwind.
#[inline(always)]
pub fn both<T>(mut of: impl FnMut(usize) -> T) -> [T; 2] {
    [of(0), of(1)]
}

/// What `of` says of phases a, b and c.
#[inline(always)]
pub fn all_three<T>(mut of: impl FnMut(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// 2^exponent, for |exponent| <= 1022.
#[inline]
pub fn pow2(exponent: i32) -> f64 {
    debug_assert!(exponent.abs() <= 1022);
    f64::from_bits(((1023 + i64::from(exponent)) as u64) << 52)
}

/// The whole number nearest to `y`, |y| < 2^51, not half way between two.
#[inline]
fn nearest(y: f64) -> f64 {
    debug_assert!(y.abs() < WHOLE, "{y} is too large to round");
    (y + MAGIC) - MAGIC
}

/// The greatest whole number not above `y`, |y| < 2^51.
#[inline]
pub fn floor(y: f64) -> f64 {
    debug_assert!(y.abs() < WHOLE, "{y} is too large for floor");
    let nearest = (y + MAGIC) - MAGIC;
    // A mask, because a branch would be mispredicted every other time.
    let above = u64::from(nearest > y).wrapping_neg();
    nearest - f64::from_bits(1f64.to_bits() & above)
}

/// floor(x weight) for a whole x and a weight 2^-n, n >= 0: with n fraction bits, subtracting half
/// less half an ulp turns "downwards" into "to the nearest" without ties.
#[inline]
pub fn floor_weighted(x: f64, weight: f64) -> f64 {
    debug_whole(x);
    nearest(x * weight + (0.5 * weight - 0.5))
}

/// floor(x/2): the arithmetic shift by one, |x| < 2^50.
#[inline]
pub fn halve(x: f64) -> f64 {
    floor_weighted(x, 0.5)
}

/// floor(x/2^n), |x| < 2^50.
#[inline]
pub fn floor_shift(x: f64, n: u32) -> f64 {
    floor_weighted(x, pow2(-(n as i32)))
}

/// What the f64 arithmetic behind a constant may be off by, in units of its last bit: specifications
/// with round numbers put constants exactly on a tie, where the order of operations would decide.
const TIE: f64 = 1.0 / TWO_16;

/// R(x) = floor(x + 1/2): how a real constant becomes a word. Ties that f64 just misses count as ties.
pub fn round_half_up(x: f64) -> f64 {
    (x + (0.5 + TIE)).floor()
}

/// floor(x) of a real constant. Whole numbers that f64 just misses count as whole.
pub fn floor_constant(x: f64) -> f64 {
    (x + TIE).floor()
}

/// x modulo 2^32, from 0 up; |x| < 2^50.
#[inline]
pub fn wrap32(x: f64) -> f64 {
    debug_whole(x);
    x - floor_weighted(x, 1.0 / TWO_32) * TWO_32
}

/// The two's complement word of a whole x, |x| < 2^31.
#[inline]
pub fn to_i32(x: f64) -> i32 {
    debug_assert!(
        x.trunc() == x && (-2_147_483_648.0..2_147_483_648.0).contains(&x),
        "{x} is no 32-bit word"
    );
    (x + MAGIC).to_bits() as i32
}

/// The 16-bit count of a whole x, 0 <= x < 2^16.
#[inline]
pub fn to_u16(x: f64) -> u16 {
    debug_assert!(
        x.trunc() == x && (0.0..TWO_16).contains(&x),
        "{x} is no 16-bit count"
    );
    (x + MAGIC).to_bits() as u16
}

/// min(floor(n 2^s/den), limit) for words n >= 0, den > 0 and limit >= 0, by one division: the rounded quotient is at
/// most one off, which the remainder tells.
#[inline]
pub fn divide(n: f64, s: u32, den: f64, limit: f64) -> f64 {
    debug_whole(n);
    debug_assert!(
        (0.0..TWO_32).contains(&n)
            && (1.0..TWO_32).contains(&den)
            && (0.0..TWO_32).contains(&limit),
        "{n}/{den}, at most {limit}"
    );
    let numerator = n * pow2(s as i32);
    let quotient = floor(lesser(numerator / den, limit));
    // Each difference is exact: the upper half of the quotient leaves less than 2^49.
    let high = floor_weighted(quotient, 1.0 / TWO_16) * TWO_16;
    let remainder = (numerator - high * den) - (quotient - high) * den;
    let one = |off: bool| either(off, 1.0, 0.0);
    lesser(
        quotient + one(remainder >= den) - one(remainder < 0.0),
        limit,
    )
}

/// The greater of two numbers, neither of which is NaN: one instruction, where `f64::max` takes five.
#[inline(always)]
pub fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The lesser of two numbers, neither of which is NaN.
#[inline(always)]
pub fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// `y` within low <= high, none of which is NaN.
#[inline(always)]
pub fn within(y: f64, low: f64, high: f64) -> f64 {
    lesser(greater(y, low), high)
}

/// `then` where the condition holds, else `otherwise`: a mask, because a branch would be mispredicted every other time.
#[inline]
pub fn either(condition: bool, then: f64, otherwise: f64) -> f64 {
    let mask = u64::from(condition).wrapping_neg();
    f64::from_bits(then.to_bits() & mask | otherwise.to_bits() & !mask)
}

/// A coefficient word with its shift, split for [`Coefficient::mul`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficient {
    /// The upper part over 2^(s-16).
    high: f64,
    /// The lower 16 bits over 2^16.
    low: f64,
    /// 2^(16-s).
    low_weight: f64,
    /// Half an ulp of the sum that is rounded: breaks ties upwards.
    nudge: f64,
}

impl Coefficient {
    /// Splits the word `raw` with shift `s` <= 62.
    #[inline]
    pub fn new(raw: f64, s: u32) -> Self {
        debug_whole(raw);
        debug_assert!(
            raw.abs() < TWO_32 && s <= 62,
            "coefficient {raw}, shift {s}"
        );
        if s > 16 {
            let high = floor_weighted(raw, 1.0 / TWO_16);
            let low_weight = pow2(16 - s as i32);
            Self {
                high: high * low_weight,
                low: (raw - high * TWO_16) * (1.0 / TWO_16),
                low_weight,
                nudge: 0.5 * low_weight,
            }
        } else {
            // The product is as short as its shifted result plus 16 bits.
            let weight = pow2(-(s as i32));
            let nudge = if s == 0 { 0.0 } else { 0.5 * weight };
            Self {
                high: raw * weight,
                low: 0.0,
                low_weight: 0.0,
                nudge,
            }
        }
    }

    /// mul(c, x) = floor((c x + 2^(s-1))/2^s) for a word x; the bare product for s = 0.
    #[inline]
    pub fn mul(&self, x: f64) -> f64 {
        debug_whole(x);
        debug_assert!(x.abs() <= 2.0 * TWO_32, "{x} is no word");
        // floor(Cl x/2^16), a sum with 16 fraction bits.
        let tail = nearest(self.low * x + (0.5 / TWO_16 - 0.5));
        nearest(self.high * x + (tail * self.low_weight + self.nudge))
    }
}

/// Most fraction bits that leave room for a half below the last one.
const FRACTION: u32 = 51;

/// A shift for products of two run-time words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    bits: u32,
    /// Products below this are taken whole.
    whole: f64,
    /// 2^-s.
    weight: f64,
    /// 2^(16-s), the weight of products of which 16 bits are cut off.
    cut_weight: f64,
}

impl Shift {
    /// A shift by `bits` <= 62.
    pub fn new(bits: u32) -> Self {
        Self {
            bits,
            whole: match bits {
                // As short as their shifted result plus 16 bits.
                0..=16 => f64::INFINITY,
                17..=FRACTION => WHOLE,
                _ => 0.0,
            },
            weight: pow2(-(bits as i32)),
            cut_weight: pow2(16 - bits as i32),
        }
    }

    /// The number of bits.
    #[inline]
    pub fn bits(&self) -> u32 {
        self.bits
    }

    /// x y/2^s and the weight of its last bit. A product too long for f64 loses 16 bits, which the shift cuts off
    /// in any case: its upper and lower half are multiplied apart.
    #[inline]
    fn product(&self, x: f64, y: f64) -> (f64, f64) {
        debug_whole(x);
        debug_whole(y);
        debug_assert!(
            x.abs() <= TWO_32 && y.abs() <= 2.0 * TWO_32,
            "{x} times {y}"
        );
        let whole = x * y;
        if whole.abs() < self.whole {
            debug_whole(whole);
            (whole * self.weight, self.weight)
        } else {
            let high = floor_weighted(x, 1.0 / TWO_16);
            let low = x - high * TWO_16;
            let cut = high * y + floor_weighted(low * y, 1.0 / TWO_16);
            (cut * self.cut_weight, self.cut_weight)
        }
    }

    /// floor(x y/2^s) for words x, y.
    #[inline]
    pub fn floor_product(&self, x: f64, y: f64) -> f64 {
        let (product, weight) = self.product(x, y);
        nearest(product + (0.5 * weight - 0.5))
    }

    /// floor((x y + 2^(s-1))/2^s) for words x, y; the bare product for s = 0.
    #[inline]
    pub fn round_product(&self, x: f64, y: f64) -> f64 {
        let (product, weight) = self.product(x, y);
        // Half an ulp breaks ties upwards; without fraction bits there are none.
        let nudge = if self.bits == 0 { 0.0 } else { 0.5 * weight };
        nearest(product + nudge)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIRS: usize = 4_000_000;

    /// Words of every length, with the extremes and their neighbours often among them.
    fn word(random: &mut fastrand::Rng) -> i64 {
        const CORNERS: [i64; 9] = [
            0,
            1,
            -1,
            i32::MAX as i64,
            i32::MIN as i64,
            i32::MIN as i64 + 1,
            65_535,
            65_536,
            -65_536,
        ];
        if random.u8(..) < 24 {
            CORNERS[random.usize(..CORNERS.len())]
        } else {
            i64::from(random.i32(..) >> random.u32(..32))
        }
    }

    fn fits_word(x: i128) -> bool {
        i32::try_from(x).is_ok()
    }

    #[test]
    fn floor_and_shifts() {
        let mut random = fastrand::Rng::with_seed(1);
        for _ in 0..PAIRS {
            let (x, n) = (random.i64(-(1 << 50)..1 << 50), random.u32(..52));
            assert_eq!(floor_shift(x as f64, n) as i64, x >> n, "{x} >> {n}");
            assert_eq!(wrap32(x as f64) as i64, x.rem_euclid(1 << 32), "{x}");
            let x = word(&mut random);
            assert_eq!(i64::from(to_i32(x as f64)), x);
            assert_eq!(halve(x as f64) as i64, x >> 1);
        }
        for x in 0..=u16::MAX {
            assert_eq!(to_u16(f64::from(x)), x);
        }
        for (y, floored) in [
            (-0.5, -1.0),
            (0.5, 0.0),
            (1.5, 1.0),
            (-1.5, -2.0),
            (2.0, 2.0),
            (-2.0, -2.0),
            (0.0, 0.0),
        ] {
            assert_eq!(floor(y), floored);
        }
    }

    #[test]
    fn constants_on_a_tie_do_not_depend_on_the_order_of_operations() {
        // An inductance of 1.145 mH at 50 us, 30 A over 2^11 counts, 48 V over 1800 counts.
        let (k, g, w) = (0.001_145 / 5e-5, 0.014_648_437_5, 48.0 / 1800.0);
        for value in [
            k * g / w * 2048.0,
            g / w * 2048.0 * 0.001_145 / 5e-5,
            g / w * 2048.0 / (5e-5 / 0.001_145),
        ] {
            assert_eq!(round_half_up(value), 25_763.0);
        }
        assert_eq!(round_half_up(2.4999), 2.0);
        assert_eq!(round_half_up(-2.5), -2.0);
        assert_eq!(floor_constant(8_189.999_999_999), 8190.0);
        assert_eq!(floor_constant(8189.999), 8189.0);
    }

    #[test]
    fn products_of_words() {
        let mut random = fastrand::Rng::with_seed(2);
        let mut kept = 0;
        while kept < PAIRS {
            let (c, x, s) = (word(&mut random), word(&mut random), random.u32(..62));
            let product = i128::from(c) * i128::from(x);
            let rounded = if s == 0 {
                product
            } else {
                (product + (1 << (s - 1))) >> s
            };
            if !fits_word(rounded) {
                continue;
            }
            kept += 1;
            assert_eq!(
                Coefficient::new(c as f64, s).mul(x as f64) as i128,
                rounded,
                "{c} * {x} >> {s}"
            );
            let shift = Shift::new(s);
            assert_eq!(
                shift.round_product(c as f64, x as f64) as i128,
                rounded,
                "{c} * {x} >> {s}"
            );
            assert_eq!(
                shift.floor_product(c as f64, x as f64) as i128,
                product >> s,
                "{c} * {x} >> {s}"
            );
        }
    }

    #[test]
    fn products_at_ties_and_next_to_them() {
        // c = odd * 2^k and x chosen so that c x lies on, just below and just above a half.
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..PAIRS {
            let (s, x) = (random.u32(1..40), i128::from(random.i32(1..)));
            let want = i128::from(random.i32(..) >> random.u32(..31));
            let half = ((2 * want + 1) << s) / 2;
            for c in [half / x, half / x + 1, half / x - 1] {
                let product = c * x;
                let rounded = (product + (1 << (s - 1))) >> s;
                if fits_word(c) && fits_word(rounded) {
                    assert_eq!(
                        Coefficient::new(c as f64, s).mul(x as f64) as i128,
                        rounded,
                        "{c} * {x} >> {s}"
                    );
                }
            }
        }
    }

    #[test]
    fn quotients() {
        let mut random = fastrand::Rng::with_seed(4);
        for _ in 0..PAIRS {
            let (n, den, s) = (
                word(&mut random).abs(),
                word(&mut random).abs().max(1),
                random.u32(..62),
            );
            let exact = (i128::from(n) << s) / i128::from(den);
            let limit = word(&mut random).abs();
            assert_eq!(
                divide(n as f64, s, den as f64, limit as f64) as i128,
                exact.min(i128::from(limit)),
                "({n} << {s}) / {den}, at most {limit}"
            );
        }
    }
}
