//! The rotor's angle from the timing of the Hall edges (section 4).

use super::constants::Constants;
use super::hall_learning::{Learnt, Turn};
use super::parts::Part;
use super::sectors::{HALF_SIXTH, TWELFTH};
use super::state::{Speed, State};
use crate::exact::{Word, floor, greater, lesser, pow2, to_index, word, wrap32};
use crate::model::hall::{HallClock, HallTiming};
use crate::model::sector::HallEvent;

/// The rotor at this sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct Angle<W: Word> {
    /// Angle word, 0 to 2^32 - 1.
    pub theta: W,
    pub speed: Speed<W>,
    /// Sector with its advance.
    pub sector_eff: usize,
    /// Where the edges stand.
    pub learnt: Learnt<W>,
}

/// The angle of a sensor, after `timing` has followed the sample.
#[inline]
pub fn sensed<W: Word>(
    k: &Constants<W>,
    timing: &HallTiming<W>,
    theta: f64,
    sector: usize,
) -> Angle<W> {
    let theta = word(theta);
    Angle {
        theta,
        speed: Speed {
            omega: timing.step * timing.direction,
            rise: word(0.0),
            step: timing.step,
        },
        sector_eff: advanced(k, timing, (theta, timing.step), sector),
        learnt: Learnt::default(),
    }
}

/// The sector with its advance; the present one while the speed is unknown.
#[inline]
fn advanced<W: Word>(
    k: &Constants<W>,
    timing: &HallTiming<W>,
    (theta, step): (W, W),
    sector: usize,
) -> usize {
    if !k.advanced || timing.edges < 2 {
        return sector;
    }
    let ahead = wrap32(theta + k.k_advance.mul(step) + TWELFTH);
    to_index(floor(ahead * 6.0 * pow2(-32))) + 1
}

/// The angle after `state.timing` has followed the sample; `tells`: at an edge behind a whole turn of steady speed.
#[inline]
pub fn angle<W: Word>(
    clock: &HallClock,
    k: &Constants<W>,
    state: &State<W>,
    (event, tells): (&HallEvent, bool),
    i: [W; 2],
) -> Angle<W> {
    let timing = &state.timing;
    let turning = timing.edges >= 2;
    let (start, last) = (k.sectors.start[event.sector], k.sectors.last[event.sector]);
    let (mut speed, mut learnt) = (state.speed, state.learnt);
    if !turning {
        (speed.omega, speed.step) = (word(0.0), word(0.0));
    }
    if event.edge {
        let rate = floor(word::<W>(pow2(32) - 1.0) / greater(timing.rev, clock.rev_min));
        let turn = match k.k_ticks {
            None => rate * clock.ticks,
            Some(k_ticks) => k_ticks.mul(rate),
        };
        let mut turn = lesser(turn, HALF_SIXTH);
        if let Some(rise) = &k.rise {
            speed.rise = rise.at(timing, rate);
            turn = rise.risen(turn, speed.rise, word(HALF_SIXTH));
        }
        if let Some(offset) = &k.offset {
            let across = state.emf_error[1];
            let turn = Turn {
                tells,
                interval: timing.intervals[0],
                rate,
                tells_angle: offset.tells_angle(i, across, state.speed.step),
                across,
            };
            learnt = learnt.at_edge(event, state.sector_prev, &turn, last);
        }
        if turning {
            (speed.omega, speed.step) = (rate, timing.direction * turn);
        }
    }
    let width = if k.parts.has(Part::HallLearning) {
        learnt.width
    } else {
        word(last)
    };
    let mut progress = lesser(speed.omega * timing.age_prev, width);
    if let Some(rise) = &k.rise {
        progress = rise.risen(progress, speed.rise, width);
    }
    let in_sector = if !turning {
        word(k.sectors.half[event.sector])
    } else if timing.direction > 0.0 {
        learnt.begin + progress
    } else {
        learnt.begin + (width - progress)
    };
    let theta = wrap32(in_sector + start);
    let sector_eff = advanced(k, timing, (theta, speed.step), event.sector);
    Angle {
        theta,
        speed,
        sector_eff,
        learnt,
    }
}
