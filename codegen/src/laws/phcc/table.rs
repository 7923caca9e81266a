//! The switching table, derived from the geometry of the vectors (semantics, last section).

use crate::design::vectors::{OFF_PHASE, SECTOR_CURRENT, clarke, leg_vector};
use crate::laws::whole_vectors::vector_legs;
use crate::spec::{EmfShape, PhccCandidates, PhccSpec, SwitchingTable};
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Sets of rows.
const SETS: usize = 4;

/// Set for torque and rotation forward.
pub const MOTORING_FORWARD: usize = 0;
/// Set for torque and rotation backward.
pub const MOTORING_BACKWARD: usize = 1;
/// Set for torque against forward rotation, or an unknown rotation.
pub const BRAKING_FORWARD: usize = 2;
/// Set for torque against backward rotation.
pub const BRAKING_BACKWARD: usize = 3;

/// Entries of a sector.
const PER_SECTOR: usize = 8;

/// Entries of a set.
pub const PER_SET: usize = 64;

/// Design point of a set; voltages in units of the bus.
struct Design {
    /// Line EMF of the sector's pair at its centre, and the weight of a demand, in commutation.
    switched: (f64, f64),
    /// The same outside commutation.
    conducting: (f64, f64),
    /// Angle after the sector's beginning for which commutation rows are designed, radians.
    entry: f64,
}

/// Three quarters of the bus for the EMF; commutations early in the sector.
const MOTORING: Design = Design {
    switched: (0.75, 0.25),
    conducting: (0.75, 0.25),
    entry: TAU / 40.0,
};

/// Any speed: at rest only a pair's reverse brakes, so its zero is never chosen.
const BRAKING: Design = Design {
    switched: (0.3, 0.4),
    conducting: (0.0, 0.9),
    entry: TAU / 12.0,
};

/// Differences that count as zero.
const TIE: f64 = 1e-9;

/// Entries of one set: sector 1 to 6, commutating, 2 H_a + H_b.
type Rows = [[[u8; 4]; 2]; 6];

/// The table of a drive: 4 sets of 64, each sector 0 to 7, commutating, 2 H_a + H_b.
pub fn switching_table(options: &PhccSpec, shape: EmfShape) -> Vec<i32> {
    let braking = |shape| derive(options.candidates, shape, &BRAKING);
    let motoring = |shape| match options.table {
        SwitchingTable::Derived => derive(options.candidates, shape, &MOTORING),
        SwitchingTable::Printed => printed(),
        SwitchingTable::Given(numbers) => std::array::from_fn(|k| {
            std::array::from_fn(|state| {
                std::array::from_fn(|demand| numbers[8 * k + 4 * state + demand])
            })
        }),
    };
    let mut table = vec![0; SETS * PER_SET];
    let backward = shape.reversed();
    let sets = [
        motoring(shape),
        mirrored(&motoring(backward)),
        braking(shape),
        mirrored(&braking(backward)),
    ];
    for (set, rows) in sets.iter().enumerate() {
        for (k, states) in rows.iter().enumerate() {
            let start = PER_SET * set + PER_SECTOR * (k + 1);
            for (offset, &vector) in states.iter().flatten().enumerate() {
                table[start + offset] = i32::from(vector);
            }
        }
    }
    table
}

/// Direction of the demand 2 H_a + H_b.
fn direction(demand: usize) -> Vector2<f64> {
    let sign = |bit: usize| if demand & bit == 0 { -1.0 } else { 1.0 };
    Vector2::new(sign(2), sign(1))
}

fn derive(candidates: PhccCandidates, shape: EmfShape, design: &Design) -> Rows {
    std::array::from_fn(|k| {
        let start = (60.0 * k as f64 - 30.0).to_radians();
        let centre = start + TAU / 12.0;
        let line: f64 = shape
            .zero_sum(centre)
            .iter()
            .zip(SECTOR_CURRENT[k])
            .map(|(f, sign)| f * f64::from(sign))
            .sum();
        let three_phase = |theta: f64, (share, weight): (f64, f64), demand| {
            let [a, b, c] = shape.zero_sum(theta);
            nearest(clarke(a, b, c) * (share / line) + weight * direction(demand))
        };
        [0, 1].map(|commutating| {
            std::array::from_fn(|demand| {
                if commutating == 1 {
                    three_phase(start + design.entry, design.switched, demand)
                } else if candidates == PhccCandidates::ThreePhase {
                    three_phase(centre, design.conducting, demand)
                } else {
                    let (share, weight) = design.conducting;
                    along_pair(k, share, weight * direction(demand))
                }
            })
        })
    })
}

/// The nearest of V0 to V6 to `u`, in units of the bus.
fn nearest(u: Vector2<f64>) -> u8 {
    let legs = vector_legs();
    let distance = |vector: u8| (leg_vector(legs[usize::from(vector)], 1.0) - u).norm_squared();
    (1..7).fold(0, |best, next| {
        if distance(next) < distance(best) - TIE {
            next
        } else {
            best
        }
    })
}

/// The pair vector of sector S_(k+1), its reverse or its zero, by the demand along its line.
fn along_pair(k: usize, share: f64, demand: Vector2<f64>) -> u8 {
    let pair = 7 + k as u8;
    let line = leg_vector(vector_legs()[usize::from(pair)], 1.0).normalize();
    let wanted = share + 3.0_f64.sqrt() * line.dot(&demand);
    if wanted > 0.5 + TIE {
        pair
    } else if wanted < -0.5 - TIE {
        7 + (k as u8 + 3) % 6
    } else {
        13 + OFF_PHASE[k] as u8
    }
}

/// The paper's printed row of sector 1, turned through the sectors.
fn printed() -> Rows {
    std::array::from_fn(|k| {
        let three = |number: usize| 1 + (number % 6) as u8;
        let pair = |number: usize| 7 + (number % 6) as u8;
        [
            [0, pair(k), pair(k + 5), pair(k)],
            [0, three(k + 1), three(k), three(k + 1)],
        ]
    })
}

/// The rows of the other direction of rotation: phases b and c exchanged.
fn mirrored(rows: &Rows) -> Rows {
    let legs = vector_legs();
    let swap = |vector: u8| {
        let [a, b, c] = legs[usize::from(vector)];
        let found = legs.iter().position(|&legs| legs == [a, c, b]);
        found.map_or(vector, |vector| vector as u8)
    };
    let mut mirror = *rows;
    for (k, states) in rows.iter().enumerate() {
        for (state, vectors) in states.iter().enumerate() {
            for (demand, &vector) in vectors.iter().enumerate() {
                mirror[(6 - k) % 6][state][demand ^ 1] = swap(vector);
            }
        }
    }
    mirror
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::EmfShape;

    const TRAPEZOID: EmfShape = EmfShape::Trapezoidal {
        flat_top_deg: 120.0,
    };

    #[test]
    fn motoring_rows_are_those_of_the_vectors_geometry() {
        let rows = derive(PhccCandidates::Table2, TRAPEZOID, &MOTORING);
        // S1: c+ b-, a off. V12 lowers beta; V61 and V23 would put current into leg a.
        assert_eq!(rows[0], [[7, 13, 7, 13], [1, 6, 2, 0]]);
        assert_eq!(rows[1], [[8, 15, 8, 8], [2, 0, 2, 3]]);
        assert_eq!(rows[2], [[14, 9, 9, 9], [0, 4, 3, 3]]);
    }

    #[test]
    fn braking_rows_reverse_the_pair() {
        let rows = derive(PhccCandidates::Table2, TRAPEZOID, &BRAKING);
        assert_eq!(rows[0], [[7, 10, 7, 10], [1, 6, 2, 3]]);
        assert_eq!(rows[1], [[11, 11, 8, 8], [1, 5, 2, 3]]);
        assert_eq!(rows[2], [[12, 12, 9, 9], [1, 5, 3, 4]]);
    }

    #[test]
    fn half_a_turn_reverses_every_demand_and_vector() {
        for design in [&MOTORING, &BRAKING] {
            for candidates in [PhccCandidates::Table2, PhccCandidates::ThreePhase] {
                for shape in [TRAPEZOID, EmfShape::Sinusoidal] {
                    let rows = derive(candidates, shape, design);
                    let entries = |k: usize| rows[k].iter().flatten().copied();
                    for k in 0..3 {
                        for (entry, here) in entries(k).enumerate() {
                            // The opposite demand in the same state: bits 0 and 1 of the index.
                            let there = entries(k + 3).nth(entry ^ 3);
                            let reversed = there.map(|vector| match vector {
                                1..=6 => 1 + (vector + 2) % 6,
                                7..=12 => 7 + (vector - 4) % 6,
                                zero => zero,
                            });
                            assert_eq!(Some(here), reversed, "S{} {entry}", k + 1);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn mirroring_twice_changes_nothing() {
        let rows = printed();
        assert_eq!(mirrored(&mirrored(&rows)), rows);
        assert_eq!(rows[0], [[0, 7, 12, 7], [0, 2, 1, 2]]);
    }
}
