//! Two vectors in one period: the fractions of the period for which legs are high (sections 10a to
//! 12 of FCS-MPC).

use super::whole::Whole;
use super::{Command, Inputs, pulses};
use crate::exact::{Word, all_three, both, floor_shift, halve, within, word};
use crate::model::vectors;
use hexagen::{LegState, Legs};

/// The two vectors with a leg off, in their order.
pub fn with_off_leg(off: usize) -> [usize; 2] {
    let mut found = (vectors::FIRST_PAIR..vectors::FIRST_PAIR_ZERO)
        .filter(|vector| vectors::off_leg(*vector) == Some(off));
    both(|_| found.next().unwrap_or(vectors::FIRST_PAIR))
}

/// The high and the low leg of a pair vector.
pub fn high_and_low(vector: usize) -> (usize, usize) {
    let find = |wanted: i8| {
        let mut legs = vectors::LEGS[vector].iter();
        legs.position(|leg| *leg == wanted).unwrap_or(0)
    };
    (find(1), find(-1))
}

/// Terminals between two vectors of three driven legs with those exact scores.
pub fn between<W: Word>(v: W, pair: [usize; 2], scores: [W; 2]) -> [W; 3] {
    let high = pair.map(|vector| vectors::LEGS[vector].iter().filter(|leg| **leg > 0).count());
    let (lower, upper) = if high[0] < high[1] { (0, 1) } else { (1, 0) };
    let t = within(
        floor_shift(v * 4.0 + scores[lower] - scores[upper], 3),
        0.0,
        v,
    );
    all_three(|x| {
        let [in_lower, in_upper] = [lower, upper].map(|place| vectors::LEGS[pair[place]][x] > 0);
        if in_lower {
            v
        } else if in_upper {
            t
        } else {
            word(0.0)
        }
    })
}

/// The command for these terminals.
pub fn command<W: Word>(
    now: &Inputs<W>,
    whole: &Whole<W>,
    terminal: [W; 3],
    off: Option<usize>,
) -> Command<W> {
    Command {
        legs: Legs::new(
            terminal.map(|t| pulses::compare_up_to(now, t, word(0.0), whole.top())),
            all_three(|x| {
                if off == Some(x) {
                    LegState::Off
                } else if terminal[x] > 0.0 {
                    LegState::Pulsed
                } else {
                    LegState::Low
                }
            }),
        )
        .into(),
        terminal,
        off: off.map_or(0, |leg| leg + 1),
    }
}

/// Phase voltages a, b of the command, with an off leg midway between the two others.
pub fn mean<W: Word>(now: &Inputs<W>, command: &Command<W>) -> [W; 2] {
    let mut t = command.terminal;
    if let Some(off) = command.off.checked_sub(1) {
        t[off] = halve(t[0] + t[1] + t[2]);
    }
    let mean = now.k.k_third.mul(t[0] + t[1] + t[2]);
    [t[0] - mean, t[1] - mean]
}
