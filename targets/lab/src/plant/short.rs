//! A short circuit at the motor, beyond the current sensors.
//!
//! It is an ideal tie while no two switches work against each other on it: a leg whose switches are
//! both off is carried by the other leg, or by the negative rail. Where two switches do work against
//! each other, each terminal stays at its rail, and the bus drives a current through both of them and
//! [`SHORT_RESISTANCE`]. The bus is stiff, and nothing burns: what a comparator or a fuse would end
//! lasts.

use super::gates::Gate;
use serde::{Deserialize, Serialize};

/// Resistance in ohm of a short together with its cables and two switches.
pub const SHORT_RESISTANCE: f64 = 0.05;

/// What is shorted. Legs are 0 to 2 for a to c.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Short {
    /// The terminals of two legs' windings.
    Legs([usize; 2]),
    /// The terminal of a leg's winding and the negative rail.
    ToMinus(usize),
}

/// How the currents of legs differ from those of their windings, by a short.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Detour {
    /// Not at all.
    #[default]
    None,
    /// A current in amperes from the bus, out of the first leg and back through the second, or
    /// through the negative rail.
    Across(f64, usize, Option<usize>),
    /// The first leg's winding is carried by the second leg, or by the negative rail.
    Carried(usize, Option<usize>),
    /// Two legs that are off carry what both windings take together, each a half.
    Halved([usize; 2]),
}

impl Detour {
    /// Of a short with these gates, on a bus of `v_bus` volts.
    pub(super) fn of(short: Option<Short>, gates: [Gate; 3], v_bus: f64) -> Self {
        let across = v_bus / SHORT_RESISTANCE;
        match short {
            Some(Short::Legs([x, y])) => match (gates[x], gates[y]) {
                (Gate::Upper, Gate::Lower) => Self::Across(across, x, Some(y)),
                (Gate::Lower, Gate::Upper) => Self::Across(across, y, Some(x)),
                (Gate::Off, Gate::Off) => Self::Halved([x, y]),
                (Gate::Off, _) => Self::Carried(x, Some(y)),
                (_, Gate::Off) => Self::Carried(y, Some(x)),
                (Gate::Upper, Gate::Upper) | (Gate::Lower, Gate::Lower) => Self::None,
            },
            Some(Short::ToMinus(x)) => match gates[x] {
                Gate::Upper => Self::Across(across, x, None),
                Gate::Off => Self::Carried(x, None),
                Gate::Lower => Self::None,
            },
            None => Self::None,
        }
    }

    /// Currents of the legs, ampere, from those of the windings.
    pub(super) fn legs(self, mut currents: [f64; 3]) -> [f64; 3] {
        match self {
            Self::None => {}
            Self::Across(amperes, from, to) => {
                currents[from] += amperes;
                if let Some(to) = to {
                    currents[to] -= amperes;
                }
            }
            Self::Carried(leg, by) => {
                if let Some(by) = by {
                    currents[by] += currents[leg];
                }
                currents[leg] = 0.0;
            }
            Self::Halved([x, y]) => {
                let half = 0.5 * (currents[x] + currents[y]);
                (currents[x], currents[y]) = (half, half);
            }
        }
        currents
    }
}

/// What connects the windings' terminals to rails, with the gates and a short. `emf`: of the phases,
/// in volts or in proportion.
pub(super) fn tied(
    short: Option<Short>,
    mut gates: [Gate; 3],
    currents: [f64; 3],
    emf: [f64; 3],
) -> [Gate; 3] {
    match short {
        Some(Short::Legs([x, y])) => {
            let tie = match (gates[x], gates[y]) {
                (Gate::Off, Gate::Off) => of_pair_off(currents[3 - x - y], emf[3 - x - y]),
                (Gate::Off, gate) | (gate, Gate::Off) => gate,
                _ => return gates,
            };
            (gates[x], gates[y]) = (tie, tie);
        }
        Some(Short::ToMinus(x)) if gates[x] == Gate::Off => gates[x] = Gate::Lower,
        Some(Short::ToMinus(_)) | None => {}
    }
    gates
}

/// The rail to whose diodes two shorted legs that are off tend, from current and EMF of the third
/// phase. The diodes of the two conduct against its current. Without one the two float, as the
/// current of their loop is the same wherever they are; at this rail the third phase's terminal,
/// 1.5 times its EMF away, is within the bus for as long as it can be.
fn of_pair_off(current: f64, emf: f64) -> Gate {
    if current < 0.0 || current == 0.0 && emf >= 0.0 {
        Gate::Lower
    } else {
        Gate::Upper
    }
}
