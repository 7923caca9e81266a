//! Error intervals of values, and the real numbers that words represent.
//!
//! Errors are in units of the value's last place, as multiples of 2^-24 of it, rounded outward by
//! every operation, so that a stated bound is never too narrow and a checker with 60 bits can prove
//! it.

use std::fmt;

use super::interval::Interval;

/// Errors are multiples of 2^-24.
const FRACTION_BITS: u32 = 24;

/// Errors from here on count as unbounded: far above all words.
const UNBOUNDED: i128 = 1 << (40 + FRACTION_BITS);

/// Errors saturate here; products of a word and a bounded error stay below.
const LARGEST: i128 = 1 << 100;

/// A real number of the generator, exactly: m 2^e.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Real {
    /// m
    pub mantissa: i64,
    /// e
    pub exponent: i32,
}

impl Real {
    /// The value of a finite floating-point number; zero for others.
    pub fn of(x: f64) -> Self {
        if x == 0.0 || !x.is_finite() {
            return Self {
                mantissa: 0,
                exponent: 0,
            };
        }
        let bits = x.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i32;
        let fraction = (bits & ((1 << 52) - 1)) as i64;
        let (magnitude, exponent) = match exponent {
            0 => (fraction, -1074),
            _ => (fraction | 1 << 52, exponent - 1075),
        };
        let zeros = magnitude.trailing_zeros();
        let mantissa = magnitude >> zeros;
        Self {
            mantissa: if x < 0.0 { -mantissa } else { mantissa },
            exponent: exponent + zeros as i32,
        }
    }

    /// As a floating-point number, exactly.
    pub fn value(self) -> f64 {
        // Two steps, so that neither factor leaves the range of normal numbers.
        let half = self.exponent / 2;
        self.mantissa as f64 * f64::from(half).exp2() * f64::from(self.exponent - half).exp2()
    }
}

impl fmt::Display for Real {
    /// `m b e`, as proof checkers read it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}b{}", self.mantissa, self.exponent)
    }
}

/// The real number that a word of the program represents.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exact {
    /// The integer itself: a count, a sign, a limit defined as an integer.
    Itself,
    /// A real number that was rounded, in units of the word's last place.
    Number(Real),
    /// A real number within so many units of the last place.
    Within(u32),
}

/// An interval of errors: a value less its value without any rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ErrorInterval {
    low: i128,
    high: i128,
}

impl ErrorInterval {
    /// No error.
    pub const ZERO: Self = Self { low: 0, high: 0 };

    /// `low..=high` in units of the last place, rounded outward.
    pub fn new(low: f64, high: f64) -> Self {
        let unit = f64::from(1_u32 << FRACTION_BITS);
        Self {
            low: (low * unit).floor() as i128,
            high: (high * unit).ceil() as i128,
        }
        .held()
    }

    /// `-bound..=bound` in units of the last place.
    pub fn symmetric(bound: f64) -> Self {
        Self::new(-bound, bound)
    }

    /// Of rounding down: up to one unit too low.
    pub fn floor() -> Self {
        Self::new(-1.0, 0.0)
    }

    /// Of rounding to nearest.
    pub fn nearest() -> Self {
        Self::symmetric(0.5)
    }

    /// No bound.
    pub fn unbounded() -> Self {
        Self {
            low: -LARGEST,
            high: LARGEST,
        }
    }

    /// Of a word that represents `exact`.
    pub fn of(word: i32, exact: Exact) -> Self {
        match exact {
            Exact::Itself => Self::ZERO,
            Exact::Number(number) => {
                // The two are close, so the difference is exact.
                let error = f64::from(word) - number.value();
                Self::new(error, error)
            }
            Exact::Within(units) => Self::symmetric(f64::from(units)),
        }
    }

    /// Least error, in units of the last place.
    pub fn low(self) -> Real {
        Self::real(self.low)
    }

    /// Greatest error, in units of the last place.
    pub fn high(self) -> Real {
        Self::real(self.high)
    }

    fn real(units: i128) -> Real {
        let zeros = units.trailing_zeros().min(FRACTION_BITS + 60);
        if units == 0 {
            return Real::of(0.0);
        }
        Real {
            mantissa: (units >> zeros) as i64,
            exponent: zeros as i32 - FRACTION_BITS as i32,
        }
    }

    /// Largest magnitude, in units of the last place, rounded up.
    pub fn magnitude(self) -> f64 {
        let units = self.low.abs().max(self.high.abs());
        // At most 2^53 units are exact; beyond, the conversion rounds to nearest.
        let widened = if units > 1 << 53 {
            units + (units >> 50)
        } else {
            units
        };
        widened as f64 / f64::from(1_u32 << FRACTION_BITS)
    }

    /// Whether there is no bound.
    pub fn is_unbounded(self) -> bool {
        self.low <= -UNBOUNDED || self.high >= UNBOUNDED
    }

    /// Whether there is no error at all.
    pub fn is_zero(self) -> bool {
        self == Self::ZERO
    }

    /// Whether every error of `inner` is one of these.
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

    /// The errors of both.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self {
            low: self.low.max(other.low),
            high: self.high.min(other.high),
        }
    }

    /// Of a sum.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            low: self.low + other.low,
            high: self.high + other.high,
        }
        .held()
    }

    /// Of a difference.
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    /// Of the negative.
    #[must_use]
    pub fn negated(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }

    /// Of the magnitude: the distance of |a| and |b| is at most that of a and b.
    #[must_use]
    pub fn magnitudes(self) -> Self {
        let most = self.low.abs().max(self.high.abs());
        Self {
            low: -most,
            high: most,
        }
    }

    /// Of the product of `a` and `b` with the errors `e_a` and `e_b`: a b - (a - e_a)(b - e_b).
    pub fn product(a: Interval, e_a: Self, b: Interval, e_b: Self) -> Self {
        let corrected = Self {
            low: -e_a.high,
            high: -e_a.low,
        };
        e_b.times(a)
            .plus(e_a.times(b))
            .plus(corrected.times_error(e_b))
    }

    /// Times an integer of the interval.
    #[must_use]
    pub fn times(self, factor: Interval) -> Self {
        let corners = [factor.low, factor.high].map(|factor| {
            [self.low, self.high].map(|error| i128::from(factor).saturating_mul(error))
        });
        Self::hull(corners.as_flattened()).held()
    }

    fn times_error(self, other: Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::ZERO;
        }
        let corners =
            [self.low, self.high].map(|x| [other.low, other.high].map(|y| x.saturating_mul(y)));
        let product = Self::hull(corners.as_flattened());
        Self {
            low: product.low >> FRACTION_BITS,
            high: -(-product.high >> FRACTION_BITS),
        }
        .held()
    }

    /// Times 2^n.
    #[must_use]
    pub fn shifted_left(self, n: u32) -> Self {
        self.times(Interval::point(1 << n.min(62)))
    }

    /// Over 2^n.
    #[must_use]
    pub fn shifted_right(self, n: u32) -> Self {
        Self {
            low: self.low >> n,
            high: -(-self.high >> n),
        }
    }

    /// Over an integer of at least `least` > 0, times 2^n; symmetric.
    #[must_use]
    pub fn quotient(self, n: u32, least: f64) -> Self {
        Self::symmetric(self.magnitude() * f64::from(n).exp2() / least * (1.0 + f64::EPSILON * 8.0))
    }

    fn hull(corners: &[i128]) -> Self {
        Self {
            low: corners.iter().copied().fold(i128::MAX, i128::min),
            high: corners.iter().copied().fold(i128::MIN, i128::max),
        }
    }

    /// Saturated, and rounded outward to 62 bits.
    fn held(self) -> Self {
        let floor = |units: i128| {
            let spare = (128 - units.abs().leading_zeros()).saturating_sub(62);
            units >> spare << spare
        };
        Self {
            low: floor(self.low.clamp(-LARGEST, LARGEST)),
            high: -floor(-self.high.clamp(-LARGEST, LARGEST)),
        }
    }
}

impl fmt::Display for ErrorInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{},{}]", self.low(), self.high())
    }
}
