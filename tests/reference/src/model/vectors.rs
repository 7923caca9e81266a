//! The voltage vectors for a whole period: their numbers, legs and FCS-MPC's candidate lists.

use super::sector::OUT_PHASE;
use crate::Candidates;
use hexagen::LegState;

/// Number of vectors.
pub const COUNT: usize = 16;
/// The first vector with a leg off.
pub const FIRST_PAIR: usize = 7;
/// The first zero vector of a pair: leg a off; b and c follow.
pub const FIRST_PAIR_ZERO: usize = 13;

/// Legs of each vector: 1 high, -1 low, 0 off.
pub const LEGS: [[i8; 3]; COUNT] = [
    [-1, -1, -1],
    [-1, -1, 1],
    [1, -1, 1],
    [1, -1, -1],
    [1, 1, -1],
    [-1, 1, -1],
    [-1, 1, 1],
    [0, -1, 1],
    [1, -1, 0],
    [1, 0, -1],
    [0, 1, -1],
    [-1, 1, 0],
    [-1, 0, 1],
    [0, -1, -1],
    [-1, 0, -1],
    [-1, -1, 0],
];

/// The leg that a vector turns off.
#[inline]
pub fn off_leg(vector: usize) -> Option<usize> {
    LEGS[vector].iter().position(|leg| *leg == 0)
}

/// A vector's legs as states of the inverter; high legs are pulsed over the whole period.
#[inline]
pub fn states(vector: usize) -> [LegState; 3] {
    LEGS[vector].map(|leg| match leg {
        1 => LegState::Pulsed,
        -1 => LegState::Low,
        _ => LegState::Off,
    })
}

/// Zero-sum leg voltages in sixths of the bus; an off leg counts as the middle of the two others.
#[inline]
pub fn sixths(vector: usize) -> [f64; 3] {
    let legs = LEGS[vector].map(f64::from);
    let sum: f64 = legs.iter().sum();
    legs.map(|leg| match off_leg(vector) {
        // Half a bus for a leg, minus the sum of all three.
        None => 3.0 * leg - sum,
        Some(_) if vector >= FIRST_PAIR_ZERO => 0.0,
        Some(_) => 3.0 * leg,
    })
}

/// Three-phase vectors in the order of their gate patterns (section 10w).
const BY_GATES: [usize; FIRST_PAIR] = [0, 3, 5, 4, 1, 2, 6];

/// The vector at this place of a list with a weighted cost.
pub fn weighted_order(place: usize) -> usize {
    BY_GATES.get(place).copied().unwrap_or(place)
}

/// Number of legs whose state differs.
#[inline]
pub fn changes(from: usize, to: usize) -> f64 {
    let legs = LEGS[from].iter().zip(LEGS[to]);
    legs.filter(|(from, to)| **from != *to).count() as f64
}

/// The two phases other than the sector's outgoing one, in cyclic order.
pub fn pair_of(sector_eff: usize) -> (usize, usize) {
    let out = OUT_PHASE[sector_eff];
    ((out + 1) % 3, (out + 2) % 3)
}

/// The candidates in their order: a zero vector, then a run of others.
#[inline]
pub fn candidates(
    set: Candidates,
    commutating: bool,
    sector_eff: usize,
) -> (usize, std::ops::Range<usize>) {
    if sector_eff == 0 {
        return (0, 0..0);
    }
    match set {
        Candidates::ThreePhase => (0, 1..FIRST_PAIR),
        Candidates::All => (0, 1..FIRST_PAIR_ZERO),
        Candidates::Table2 if commutating => (0, 1..FIRST_PAIR),
        Candidates::Table2 => (
            FIRST_PAIR_ZERO + OUT_PHASE[sector_eff],
            FIRST_PAIR..FIRST_PAIR_ZERO,
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn voltages_are_zero_sum_and_as_named() {
        for vector in 0..COUNT {
            assert_eq!(sixths(vector).iter().sum::<f64>(), 0.0);
        }
        assert_eq!(sixths(0), [0.0; 3]);
        assert_eq!(sixths(3), [4.0, -2.0, -2.0]);
        assert_eq!(sixths(4), [2.0, 2.0, -4.0]);
        assert_eq!(sixths(8), [3.0, -3.0, 0.0]);
        assert_eq!(sixths(14), [0.0; 3]);
    }

    #[test]
    fn a_pair_vector_lies_between_its_namesakes() {
        // V12 between V1 and V2, ..., V61 between V6 and V1: half their sum.
        for pair in FIRST_PAIR..FIRST_PAIR_ZERO {
            let (one, two) = (pair - 6, (pair - 6) % 6 + 1);
            let middle = [0, 1, 2].map(|x| f64::midpoint(sixths(one)[x], sixths(two)[x]));
            assert_eq!(sixths(pair), middle);
        }
    }
}
