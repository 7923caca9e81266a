//! Jumps in the result of a step: two neighbouring values of a word whose results differ by more
//! than a smooth function's would. Errors of rounding, comparisons and limits appear there, and
//! hardly anywhere else.

use hexagen::Sample;
use hexagen_reference::{BitTrue, Reach, Trace};

/// The observed part of a step's result.
#[derive(Clone, Copy, Debug)]
pub enum Watched {
    /// The compare value of a phase: edges are the ties of its rounding.
    Compare(usize),
    /// Whether the voltage was limited.
    Reach,
    /// Whether the demanded voltage drives or brakes.
    Torque,
    /// Whether the demanded torque is possible beyond the corner of the hexagon (torque priority).
    Corner {
        /// Bus voltage, volt.
        v_bus: f64,
    },
    /// The sector of reference and commutation.
    Sector,
    /// A word of the state after the step.
    Word(usize),
    /// All outputs and the state after the step.
    All,
}

impl Watched {
    /// The result of the step from a state.
    pub fn measure(self, model: &mut BitTrue, words: &[i32], sample: &Sample) -> Vec<i32> {
        model.set_state_words(words);
        let command = model.step(sample);
        match self {
            Self::Compare(phase) => vec![command.instants()[phase].into()],
            Self::Reach => vec![(model.course().reach != Reach::Inside).into()],
            Self::Torque => {
                let trace = model.trace();
                let ([e_a, e_b], [u_a, u_b]) = (trace.e, trace.u_unsat);
                vec![(e_a * u_a + e_b * u_b + (e_a + e_b) * (u_a + u_b) >= 0.0).into()]
            }
            Self::Corner { v_bus } => vec![is_beyond_corner(&model.trace(), v_bus).into()],
            Self::Sector => vec![model.trace().sector_eff as i32],
            Self::Word(index) => {
                let mut result = vec![0; words.len()];
                model.state_words(&mut result);
                vec![result[index]]
            }
            Self::All => {
                let mut result = vec![0; words.len()];
                model.state_words(&mut result);
                result.extend(command.instants().map(i32::from));
                // A leg that changes its state jumps by a bus voltage.
                let legs = [0, 2, 4].map(|bit| command.states().map(|states| states >> bit & 3));
                result.extend(
                    legs.into_iter()
                        .flatten()
                        .map(|state| i32::from(state) << 24),
                );
                result
            }
        }
    }
}

/// Of the two line voltages that drive against the phase of the greatest EMF, the heavier is at
/// most the bus: whether the demanded torque exceeds that of this one alone.
fn is_beyond_corner(trace: &Trace, v_bus: f64) -> bool {
    let triple = |[a, b]: [f64; 2]| [a, b, -(a + b)];
    let (e, u) = (triple(trace.e), triple(trace.u_unsat));
    let first = if e[1].abs() >= e[2].abs() { 1 } else { 2 };
    let d = if e[0].abs() >= e[first].abs() {
        0
    } else {
        first
    };
    let sides = [(d + 1) % 3, (d + 2) % 3].map(|side| (-e[side] * e[d].signum(), side));
    let line = |side: usize| (u[d] - u[side]) * e[d].signum();
    let torque: f64 = sides.iter().map(|&(force, side)| force * line(side)).sum();
    let heavier = |(force, side): (f64, usize)| (line(side) * torque.signum(), force);
    let [x, y] = sides.map(heavier);
    let (_, force) = if x.0 >= y.0 { x } else { y };
    torque.abs() >= force * v_bus
}

/// Bisects towards the greater difference, down to neighbours; returns one of them. Without a
/// difference that is some value between the ends.
pub fn seek(mut ends: [i32; 2], upper_side: bool, mut measure: impl FnMut(i32) -> Vec<i32>) -> i32 {
    ends.sort_unstable();
    let [mut low, mut high] = ends;
    let (mut at_low, mut at_high) = (measure(low), measure(high));
    while i64::from(high) - i64::from(low) > 1 {
        let middle = low.midpoint(high);
        let at_middle = measure(middle);
        if distance(&at_low, &at_middle) > distance(&at_middle, &at_high) {
            (high, at_high) = (middle, at_middle);
        } else {
            (low, at_low) = (middle, at_middle);
        }
    }
    if upper_side { high } else { low }
}

fn distance(one: &[i32], other: &[i32]) -> u64 {
    one.iter()
        .zip(other)
        .map(|(&one, &other)| u64::from(one.abs_diff(other)))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::seek;

    #[test]
    fn neighbours_of_a_jump_are_found() {
        let ramp_with_jump = |x: i32| vec![x / 4 + if x > 12_345 { 1_000_000 } else { 0 }];
        let ends = [i32::MAX / 2, i32::MIN / 2];
        // The ramp is longer than the jump is high until the interval is short.
        let near = seek([20_000, -20_000], false, ramp_with_jump);
        assert_eq!(near, 12_345);
        assert_eq!(seek([20_000, -20_000], true, ramp_with_jump), 12_346);
        let flag = |x: i32| vec![i32::from(x > 12_345)];
        assert_eq!(seek(ends, false, flag), 12_345);
        assert_eq!(seek(ends, true, flag), 12_346);
    }
}
