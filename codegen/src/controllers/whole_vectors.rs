//! One whole voltage vector per period: the vectors' legs, and what a step keeps of the vector that it chose.
//!
//! Vectors are numbered 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 the zero vector of a pair with
//! leg a, b or c off. Where nothing but the legs is asked of a three-phase vector, the pattern of its low legs stands for
//! it; where the wishes that chose a vector leave something behind, too, a number stands for both.

use super::current_loop::{CurrentLoop, Front, Held, LeftOver, Remembered};
use crate::design::vectors::{LegSigns, OFF_PHASE, THREE_PHASE, TWO_PHASE};
use crate::ir::{Exact, TableId, Value};
use crate::lower::{Applied, Coefficient, Command, Lowering};
use crate::spec::BusSource;

/// What a number of [`CurrentLoop::apply_vector`] means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    /// Any vector.
    Vectors,
    /// A vector without an off leg.
    WithoutPairs,
    /// Legs that are low: 1 a, 2 b, 4 c; V0 is 7.
    LowLegs,
    /// Four times the vector, and the wishes that chose it.
    Choices(Choices),
}

/// Vectors and the wishes that choose them: 1 if phase a's current shall fall, 2 if beta's shall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Choices {
    /// Whether a vector may have an off leg.
    pub pairs: bool,
    /// What wishes leave to the next step's error, phases a and b, words of voltage.
    pub memory: [[i64; 2]; WISHES],
}

/// How many wishes there are.
pub(super) const WISHES: usize = 4;

/// The pattern of V0.
pub(super) const ALL_LOW: i32 = 7;

impl Numbers {
    /// Legs by number.
    fn legs(self) -> Vec<LegSigns> {
        let by_pattern =
            |pattern: i32| [1, 2, 4].map(|leg| if pattern & leg == 0 { 1 } else { -1 });
        match self {
            Self::Vectors | Self::WithoutPairs => vector_legs().to_vec(),
            // No voltage is high on all phases.
            Self::LowLegs => std::iter::once([-1; 3])
                .chain((1..=ALL_LOW).map(by_pattern))
                .collect(),
            Self::Choices(choices) => {
                // V0 to V6, and one more to fill the table.
                let vectors = if choices.pairs { 16 } else { 8 };
                let legs = vector_legs().into_iter().take(vectors);
                legs.flat_map(|legs| [legs; WISHES]).collect()
            }
        }
    }

    /// Whether a number may stand for an off leg.
    fn turns_off(self) -> bool {
        match self {
            Self::Vectors => true,
            Self::WithoutPairs | Self::LowLegs => false,
            Self::Choices(choices) => choices.pairs,
        }
    }

    /// What rows of tables by this number are called.
    fn row(self) -> &'static str {
        match self {
            Self::Vectors | Self::WithoutPairs => "vector",
            Self::LowLegs => "pattern",
            Self::Choices(_) => "choice",
        }
    }

    /// The numbers in words.
    fn meaning(self) -> &'static str {
        match self {
            Self::Vectors | Self::WithoutPairs => {
                "by vector: 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero."
            }
            Self::LowLegs => "by the legs that are low: 1 a, 2 b, 4 c.",
            Self::Choices(_) => {
                "by 4 vector (0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero) + 2 if beta shall fall + 1 if alpha shall."
            }
        }
    }
}

/// Legs of vectors 0 to 15: high (1), low (-1) or off (0).
pub(super) fn vector_legs() -> [LegSigns; 16] {
    let mut legs = [[-1; 3]; 16];
    legs[1..7].copy_from_slice(&THREE_PHASE);
    legs[7..13].copy_from_slice(&TWO_PHASE);
    for phase in 0..3 {
        legs[13 + phase][phase] = 0;
    }
    legs
}

/// Zero-sum voltages of a leg pattern in sixths of the bus; an off leg sits midway.
pub(super) fn sixths(legs: LegSigns) -> LegSigns {
    // Terminals in halves of the bus; v_x = t_x - mean, times 6: 3 t_x - (t_a + t_b + t_c).
    let high = legs.contains(&1);
    let terminals = legs.map(|sign| if high { sign + 1 } else { 0 });
    let sum: i32 = terminals.iter().sum();
    terminals.map(|terminal| 3 * terminal - sum)
}

/// The zero vector of a sector's pair, sectors 0 to 6: both legs of the pair low, the third off.
pub(super) fn zero_vectors() -> Vec<i32> {
    std::iter::once(0)
        .chain(OFF_PHASE.iter().map(|phase| 13 + phase))
        .collect()
}

impl CurrentLoop<'_, '_> {
    /// Drives the legs of the chosen vector and closes the step; `numbers` says what its number means.
    pub(super) fn apply_vector(
        &mut self,
        front: &Front,
        vector: Value,
        numbers: Numbers,
        mut remembered: Remembered,
    ) {
        let is_tabled = self.tables_left_over();
        let l = &mut *self.lowering;
        l.b.stage(
            "drive_legs",
            &["Legs of the chosen vector: a high leg is pulsed with a full compare value."],
        );
        let command = command(l, vector, numbers);
        l.b.stage(
            "remember_vector",
            &["What later steps need to know of the chosen vector."],
        );
        if let (Some(held), true) = (&front.held, is_tabled) {
            let left = tabled_left_over(l, self.options.word, held, (vector, numbers));
            remembered.extend(self.fold(held, left));
            self.remember(front, &command, None, None, remembered);
            return;
        }
        let v_cmd =
            (!self.needs.off_leg).then(|| voltage(l, self.options.word, front, (vector, numbers)));
        let applied = self
            .needs
            .off_leg
            .then(|| terminals(l, front, (vector, numbers)));
        self.remember(front, &command, v_cmd, applied, remembered);
    }
}

/// A table over the vectors.
fn over_vectors(
    l: &mut Lowering<'_>,
    numbers: Numbers,
    name: &str,
    doc: &str,
    entry: impl Fn(LegSigns) -> i32,
) -> TableId {
    let values = numbers.legs().into_iter().map(entry).collect();
    let name = format!("{}_{name}", numbers.row());
    l.b.program
        .column(numbers.row(), &name, values, &[doc.to_owned()])
}

/// Entries of a table over the vectors, phases a, b, c.
type Volts = Vec<[i64; 3]>;

/// The voltages that the vectors stand for, where a sixth of the bus is `unit` words.
fn fixed_volts(numbers: Numbers, unit: i64) -> Volts {
    let legs = numbers.legs().into_iter();
    legs.map(|legs| sixths(legs).map(|share| i64::from(share) * unit))
        .collect()
}

/// Looks up phases a and b of a voltage of the chosen vector, in words, at most so many from the exact one, and names them;
/// `meaning` says what it is.
fn look_up_volts(
    l: &mut Lowering<'_>,
    signals: [&str; 2],
    [name, meaning]: [&str; 2],
    volts: &Volts,
    within: u32,
    (vector, numbers): (Value, Numbers),
) -> [Value; 2] {
    [0, 1].map(|x| {
        let phase = ["a", "b"][x];
        let values = volts.iter().map(|volts| volts[x] as i32).collect();
        let row = numbers.row();
        let doc = format!("{meaning}, by {row}, words of voltage.");
        let exact = (Exact::Within(within), None);
        let table = format!("{row}_{name}_{phase}");
        let table = l.b.program.rounded_table(&table, values, exact, &[doc]);
        l.b.program.put_in_row(table, row);
        let entry = l.b.lookup(table, vector);
        l.b.name(signals[x], entry)
    })
}

/// A sixth of the bus, the unit of vector voltages, as a coefficient of the bus.
fn sixth(l: &mut Lowering<'_>, word: u32) -> Coefficient {
    l.coefficient(
        "k_sixth",
        1.0 / 6.0,
        word,
        "The unit of vector voltages: a sixth of the bus.",
        "1/6",
    )
}

/// What the voltage of the chosen vector leaves to later steps, from tables: with a fixed bus it is known beforehand.
fn tabled_left_over(
    l: &mut Lowering<'_>,
    word: u32,
    held: &Held,
    vector: (Value, Numbers),
) -> LeftOver {
    let k_sixth = sixth(l, word);
    let unit = l.rounded_product(k_sixth, l.nominal_bus());
    let volts = fixed_volts(vector.1, unit);
    let Some(k_fade) = held.fade() else {
        let later = fixed_voltage(l, unit, vector);
        let Numbers::Choices(Choices { memory, .. }) = vector.1 else {
            return held.unfaded(later);
        };
        let volts = volts.into_iter().zip(memory.iter().cycle());
        let left: Volts = volts
            .map(|([a, b, c], memory)| [a - memory[0], b - memory[1], c])
            .collect();
        let texts = [
            "left",
            "Phase voltage of the vector less the memory of the wishes",
        ];
        // Two for four sixths that are half a word off each; of b two bands and the half of their difference besides.
        let left = look_up_volts(l, ["left_a", "left_b"], texts, &left, 4, vector);
        return LeftOver {
            left,
            ..held.unfaded(later)
        };
    };
    let fade = |volts: i64| volts + l.rounded_product(k_fade, volts);
    let left: Volts = volts.iter().map(|volts| volts.map(fade)).collect();
    let both = volts.iter().zip(&left);
    let both: Volts = both
        .map(|(volts, left)| std::array::from_fn(|x| volts[x] + left[x]))
        .collect();
    let texts = [
        "left",
        "What is left of the vector's voltage one period later, a v",
    ];
    let left = look_up_volts(l, ["left_a", "left_b"], texts, &left, 3, vector);
    let texts = [
        "both",
        "The vector's voltage and what is left of it one period later, (1 + a) v",
    ];
    let both = look_up_volts(l, ["both_a", "both_b"], texts, &both, 5, vector);
    LeftOver {
        left,
        both: Some(both),
    }
}

/// The vector's legs; where no vector turns one off, all are pulsed, and a low one with compare value 0.
fn command(l: &mut Lowering<'_>, vector: Value, numbers: Numbers) -> Command {
    let turns_off = numbers.turns_off();
    let top = l.spec.inverter.timer_period as i32;
    let compares = [0, 1, 2].map(|x| {
        let name = ["compare_a", "compare_b", "compare_c"][x];
        let doc = format!("Compare value of the leg {}", numbers.meaning());
        let high = |legs: LegSigns| if legs[x] == 1 { top } else { 0 };
        let table = over_vectors(l, numbers, name, &doc, high);
        l.b.lookup(table, vector)
    });
    let legs = [0, 1, 2].map(|x| {
        if !turns_off {
            return l.b.literal(0);
        }
        let name = ["leg_a", "leg_b", "leg_c"][x];
        let doc = format!(
            "State of the leg, 0 pulsed, 1 low, 2 off, {}",
            numbers.meaning()
        );
        let table = over_vectors(l, numbers, name, &doc, |legs| match legs[x] {
            1 => 0,
            -1 => 1,
            _ => 2,
        });
        l.b.program.hold_legs(table);
        l.b.lookup(table, vector)
    });
    for x in 0..3 {
        l.b.name(
            ["compare_a_chosen", "compare_b_chosen", "compare_c_chosen"][x],
            compares[x],
        );
        if turns_off {
            l.b.name(["leg_a_chosen", "leg_b_chosen", "leg_c_chosen"][x], legs[x]);
        }
    }
    Command { compares, legs }
}

/// The zero-sum voltage that the chosen vector stands for, phases a and b.
fn voltage(
    l: &mut Lowering<'_>,
    word: u32,
    front: &Front,
    (vector, numbers): (Value, Numbers),
) -> [Value; 2] {
    let k_sixth = sixth(l, word);
    if let BusSource::Fixed = l.spec.inverter.bus {
        let unit = l.rounded_product(k_sixth, l.nominal_bus());
        return fixed_voltage(l, unit, (vector, numbers));
    }
    let product = l.times(k_sixth, front.bus.volts);
    let unit = l.b.name("sixth_of_bus", product);
    [0, 1].map(|x| {
        let name = ["sixths_a", "sixths_b"][x];
        let doc = "Phase voltage of the vector, sixths of the bus.";
        let table = over_vectors(l, numbers, name, doc, |legs| sixths(legs)[x]);
        let share = l.b.lookup(table, vector);
        let volts = l.b.mul(share, unit, 0);
        l.b.name(["v_a_chosen", "v_b_chosen"][x], volts)
    })
}

/// The same from tables, where a sixth of the bus is `unit` words.
fn fixed_voltage(l: &mut Lowering<'_>, unit: i64, vector: (Value, Numbers)) -> [Value; 2] {
    let names = ["v_a_chosen", "v_b_chosen"];
    let texts = ["volts", "Phase voltage of the vector"];
    look_up_volts(l, names, texts, &fixed_volts(vector.1, unit), 2, vector)
}

/// The terminals that the chosen vector drives, and which leg it turns off.
fn terminals(l: &mut Lowering<'_>, front: &Front, (vector, numbers): (Value, Numbers)) -> Applied {
    let terminals = [0, 1, 2].map(|x| {
        let name = ["high_a", "high_b", "high_c"][x];
        let doc = "1 where the vector turns the leg's upper switch on.";
        let table = over_vectors(l, numbers, name, doc, |legs| i32::from(legs[x] == 1));
        let high = l.b.lookup(table, vector);
        let volts = l.b.mul(high, front.bus.volts, 0);
        l.b.name(["t_a_chosen", "t_b_chosen", "t_c_chosen"][x], volts)
    });
    let table = off_leg_table(l);
    let off = l.b.lookup(table, vector);
    l.b.name("off_chosen", off);
    Applied { terminals, off }
}

/// The leg that a vector turns off: 1 a, 2 b, 3 c, 0 none.
pub(super) fn off_leg_table(l: &mut Lowering<'_>) -> TableId {
    let doc = "Leg that the vector turns off: 1 a, 2 b, 3 c, 0 none.";
    over_vectors(l, Numbers::Vectors, "off", doc, |legs| {
        legs.iter()
            .position(|&sign| sign == 0)
            .map_or(0, |phase| phase as i32 + 1)
    })
}

#[cfg(test)]
mod tests {
    use super::{sixths, vector_legs};

    #[test]
    fn vectors_have_their_voltages() {
        let legs = vector_legs();
        assert_eq!(sixths(legs[0]), [0; 3]);
        assert_eq!(sixths(legs[3]), [4, -2, -2]);
        assert_eq!(sixths(legs[4]), [2, 2, -4]);
        assert_eq!(sixths(legs[8]), [3, -3, 0]);
        assert_eq!(sixths(legs[13]), [0; 3]);
    }
}
