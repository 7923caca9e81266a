//! Exact integer operations in f64, for words of 32 bits.
//!
//! A word is an f64 with an integer value of at most 32 bits and sign. Sums and products below 2^53
//! are exact in f64; longer products are split at 16 bits first (floor(C x/2^s) = floor((Ch x +
//! floor(Cl x/2^16))/2^(s-16)) with C = Ch 2^16 + Cl), so every intermediate is exact. The
//! cross-crate tests prove this for all words of a drive's formats, over words with intervals; the
//! tests here compare with 128-bit integers.
#![expect(
    clippy::inline_always,
    reason = "the models spend their time in these few instructions"
)]

use crate::word::{TWO_16, TWO_32};
pub use crate::word::{WHOLE, Word, pow2};

/// A constant as a word.
#[inline(always)]
pub fn word<W: Word>(x: f64) -> W {
    x.into()
}

/// An input number: any of its type.
#[inline(always)]
pub fn input<W: Word>(x: impl Outside) -> W {
    x.any()
}

/// A type of input numbers.
pub trait Outside {
    /// The number, standing for any of its type.
    fn any<W: Word>(self) -> W;
}

impl Outside for u16 {
    #[inline(always)]
    fn any<W: Word>(self) -> W {
        W::whole(self.into(), 0.0, TWO_16 - 1.0)
    }
}

impl Outside for i32 {
    #[inline(always)]
    fn any<W: Word>(self) -> W {
        W::whole(self.into(), -TWO_32 / 2.0, TWO_32 / 2.0 - 1.0)
    }
}

/// The greatest integer not above `y` ([`Word::floor`]).
#[inline(always)]
#[track_caller]
pub fn floor<W: Word>(y: W) -> W {
    y.floor()
}

/// Maximum.
#[inline(always)]
pub fn greater<W: Word>(a: W, b: impl Into<W>) -> W {
    a.greater(b.into())
}

/// Minimum.
#[inline(always)]
pub fn lesser<W: Word>(a: W, b: impl Into<W>) -> W {
    a.lesser(b.into())
}

/// `then` if the condition holds, else `otherwise`.
#[inline(always)]
pub fn either<W: Word>(condition: bool, then: W, otherwise: W) -> W {
    W::either(condition, then, otherwise)
}

/// `y` clamped to low <= high.
#[inline(always)]
pub fn within<W: Word>(y: W, low: impl Into<W>, high: impl Into<W>) -> W {
    lesser(greater(y, low), high)
}

/// The 16-bit count of an integer x, 0 <= x < 2^16.
#[inline(always)]
#[track_caller]
pub fn to_u16<W: Word>(x: W) -> u16 {
    x.known(0.0, TWO_16 - 1.0).to_i32() as u16
}

/// The index of a small integer x >= 0.
#[inline(always)]
#[track_caller]
pub fn to_index<W: Word>(x: W) -> usize {
    x.to_i32() as usize
}

/// `of` for phases a and b. Unlike `map` of an array, needs no unwinding.
#[inline(always)]
pub fn both<T>(mut of: impl FnMut(usize) -> T) -> [T; 2] {
    [of(0), of(1)]
}

/// `of` for phases a, b and c.
#[inline(always)]
pub fn all_three<T>(mut of: impl FnMut(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// floor(x weight) for a whole x and a weight 2^-n, n >= 0: with n fraction bits, subtracting half
/// less half an ulp turns "downwards" into "to the nearest" without ties.
#[inline]
#[track_caller]
pub fn floor_weighted<W: Word>(x: W, weight: f64) -> W {
    let _site = W::here();
    x.debug_whole();
    W::nearest(x * weight + (0.5 * weight - 0.5))
}

/// floor(x/2): the arithmetic shift by one, |x| < 2^50.
#[inline]
#[track_caller]
pub fn halve<W: Word>(x: W) -> W {
    let _site = W::here();
    floor_weighted(x, 0.5)
}

/// floor(x/2^n), |x| < 2^50.
#[inline]
#[track_caller]
pub fn floor_shift<W: Word>(x: W, n: u32) -> W {
    let _site = W::here();
    floor_weighted(x, pow2(-(n as i32)))
}

/// Tolerance of the f64 arithmetic of a constant, in units of its last bit: specifications with
/// round numbers make constants exactly on a tie, which the order of operations would decide.
const TIE: f64 = 1.0 / TWO_16;

/// R(x) = floor(x + 1/2): rounding of a real constant to a word. Near ties count as ties.
pub fn round_half_up(x: f64) -> f64 {
    (x + (0.5 + TIE)).floor()
}

/// floor(x) of a real constant. Near integers count as integers.
pub fn floor_constant(x: f64) -> f64 {
    (x + TIE).floor()
}

/// x modulo 2^32, from 0 up; |x| < 2^50.
#[inline]
#[track_caller]
pub fn wrap32<W: Word>(x: W) -> W {
    let _site = W::here();
    x.debug_whole();
    let wrapped = x - floor_weighted(x, 1.0 / TWO_32) * TWO_32;
    wrapped.known(0.0, TWO_32 - 1.0)
}

/// floor(y), |y| < 2^51, and the remainder.
#[inline]
#[track_caller]
pub fn split<W: Word>(y: W) -> (W, W) {
    let _site = W::here();
    let whole = floor(y);
    (whole, (y - whole).known(0.0, 1.0))
}

/// A coefficient word with its shift, split for [`Coefficient::mul`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficient<W> {
    /// The upper part over 2^(s-16).
    high: W,
    /// The lower 16 bits over 2^16.
    low: W,
    /// 2^(16-s).
    low_weight: f64,
    /// Half an ulp of the sum that is rounded: breaks ties upwards.
    nudge: f64,
}

impl<W: Word> Coefficient<W> {
    /// Splits the word `raw` with shift `s` <= 62.
    #[inline]
    #[track_caller]
    pub fn new(raw: impl Into<W>, s: u32) -> Self {
        let _site = W::here();
        let raw: W = raw.into();
        raw.debug_whole();
        raw.debug_at_most(TWO_32);
        debug_assert!(s <= 62, "shift {s}");
        if s > 16 {
            let high = floor_weighted(raw, 1.0 / TWO_16);
            let low_weight = pow2(16 - s as i32);
            Self {
                high: high * low_weight,
                low: (raw - high * TWO_16).known(0.0, TWO_16 - 1.0) * (1.0 / TWO_16),
                low_weight,
                nudge: 0.5 * low_weight,
            }
        } else {
            // The product is as short as its shifted result plus 16 bits.
            let weight = pow2(-(s as i32));
            let nudge = if s == 0 { 0.0 } else { 0.5 * weight };
            Self {
                high: raw * weight,
                low: word(0.0),
                low_weight: 0.0,
                nudge,
            }
        }
    }

    /// mul(c, x) = floor((c x + 2^(s-1))/2^s) for a word x; the bare product for s = 0.
    #[inline]
    #[track_caller]
    pub fn mul(&self, x: W) -> W {
        let _site = W::here();
        x.debug_whole();
        x.debug_at_most(2.0 * TWO_32);
        // floor(Cl x/2^16), a sum with 16 fraction bits.
        let tail = W::nearest(self.low * x + (0.5 / TWO_16 - 0.5));
        W::nearest(self.high * x + (tail * self.low_weight + self.nudge))
    }
}

/// The upper and lower 16 bits of a word: high 2^16 + low, 0 <= low < 2^16.
#[derive(Clone, Copy, Debug)]
pub struct Halves<W> {
    high: W,
    low: W,
}

impl<W: Word> Halves<W> {
    /// Splits a word.
    #[inline(always)]
    #[track_caller]
    pub fn of(x: W) -> Self {
        let _site = W::here();
        let high = floor_weighted(x, 1.0 / TWO_16);
        Self {
            high,
            low: (x - high * TWO_16).known(0.0, TWO_16 - 1.0),
        }
    }

    /// floor(x y/2^16) for a word y.
    #[inline(always)]
    #[track_caller]
    fn product(self, y: W) -> W {
        let _site = W::here();
        self.high * y + floor_weighted(self.low * y, 1.0 / TWO_16)
    }
}

/// Maximum fraction bits that leave room for a half below the last one.
const FRACTION: u32 = 51;

/// A shift for products of two run-time words.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    bits: u32,
    /// Limit of products computed without splitting.
    whole: f64,
    /// 2^-s.
    weight: f64,
    /// 2^(16-s), the weight of products without their 16 lowest bits.
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

    /// x y/2^s rounded to the nearest with `nudge` of the weight of its last bit added. A product
    /// too long for f64 loses 16 bits, which the shift removes in any case: its upper and lower
    /// half are multiplied separately.
    #[inline]
    fn product<W: Word>(&self, x: W, y: W, nudge: impl Fn(f64) -> f64) -> W {
        x.debug_whole();
        y.debug_whole();
        x.debug_at_most(TWO_32);
        y.debug_at_most(2.0 * TWO_32);
        if let Some(whole) = x.product_below(y, self.whole) {
            whole.debug_whole();
            W::nearest(whole * self.weight + nudge(self.weight))
        } else {
            let cut = Halves::of(x).product(y);
            W::nearest(cut * self.cut_weight + nudge(self.cut_weight))
        }
    }

    /// floor(x y/2^s) for words x, y.
    #[inline]
    #[track_caller]
    pub fn floor_product<W: Word>(&self, x: W, y: W) -> W {
        let _site = W::here();
        self.product(x, y, |weight| 0.5 * weight - 0.5)
    }

    /// The same for a word in halves and a shift above 16: without a branch, for factors of every length.
    #[inline]
    #[track_caller]
    pub fn floor_product_of_halves<W: Word>(&self, x: Halves<W>, y: W) -> W {
        let _site = W::here();
        debug_assert!(self.bits > 16, "shift {}", self.bits);
        y.debug_at_most(2.0 * TWO_32);
        floor_weighted(x.product(y), self.cut_weight)
    }

    /// floor((x1 y1 + x2 y2)/2^s) for words whose products' sum fits 64 bits. For shifts above 16
    /// the upper and lower halves of the first factors are multiplied separately, and the lower
    /// products lose the 16 bits together.
    #[inline]
    #[track_caller]
    pub fn floor_sum_of_products<W: Word>(&self, [x1, y1]: [W; 2], [x2, y2]: [W; 2]) -> W {
        let _site = W::here();
        if self.bits <= 16 {
            // As short as its shifted result plus 16 bits.
            return floor_weighted(x1 * y1 + x2 * y2, self.weight);
        }
        let (x1, x2) = (Halves::of(x1), Halves::of(x2));
        let lost = floor_weighted(x1.low * y1 + x2.low * y2, 1.0 / TWO_16);
        floor_weighted(x1.high * y1 + x2.high * y2 + lost, self.cut_weight)
    }

    /// floor((x y + 2^(s-1))/2^s) for words x, y; the bare product for s = 0.
    #[inline]
    #[track_caller]
    pub fn round_product<W: Word>(&self, x: W, y: W) -> W {
        let _site = W::here();
        // Half an ulp breaks ties upwards; without fraction bits there are none.
        let is_whole = self.bits == 0;
        self.product(x, y, |weight| if is_whole { 0.0 } else { 0.5 * weight })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIRS: usize = 4_000_000;

    /// Words of every length, with the extremes and their neighbours frequent.
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
            assert_eq!(i64::from((x as f64).to_i32()), x);
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
            if s > 16 {
                let halves = Halves::of(c as f64);
                assert_eq!(
                    shift.floor_product_of_halves(halves, x as f64) as i128,
                    product >> s,
                    "{c} * {x} >> {s}"
                );
            }
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
                (n as f64).divide(s, den as f64, limit as f64) as i128,
                exact.min(i128::from(limit)),
                "({n} << {s}) / {den}, at most {limit}"
            );
        }
    }
}
