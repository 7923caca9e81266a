//! The switching table of PHCC: a vector for each sector, commutation state and pair of directions.
//!
//! Nothing here is rounded: both models read the same table. Voltages are in units of the bus,
//! vectors amplitude-invariant alpha-beta.

use super::sector::{MINUS, OUT_PHASE, PLUS};
use super::vectors::{self, FIRST_PAIR, FIRST_PAIR_ZERO};
use crate::exact::Word;
use crate::{Candidates, EmfShape, Error, Spec, SwitchingTable};
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, PI};

/// Differences below this count as equal.
const TIE: f64 = 1e-9;

/// Quadrant of operation; each has its own table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// Torque and rotation forward.
    Forward,
    /// Torque and rotation backward.
    Backward,
    /// Torque against forward rotation, or unknown direction.
    BrakingForward,
    /// Torque against backward rotation.
    BrakingBackward,
}

impl Set {
    /// That of a sense of rotation (1, -1, or 0 while it is unknown) and a set-point.
    #[inline]
    pub fn of<W: Word>(direction: W, set_point: W) -> Self {
        if direction > 0.0 && set_point >= 0.0 {
            Self::Forward
        } else if direction < 0.0 && set_point < 0.0 {
            Self::Backward
        } else if direction < 0.0 {
            Self::BrakingBackward
        } else {
            Self::BrakingForward
        }
    }
}

/// One set's vectors by sector minus one, commutation state, direction along phase a, direction
/// across it.
type Rows = [[[[usize; 2]; 2]; 2]; 6];

/// The whole table.
#[derive(Clone, Debug)]
pub struct Switching {
    forward: Rows,
    backward: Rows,
    braking_forward: Rows,
    braking_backward: Rows,
}

impl Switching {
    /// The table of the options.
    ///
    /// # Errors
    /// If the motor's EMF shape is inconsistent.
    pub fn new(spec: &Spec, options: &crate::Phcc) -> Result<Self, Error> {
        let shape = EmfShape::new(&spec.motor)?;
        let pairs = options.candidates != Candidates::ThreePhase;
        let motoring = |shape| match &options.table {
            SwitchingTable::Derived => Design::motoring(shape, pairs).rows(),
            SwitchingTable::Printed => printed(),
            SwitchingTable::Given(numbers) => rows(|sector, commutating, [along, across]| {
                let place = 8 * (sector - 1)
                    + 4 * usize::from(commutating)
                    + 2 * usize::from(along)
                    + usize::from(across);
                numbers[place].into()
            }),
        };
        let braking = |shape| Design::braking(shape, pairs).rows();
        Ok(Self {
            forward: motoring(shape),
            backward: mirrored(&motoring(shape.mirrored())),
            braking_forward: braking(shape),
            braking_backward: mirrored(&braking(shape.mirrored())),
        })
    }

    /// The vector's number; that of all legs low while the sector is unknown (0).
    #[inline]
    pub fn vector(
        &self,
        set: Set,
        sector_eff: usize,
        commutating: bool,
        rises: [bool; 2],
    ) -> usize {
        let rows = match set {
            Set::Forward => &self.forward,
            Set::Backward => &self.backward,
            Set::BrakingForward => &self.braking_forward,
            Set::BrakingBackward => &self.braking_backward,
        };
        match sector_eff.checked_sub(1) {
            Some(index) => at(rows, index, commutating, rises),
            None => 0,
        }
    }
}

#[inline]
fn at(rows: &Rows, index: usize, commutating: bool, [along, across]: [bool; 2]) -> usize {
    rows[index][usize::from(commutating)][usize::from(along)][usize::from(across)]
}

/// One set, by a rule for sector (1 to 6), commutation state and directions.
fn rows(rule: impl Fn(usize, bool, [bool; 2]) -> usize) -> Rows {
    let rule = &rule;
    std::array::from_fn(|index| {
        [false, true].map(|commutating| {
            [false, true].map(|along| {
                [false, true].map(|across| rule(index + 1, commutating, [along, across]))
            })
        })
    })
}

/// The paper's row of sector 1, rotated with the sector.
fn printed() -> Rows {
    rows(|sector, commutating, rises| {
        let (next, before) = (sector % 6 + 1, (sector + 4) % 6 + 1);
        match (commutating, rises) {
            (_, [false, false]) => 0,
            (true, [true, false]) => sector,
            (true, _) => next,
            (false, [true, false]) => FIRST_PAIR - 1 + before,
            (false, _) => FIRST_PAIR - 1 + sector,
        }
    })
}

/// The same drive mirrored: phases b and c exchanged, so that rotation and the component across
/// phase a change sign.
fn mirrored(set: &Rows) -> Rows {
    rows(|sector, commutating, [along, across]| {
        let image = (7 - sector) % 6;
        let vector = at(set, image, commutating, [along, !across]);
        let [a, b, c] = vectors::LEGS[vector];
        // Every vector's mirror image is a vector.
        let found = vectors::LEGS.iter().position(|legs| *legs == [a, c, b]);
        found.unwrap_or(vector)
    })
}

/// Design point of a derived set.
struct Design {
    shape: EmfShape,
    /// Phase EMF per unit of the shape and weight of a wish, in commutation.
    amplitude: f64,
    weight: f64,
    /// Line EMF of the conducting pair and weight of a wish, otherwise.
    line_emf: f64,
    pair_weight: f64,
    /// Angle of the commutation rows after the sector's middle.
    late: f64,
    /// A leg may be off.
    pairs: bool,
}

impl Design {
    /// Three quarters of the bus for the EMF; commutations nine degrees after the sector's
    /// beginning.
    fn motoring(shape: EmfShape, pairs: bool) -> Self {
        Self {
            amplitude: 0.75 / line(shape),
            weight: 0.25,
            line_emf: 0.75,
            pair_weight: 0.25,
            late: PI / 20.0 - FRAC_PI_6,
            shape,
            pairs,
        }
    }

    /// Any speed.
    fn braking(shape: EmfShape, pairs: bool) -> Self {
        Self {
            amplitude: 0.3 / line(shape),
            weight: 0.4,
            line_emf: 0.0,
            pair_weight: 0.9,
            late: 0.0,
            shape,
            pairs,
        }
    }

    fn rows(&self) -> Rows {
        rows(|sector, commutating, rises| {
            let wish = Vector2::from(rises.map(|rise| if rise { 1.0 } else { -1.0 }));
            let emf = |theta| self.shape.alpha_beta(theta);
            if commutating {
                let entering = emf(mid_sector(sector) + self.late) * self.amplitude;
                nearest(&(entering + wish * self.weight))
            } else if self.pairs {
                self.along_the_pair(sector, &wish)
            } else {
                let share = self.line_emf / line(self.shape);
                nearest(&(emf(mid_sector(sector)) * share + wish * self.pair_weight))
            }
        })
    }

    /// The conducting pair's vector, its reverse or its zero: the one with the line voltage nearest
    /// to EMF plus demand along the pair.
    fn along_the_pair(&self, sector: usize, wish: &Vector2<f64>) -> usize {
        let pair = FIRST_PAIR - 1 + sector;
        let reverse = FIRST_PAIR + (sector + 2) % 6;
        let zero = FIRST_PAIR_ZERO + OUT_PHASE[sector];
        let line =
            self.line_emf + 3f64.sqrt() * self.pair_weight * alpha_beta(pair).normalize().dot(wish);
        if line > 0.5 + TIE {
            pair
        } else if line < -0.5 - TIE {
            reverse
        } else {
            zero
        }
    }
}

/// Line EMF of a sector's pair in its middle, per unit of the phase's.
fn line(shape: EmfShape) -> f64 {
    let theta = mid_sector(1);
    phase(shape, PLUS[1], theta) - phase(shape, MINUS[1], theta)
}

/// Electrical angle in the middle of a sector (1 to 6), radians.
fn mid_sector(sector: usize) -> f64 {
    (sector as f64 - 1.0) * FRAC_PI_3
}

/// Zero-sum EMF shape of phase a, b or c (0 to 2).
fn phase(shape: EmfShape, phase: usize, theta: f64) -> f64 {
    shape.zero_sum(theta - phase as f64 * 2.0 * FRAC_PI_3)
}

/// A vector's voltage.
fn alpha_beta(vector: usize) -> Vector2<f64> {
    let [a, b, c] = vectors::sixths(vector).map(|sixths| sixths / 6.0);
    Vector2::new(a, (b - c) / 3f64.sqrt())
}

/// The vector of three switched legs nearest to `u`, the first of equals.
fn nearest(u: &Vector2<f64>) -> usize {
    let distance = |vector: usize| (alpha_beta(vector) - u).norm_squared();
    let (mut vector, mut least) = (0, distance(0));
    for other in 1..FIRST_PAIR {
        let found = distance(other);
        if found < least - TIE {
            (vector, least) = (other, found);
        }
    }
    vector
}
