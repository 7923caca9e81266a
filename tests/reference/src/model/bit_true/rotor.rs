//! The rotor's angle from the timing of the Hall edges (section 4).

use super::constants::Constants;
use super::sectors::{HALF_SIXTH, TWELFTH};
use super::state::State;
use crate::exact::{Word, floor, greater, lesser, pow2, to_index, word, wrap32};
use crate::model::hall::HallClock;
use crate::model::sector::HallEvent;

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
