//! The rotor's angle from the timing of the Hall edges (section 4).

use super::constants::Constants;
use super::state::State;
use crate::exact::{Word, floor, greater, lesser, pow2, to_index, word, wrap32};
use crate::model::hall::HallClock;
use crate::model::sector::HallEvent;
use crate::spec::EVEN_EDGES;

/// SIXTH: 60 degrees as an angle word, floor(2^32/6).
const SIXTH: f64 = 715_827_882.0;
/// Half of that.
const HALF_SIXTH: f64 = 357_913_941.0;
/// 30 degrees as an angle word, rounded up.
const TWELFTH: f64 = 357_913_942.0;
/// The sectors as angle words; entry 0 is "no sector".
#[derive(Clone, Copy, Debug)]
pub struct Sectors {
    /// Where each begins.
    start: [f64; 7],
    /// Its last word, from its first.
    last: [f64; 7],
    /// Half of it.
    half: [f64; 7],
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

/// The rotor at this sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct Angle<W> {
    /// Angle word, 0 to 2^32 - 1.
    pub theta: W,
    /// Angle per period, signed.
    pub step: W,
    /// Angle per tick.
    pub omega: W,
    /// Sector with its advance.
    pub sector_eff: usize,
}

/// The angle after `state.timing` has followed the sample.
#[inline]
pub fn angle<W: Word>(
    clock: &HallClock,
    k: &Constants<W>,
    state: &State<W>,
    event: &HallEvent,
) -> Angle<W> {
    let timing = &state.timing;
    let turning = timing.edges == 2;
    let omega = if !turning {
        word(0.0)
    } else if event.edge {
        floor(word::<W>(pow2(32) - 1.0) / greater(timing.rev, clock.rev_min))
    } else {
        state.omega
    };
    let (start, last) = (k.sectors.start[event.sector], k.sectors.last[event.sector]);
    let progress = lesser(omega * timing.age_prev, last);
    let turn = match k.k_ticks {
        None => omega * clock.ticks,
        Some(k_ticks) => k_ticks.mul(omega),
    };
    let turn = lesser(turn, HALF_SIXTH);
    let step = timing.direction * turn;
    let in_sector = if !turning {
        word(k.sectors.half[event.sector])
    } else if timing.direction > 0.0 {
        progress
    } else {
        -progress + last
    };
    let theta = wrap32(in_sector + start);
    let sector_eff = if k.advanced && turning {
        let ahead = wrap32(theta + k.k_advance.mul(step) + TWELFTH);
        to_index(floor(ahead * 6.0 * pow2(-32))) + 1
    } else {
        event.sector
    };
    Angle {
        theta,
        step,
        omega,
        sector_eff,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
