//! Tables of periodic functions of the electrical angle, quadratic in every segment.

use crate::exact::{Halves, Shift, Word, floor, pow2, round_half_up, split, to_index, wrap32};
use std::f64::consts::TAU;

/// A third of a turn as an angle word.
const THIRD: f64 = 1_431_655_765.0;

/// A table of one function.
#[derive(Clone, Debug, Default)]
pub struct Table<W> {
    /// Segments per turn over 2^32.
    scale: f64,
    upper: Shift,
    segments: Vec<[W; 3]>,
}

impl<W: Word> Table<W> {
    /// Tabulates `y(theta)` (radians) in `segments` segments with `frac_bits` fraction bits.
    pub fn new(segments: u32, frac_bits: u32, y: impl Fn(f64) -> f64) -> Self {
        let width = TAU / f64::from(segments);
        let raw = |value: f64| round_half_up(value * pow2(frac_bits as i32));
        let coefficients = |index: u32| {
            let left = f64::from(index) * width;
            let (y0, y1, y2) = (y(left), y(left + width / 2.0), y(left + width));
            [raw(y1), raw(y2 - y0), raw(2.0 * (y0 + y2) - 4.0 * y1)]
        };
        let rows: Vec<[f64; 3]> = (0..segments).map(coefficients).collect();
        // Any row may be read.
        let any = |row: &[f64; 3]| {
            [0, 1, 2].map(|place| {
                let column = || rows.iter().map(|row| row[place]);
                let least = column().fold(f64::INFINITY, f64::min);
                let greatest = column().fold(f64::NEG_INFINITY, f64::max);
                W::whole(row[place], least, greatest)
            })
        };
        Self {
            scale: f64::from(segments) * pow2(-32),
            upper: Shift::new(32),
            segments: rows.iter().map(any).collect(),
        }
    }

    /// The function of phases a and b at an angle word of phase a (not yet wrapped).
    #[inline]
    pub fn both(&self, theta: W) -> [W; 2] {
        [self.at(wrap32(theta)), self.at(wrap32(theta - THIRD))]
    }

    /// The function at an angle word from 0 to 2^32 - 1.
    #[inline]
    pub fn at(&self, theta: W) -> W {
        let (index, position) = split(theta * self.scale);
        let t = Halves::of(floor(position * pow2(32)) - pow2(31));
        let [c0, c1, c2] = self.segments[to_index(index)];
        let slope = c1 + self.upper.floor_product_of_halves(t, c2);
        c0 + self.upper.floor_product_of_halves(t, slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_follows_the_function() {
        let table = Table::new(24, 24, f64::sin);
        for step in 0..10_000 {
            let theta = floor(f64::from(step) * 429_496.729_6);
            let [a, b] = table.both(theta).map(|word| word * pow2(-24));
            let exact = theta * TAU * pow2(-32);
            assert!((a - exact.sin()).abs() < 2e-4, "{a} at {exact}");
            assert!(
                (b - (exact - TAU / 3.0).sin()).abs() < 2e-4,
                "{b} at {exact}"
            );
        }
    }
}
