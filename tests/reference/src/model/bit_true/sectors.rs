//! The sectors of the rotor as angle words, between the Hall edges.

use crate::exact::pow2;
use crate::spec::EVEN_EDGES;

/// SIXTH: 60 degrees as an angle word, floor(2^32/6).
pub const SIXTH: f64 = 715_827_882.0;
/// Half of that.
pub const HALF_SIXTH: f64 = 357_913_941.0;
/// 30 degrees as an angle word, rounded up.
pub const TWELFTH: f64 = 357_913_942.0;

/// The sectors as angle words; entry 0 is "no sector".
#[derive(Clone, Copy, Debug)]
pub struct Sectors {
    /// Where each begins.
    pub start: [f64; 7],
    /// Its last word, from its first.
    pub last: [f64; 7],
    /// Half of it.
    pub half: [f64; 7],
}

impl Sectors {
    /// `degrees`: the angles at which sectors 1 to 6 begin, where sensors are out of place.
    pub fn new(degrees: Option<[f64; 6]>) -> Self {
        let mut sectors = Self {
            start: [0.0; 7],
            last: [SIXTH - 1.0; 7],
            half: [HALF_SIXTH; 7],
        };
        let turn = pow2(32);
        // Near a whole word, that word.
        let word_of = |degrees: f64| (degrees / 360.0 * turn - 1e-4).ceil().rem_euclid(turn);
        let begins = degrees.unwrap_or(EVEN_EDGES).map(word_of);
        for (k, begin) in begins.iter().enumerate() {
            sectors.start[k + 1] = *begin;
            if degrees.is_some() {
                let width = (begins[(k + 1) % 6] - begin).rem_euclid(turn);
                sectors.last[k + 1] = width - 1.0;
                sectors.half[k + 1] = ((width - 1.0) / 2.0).floor();
            }
        }
        if degrees.is_some() {
            sectors.last[0] = 0.0;
            sectors.half[0] = 0.0;
        }
        sectors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::{floor, wrap32};

    #[test]
    fn sectors_start_at_the_first_word_after_their_edge() {
        let sectors = Sectors::new(None);
        for (sector, start) in sectors.start.iter().enumerate().skip(1) {
            let degrees = (60 * (sector as i128 - 1) - 30).rem_euclid(360);
            assert_eq!(*start as i128, ((degrees << 32) + 359) / 360);
            let index = |theta: f64| floor(wrap32(theta + TWELFTH) * 6.0 * pow2(-32)) as usize;
            assert_eq!(index(*start), sector - 1);
            assert_eq!(index(*start + SIXTH - 1.0), sector - 1);
        }
    }
}
