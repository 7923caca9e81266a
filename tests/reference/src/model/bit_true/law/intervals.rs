//! Modulation by Table 2: two neighbouring vectors and a zero vector in three intervals (section 11t).

use super::common_mode::CommonModeRule;
use super::{Command, Inputs, pulses};
use crate::exact::{Word, all_three, both, greater, halve, lesser, word};
use crate::model::Reach;
use crate::model::bit_true::limit::{self, Limited};
use crate::model::bit_true::scale::Scale;
use crate::model::vectors::{self, FIRST_PAIR_ZERO};
use crate::{AnyCommand, Error, Modulation, Saturation, Spec, Zero};
use hexagen::{Intervals, LegState};

/// The phase behind each, and the one before.
const BEHIND: [usize; 3] = [1, 2, 0];
const BEFORE: [usize; 3] = [2, 0, 1];

#[derive(Clone, Debug)]
pub struct Table2<W> {
    saturation: Saturation,
    zero: Zero,
    legs: CommonModeRule<W>,
}

/// A limited voltage and its command.
pub struct Modulated<W> {
    pub u: [W; 2],
    pub reach: Reach,
    pub command: Command<W>,
}

/// Two vectors: how long the first is applied and how long both are, as voltages, and their legs.
struct Vectors<W> {
    first: W,
    both: W,
    legs: [[LegState; 3]; 2],
}

impl<W: Word> Table2<W> {
    /// None with another modulation.
    pub fn of(
        spec: &Spec,
        modulation: Modulation,
        (saturation, zero): (Saturation, Zero),
        scale: &Scale,
    ) -> Result<Option<Self>, Error> {
        if modulation != Modulation::Table2 {
            return Ok(None);
        }
        Ok(Some(Self {
            saturation,
            zero,
            legs: CommonModeRule::of_vectors(spec, scale)?,
        }))
    }

    #[inline]
    pub fn modulate(&self, now: &Inputs<W>, u: [W; 2], e: [W; 2]) -> Modulated<W> {
        let pairing = !now.commutating;
        let reach = self.legs.reach(now.v_bus);
        // The hexagon of the pair vectors is |u_x| <= reach/2, that of the differences |w_x - w_y| <= 3/2 reach.
        let plane = |[a, b]: [W; 2]| {
            if pairing {
                let c = -(a + b);
                [a - c, b - a]
            } else {
                [a, b]
            }
        };
        let bus = if pairing { reach + halve(reach) } else { reach };
        let limited = limit::limit(self.saturation, now.k, bus, plane(u), plane(e));
        let Limited {
            u: kept,
            legs,
            reach,
            ..
        } = limited;
        let (u, vectors, zero) = if pairing {
            let u = both(|x| now.k.k_third.mul(legs[x] - legs[x + 1]));
            (u, of_pairs(u), self.zero_of_pair(now.sector_eff))
        } else {
            (kept, of_three_phases(legs), [LegState::Low; 3])
        };
        let end = |volts: W| pulses::compare_up_to(now, volts, word(0.0), self.legs.top);
        let ends = [vectors.first, vectors.both].map(end);
        let [first, second] = vectors.legs;
        Modulated {
            u,
            reach,
            command: Command::idle(AnyCommand::from(Intervals::new(
                ends,
                [first, second, zero],
            ))),
        }
    }

    fn zero_of_pair(&self, sector_eff: usize) -> [LegState; 3] {
        match self.zero {
            Zero::PairLow if sector_eff > 0 => {
                vectors::states(FIRST_PAIR_ZERO + crate::model::sector::OUT_PHASE[sector_eff])
            }
            Zero::PairLow | Zero::AllLow => [LegState::Low; 3],
        }
    }
}

/// Two high legs, then the highest alone.
fn of_three_phases<W: Word>(legs: [W; 3]) -> Vectors<W> {
    let [a, b, c] = legs;
    let highest = largest([a, b, c]);
    let (behind, before) = (BEHIND[highest], BEFORE[highest]);
    let (high, low) = (greater(greater(a, b), c), lesser(lesser(a, b), c));
    let middle = a + b + c - high - low;
    let second = if legs[behind] < legs[before] {
        before
    } else {
        behind
    };
    let mut first = [LegState::Low; 3];
    first[highest] = LegState::Pulsed;
    let alone = first;
    first[second] = LegState::Pulsed;
    Vectors {
        first: middle - low,
        both: high - low,
        legs: [first, alone],
    }
}

/// The phase of the largest voltage against the one behind it, then against the one before it.
fn of_pairs<W: Word>([a, b]: [W; 2]) -> Vectors<W> {
    let volts = [a, b, -(a + b)];
    let sizes = all_three(|x: usize| volts[x].abs());
    let lead = largest(sizes);
    let legs = [BEHIND[lead], BEFORE[lead]].map(|other| {
        let (high, low) = if volts[lead] < 0.0 {
            (other, lead)
        } else {
            (lead, other)
        };
        let mut legs = [LegState::Off; 3];
        (legs[high], legs[low]) = (LegState::Pulsed, LegState::Low);
        legs
    });
    Vectors {
        first: sizes[BEHIND[lead]] * 2.0,
        both: sizes[lead] * 2.0,
        legs,
    }
}

/// The phase of the largest value, of equal ones the first.
fn largest<W: Word>([a, b, c]: [W; 3]) -> usize {
    if b <= a && c <= a {
        0
    } else if c <= b {
        1
    } else {
        2
    }
}
