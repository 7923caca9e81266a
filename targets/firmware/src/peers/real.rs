//! Number types of the naive controllers.

use super::paper::{CORNERS, VECTORS};
use core::ops::{Add, Mul, Neg, Sub};
use hexagen::fixed::types::I16F16;

/// Arithmetic of a naive controller.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
{
    /// Reference corners in ampere, by Hall code.
    const CORNERS: [[Self; 2]; 8];
    /// Vectors V0 to V6 in volt.
    const VECTORS: [[Self; 2]; 7];
    /// A constant; folded by the compiler.
    fn num(value: f64) -> Self;
    /// An ADC count.
    fn count(count: u16) -> Self;
    /// A compare value: integer counts, from 0 to `most`.
    fn compare(self, most: u16) -> u16;

    /// Minimum.
    #[must_use]
    fn least(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// Maximum.
    #[must_use]
    fn greatest(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

/// Converts a table at compile time.
macro_rules! converted {
    ($table:expr, $rows:literal, |$value:ident| $convert:expr) => {{
        let from = $table;
        let mut to = [[{
            let $value: f64 = 0.0;
            $convert
        }; 2]; $rows];
        let mut row = 0;
        while row < from.len() {
            let mut x = 0;
            while x < 2 {
                let $value: f64 = from[row][x];
                to[row][x] = $convert;
                x += 1;
            }
            row += 1;
        }
        to
    }};
}

impl Real for f32 {
    const CORNERS: [[Self; 2]; 8] = converted!(CORNERS, 8, |value| value as f32);
    const VECTORS: [[Self; 2]; 7] = converted!(VECTORS, 7, |value| value as f32);

    #[inline]
    fn num(value: f64) -> Self {
        value as f32
    }

    #[inline]
    fn count(count: u16) -> Self {
        Self::from(count)
    }

    #[inline]
    fn compare(self, most: u16) -> u16 {
        // Clamped as an integer: the conversion to 32 bits is one instruction, which saturates.
        (self as u32).min(most.into()) as u16
    }
}

impl Real for I16F16 {
    const CORNERS: [[Self; 2]; 8] = converted!(CORNERS, 8, |value| I16F16::from_bits(
        (value * 65_536.0) as i32
    ));
    const VECTORS: [[Self; 2]; 7] = converted!(VECTORS, 7, |value| I16F16::from_bits(
        (value * 65_536.0) as i32
    ));

    #[inline]
    fn num(value: f64) -> Self {
        Self::from_bits((value * 65_536.0) as i32)
    }

    #[inline]
    fn count(count: u16) -> Self {
        Self::from_num(count)
    }

    #[inline]
    fn compare(self, most: u16) -> u16 {
        self.greatest(Self::ZERO).least(Self::count(most)).to_num()
    }
}
