//! One whole voltage vector per period: its legs, and the state kept of the chosen vector.
//!
//! Vectors are numbered 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 the zero vector of a
//! pair with leg a, b or c off. A three-phase vector of which only the legs are used is numbered by
//! the pattern of its low legs; a vector with hysteresis memory by a number for both.

use super::current_loop::{CurrentLoop, Front, Held, LeftOver, Remembered};
use crate::blocks::set_point::SetPointWords;
use crate::blocks::{Applied, Command, CommonModeRule, LOW, Lowering, OFF, PULSED};
use crate::design::vectors::{LegSigns, OFF_PHASE, THREE_PHASE, TWO_PHASE};
use crate::diagnostics::{engineering, frequency, percent};
use crate::ir::{Coefficient, Exact, Expr, Lut, Phases, named};
use crate::spec::{BusSource, InverterSpec, Spec};

/// Numbering of the vectors of [`CurrentLoop::apply_vector`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    /// Any vector.
    Vectors,
    /// A vector without an off leg.
    WithoutPairs,
    /// Legs that are low: 1 a, 2 b, 4 c; V0 is 7.
    LowLegs,
    /// Four times the vector plus the hysteresis state that chose it.
    Choices(Choices),
}

/// Vectors with the hysteresis state that chose them: 1 if alpha is to fall, plus 2 if beta is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Choices {
    /// Whether a vector may have an off leg.
    pub pairs: bool,
    /// Memory of each hysteresis state in the next step's error, phases a and b, words of voltage.
    pub memory: [[i64; 2]; HYSTERESIS_STATES],
}

/// Hysteresis states of two axes.
pub(super) const HYSTERESIS_STATES: usize = 4;

/// The pattern of V0.
pub(super) const ALL_LOW: i32 = 7;

impl Numbers {
    /// Legs by number.
    fn legs(self) -> Vec<LegSigns> {
        let by_pattern =
            |pattern: i32| [1, 2, 4].map(|leg| if pattern & leg == 0 { 1 } else { -1 });
        match self {
            Self::Vectors | Self::WithoutPairs => vector_legs().to_vec(),
            // Pattern 0, all legs high, is not used.
            Self::LowLegs => std::iter::once([-1; 3])
                .chain((1..=ALL_LOW).map(by_pattern))
                .collect(),
            Self::Choices(choices) => {
                // V0 to V6 and one unused entry: the length is a power of two.
                let vectors = if choices.pairs { 16 } else { 8 };
                let legs = vector_legs().into_iter().take(vectors);
                legs.flat_map(|legs| [legs; HYSTERESIS_STATES]).collect()
            }
        }
    }

    /// Whether a vector may have an off leg.
    fn turns_off(self) -> bool {
        match self {
            Self::Vectors => true,
            Self::WithoutPairs | Self::LowLegs => false,
            Self::Choices(choices) => choices.pairs,
        }
    }

    /// Name of the rows of tables by this number.
    fn row(self) -> &'static str {
        match self {
            Self::Vectors | Self::WithoutPairs => "vector",
            Self::LowLegs => "pattern",
            Self::Choices(_) => "choice",
        }
    }

    /// Documentation of the numbers.
    fn meaning(self) -> &'static str {
        match self {
            Self::Vectors | Self::WithoutPairs => {
                "by vector: 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero."
            }
            Self::LowLegs => "by the legs that are low: 1 a, 2 b, 4 c.",
            Self::Choices(_) => {
                "by 4 vector (0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero) + 2 if beta is to fall + 1 if alpha is."
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

/// Zero-sum voltages of a leg pattern in sixths of a high leg's voltage; an off leg counts as midway.
pub(super) fn sixths(legs: LegSigns) -> LegSigns {
    // Terminals in halves of a high leg's voltage; v_x = t_x - mean, times 6: 3 t_x - (t_a + t_b + t_c).
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

/// The chosen vector.
#[derive(Clone, Copy)]
struct Vector<'l, 'b> {
    l: &'l Lowering<'b>,
    /// Word of the arithmetic, bits.
    word: u32,
    /// Voltage of a high leg.
    reach: Expr<'b>,
    number: Expr<'b>,
    numbers: Numbers,
}

/// What a vector's voltage is a multiple of, in documentation.
pub(super) fn whole(inverter: &InverterSpec) -> &'static str {
    if inverter.readable_top() == inverter.timer_period {
        "the bus"
    } else {
        "the voltage of a high leg"
    }
}

/// Documentation of legs that are pulsed, where they must be low for a while.
pub(super) fn pulsed_legs(spec: &Spec) -> Vec<String> {
    let inverter = &spec.inverter;
    let (top, period) = (inverter.readable_top(), inverter.timer_period);
    if top == period {
        return vec![];
    }
    let low = f64::from(period - top) / f64::from(period) * inverter.pwm_period();
    vec![
        format!(
            "A high leg is pulsed with compare value {top}, so that it is low for {} of each PWM period: every vector has {} of its",
            engineering(low, "s"),
            percent(spec.reach_share())
        ),
        format!(
            "voltage, {} of a high leg at the nominal bus, and a high leg switches with the PWM, at {}. Where stages compare",
            engineering(inverter.v_bus * spec.reach_share(), "V"),
            frequency(1.0 / inverter.pwm_period())
        ),
        "vectors with parts of the bus, parts of a high leg's voltage are meant.".to_owned(),
    ]
}

impl<'b> CurrentLoop<'_, 'b> {
    /// Steps 1 to 8, and how far the legs of a vector reach: one of them is low throughout.
    pub(super) fn front_of_vectors(&self, set_point: &SetPointWords<'b>) -> Front<'b> {
        let front = self.front(set_point);
        let rule = CommonModeRule::of_vectors(self.l);
        Front {
            reach: rule.reach(self.l, front.bus),
            ..front
        }
    }

    /// Commands the legs of the chosen vector and closes the step.
    pub(super) fn apply_vector(
        &self,
        front: &Front<'b>,
        number: Expr<'b>,
        numbers: Numbers,
        mut remembered: Remembered<'b>,
    ) {
        let vector = Vector {
            l: self.l,
            word: self.options.word,
            reach: front.reach.volts,
            number,
            numbers,
        };
        let inverter = &self.l.spec.inverter;
        let doc = if inverter.readable_top() == inverter.timer_period {
            "Legs of the chosen vector: a high leg is pulsed with a full compare value."
        } else {
            "Legs of the chosen vector: a high leg is pulsed with the largest compare value."
        };
        self.l.b.stage("drive_legs", &[doc]);
        let command = vector.command();
        let doc = "Terminals and off leg of the chosen vector, for later steps.";
        self.l.b.stage("remember_vector", &[doc]);
        if let (Some(held), true) = (&front.held, self.tables_left_over()) {
            let left = vector.tabled_left_over(held);
            remembered.extend(self.fold(held, left));
            self.remember(front, command, None, None, remembered);
            return;
        }
        let off_leg = self.needs.off_leg;
        let v_cmd = (!off_leg).then(|| vector.voltage());
        let applied = off_leg.then(|| vector.terminals());
        self.remember(front, command, v_cmd, applied, remembered);
    }
}

/// A table over the vectors.
fn over_vectors<'b>(
    l: &Lowering<'b>,
    numbers: Numbers,
    name: &str,
    doc: &str,
    entry: impl Fn(LegSigns) -> i32,
) -> Lut<'b> {
    let values = numbers.legs().into_iter().map(entry).collect();
    let row = numbers.row();
    l.b.column(row, &format!("{row}_{name}"), values, doc)
}

/// Entries of a table over the vectors, phases a, b, c.
type Volts = Vec<[i64; 3]>;

/// Voltages of the vectors for a sixth of a high leg's voltage of `unit` words.
fn fixed_volts(numbers: Numbers, unit: i64) -> Volts {
    let legs = numbers.legs().into_iter();
    legs.map(|legs| sixths(legs).map(|share| i64::from(share) * unit))
        .collect()
}

impl<'b> Vector<'_, 'b> {
    /// The chosen vector's entry of a table over the vectors.
    fn at(&self, name: &str, doc: &str, entry: impl Fn(LegSigns) -> i32) -> Expr<'b> {
        over_vectors(self.l, self.numbers, name, doc, entry).at(self.number)
    }

    /// Voltages of phases a and b by vector, with an error of at most `within` words.
    fn volts(&self, [name, meaning]: [&str; 2], volts: &Volts, within: u32) -> Phases<'b> {
        let row = self.numbers.row();
        Phases::each(|x| {
            let values = volts.iter().map(|volts| volts[x] as i32).collect();
            let doc = format!("{meaning}, by {row}, words of voltage.");
            let exact = (Exact::Within(within), None);
            let table = format!("{row}_{name}_{}", ["a", "b"][x]);
            let table = self.l.b.rounded_table(&table, values, exact, &[doc]);
            table.in_row(row).at(self.number)
        })
    }

    /// The coefficient 1/6: vector voltages are multiples of a sixth of a high leg's.
    fn k_sixth(&self) -> Coefficient {
        let whole = whole(&self.l.spec.inverter);
        let doc = format!("Unit of vector voltages: a sixth of {whole}.");
        self.l
            .coefficient("k_sixth", 1.0 / 6.0, self.word, &doc, "1/6")
    }

    /// A sixth of the voltage of a high leg on a fixed bus, words of voltage.
    fn fixed_sixth(&self) -> i64 {
        self.l
            .rounded_product(self.k_sixth(), self.reach.interval().high)
    }

    /// Contribution of the chosen vector's voltage to later steps, from tables; with a fixed bus
    /// only.
    fn tabled_left_over(&self, held: &Held<'b>) -> LeftOver<'b> {
        let volts = fixed_volts(self.numbers, self.fixed_sixth());
        let Some(k_fade) = held.fade() else {
            let later = self.fixed_voltage();
            let Numbers::Choices(Choices { memory, .. }) = self.numbers else {
                return held.unfaded(later);
            };
            let volts = volts.into_iter().zip(memory.iter().cycle());
            let entries: Volts = volts
                .map(|([a, b, c], memory)| [a - memory[0], b - memory[1], c])
                .collect();
            let texts = [
                "left",
                "Phase voltage of the vector less the hysteresis memory",
            ];
            // Four sixths, half a word off each; in b also two bands and half their difference.
            named! {
                let left = self.volts(texts, &entries, 4);
            }
            return LeftOver {
                left,
                ..held.unfaded(later)
            };
        };
        let fade = |volts: i64| volts + self.l.rounded_product(k_fade, volts);
        let faded: Volts = volts.iter().map(|volts| volts.map(fade)).collect();
        let sums = volts.iter().zip(&faded);
        let sums: Volts = sums
            .map(|(volts, left)| std::array::from_fn(|x| volts[x] + left[x]))
            .collect();
        let of_left = [
            "left",
            "Remainder of the vector's voltage one period later, a v",
        ];
        let of_both = [
            "both",
            "Sum of the vector's voltage and its remainder one period later, (1 + a) v",
        ];
        named! {
            let left = self.volts(of_left, &faded, 3);
            let both = self.volts(of_both, &sums, 5);
        }
        LeftOver {
            left,
            both: Some(both),
        }
    }

    /// The vector's legs. If no vector has an off leg all are pulsed, a low one with compare value
    /// 0.
    fn command(&self) -> Command<'b> {
        let l = self.l;
        let top = l.spec.inverter.readable_top() as i32;
        let meaning = self.numbers.meaning();
        named! {
            let compare_chosen = Phases::each(|x| {
                let name = ["compare_a", "compare_b", "compare_c"][x];
                let doc = format!("Compare value of the leg {meaning}");
                self.at(name, &doc, |legs| if legs[x] == 1 { top } else { 0 })
            });
        }
        if !self.numbers.turns_off() {
            return Command {
                compares: compare_chosen,
                legs: Phases::each(|_| l.b.number(PULSED)),
            };
        }
        named! {
            let leg_chosen = Phases::each(|x| {
                let name = ["leg_a", "leg_b", "leg_c"][x];
                let doc = format!("State of the leg, 0 pulsed, 1 low, 2 off, {meaning}");
                let state = |legs: LegSigns| match legs[x] {
                    1 => PULSED,
                    -1 => LOW,
                    _ => OFF,
                };
                let table = over_vectors(l, self.numbers, name, &doc, state);
                // A bus current is reckoned with numbers.
                let table = if l.spec.inverter.bus_currents.are_limited() {
                    table
                } else {
                    table.of_legs()
                };
                table.at(self.number)
            });
        }
        Command {
            compares: compare_chosen,
            legs: leg_chosen,
        }
    }

    /// Zero-sum voltage of the chosen vector, phases a and b.
    fn voltage(&self) -> Phases<'b> {
        if let BusSource::Fixed = self.l.spec.inverter.bus {
            return self.fixed_voltage();
        }
        named! {
            let sixth_of_bus = self.k_sixth() * self.reach;
            let v_chosen = Phases::each(|x| {
                let name = ["sixths_a", "sixths_b"][x];
                let whole = whole(&self.l.spec.inverter);
                let doc = format!("Phase voltage of the vector, sixths of {whole}.");
                self.at(name, &doc, |legs| sixths(legs)[x]) * sixth_of_bus
            });
        }
        v_chosen
    }

    /// The same from tables, for a fixed bus.
    fn fixed_voltage(&self) -> Phases<'b> {
        let volts = fixed_volts(self.numbers, self.fixed_sixth());
        named! {
            let v_chosen = self.volts(["volts", "Phase voltage of the vector"], &volts, 2);
        }
        v_chosen
    }

    /// Terminal voltages and off leg of the chosen vector.
    fn terminals(&self) -> Applied<'b> {
        named! {
            let t_chosen = Phases::each(|x| {
                let name = ["high_a", "high_b", "high_c"][x];
                let doc = "1 if the leg is high in the vector.";
                self.at(name, doc, |legs| i32::from(legs[x] == 1)) * self.reach
            });
            let off_chosen = off_leg_table(self.l).at(self.number);
        }
        Applied {
            terminals: t_chosen,
            off: off_chosen,
        }
    }
}

/// Off leg by vector: 1 a, 2 b, 3 c, 0 none.
pub(super) fn off_leg_table<'b>(l: &Lowering<'b>) -> Lut<'b> {
    let doc = "Off leg of the vector: 1 a, 2 b, 3 c, 0 none.";
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
