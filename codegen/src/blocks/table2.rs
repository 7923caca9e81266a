//! The paper's modulator (shared semantics page, "Modulation by Table 2"): three intervals per period, three-phase
//! vectors in commutation, pair vectors otherwise.
//!
//! Two neighbouring vectors and a zero vector make any voltage of their triangle. Of a pair vector one leg is high, one
//! low and one off, taken as midway between both: phase voltages V_BUS/2, -V_BUS/2, 0. So the phase with the largest
//! voltage v_d is in both vectors, and each other phase x takes part for 2 |v_x|/V_BUS of the period: that is (16) with 2
//! in place of sqrt(3). The hexagon of the pair vectors is |v_x| <= V_BUS/2.

use super::limit::within_bus;
use super::{
    Bus, CommonModeRule, Hexagon, LOW, Limited, Lowering, OFF, PULSED, Priority, compare_of,
};
use crate::design::vectors::OFF_PHASE;
use crate::ir::{Coefficient, Expr, Flag, Lut, Named as _, Output, Phases, named, pick};
use crate::spec::ZeroVector;

/// A command of three intervals.
#[derive(Clone, Copy, Debug)]
pub struct Intervals<'b> {
    /// Ends of the first two, timer counts.
    ends: [Expr<'b>; 2],
    /// States of the legs in each, two bits per leg.
    states: [Expr<'b>; 3],
}

impl<'b> Intervals<'b> {
    /// Outputs the command.
    pub(super) fn output(&self, l: &Lowering<'b>) {
        for (interval, end) in (0..).zip(self.ends) {
            l.b.output(Output::End(interval), end);
        }
        for (interval, states) in (0..).zip(self.states) {
            l.b.output(Output::States(interval), states);
        }
    }
}

/// The modulator of a step.
#[derive(Clone, Copy, Debug)]
pub struct Table2<'b> {
    /// The bus.
    pub bus: Bus<'b>,
    /// 1/3.
    pub third: Coefficient,
    /// Whether a commutation is in progress.
    pub commutating: Flag<'b>,
    /// The sector in force.
    pub sector: Expr<'b>,
    /// The zero vector outside commutations.
    pub zero: ZeroVector,
}

/// Durations of the first interval and of both, as voltages, and which vectors they have.
#[derive(Clone, Copy, Debug)]
struct Vectors<'b> {
    first: Expr<'b>,
    both: Expr<'b>,
    choice: Expr<'b>,
}

/// A voltage that three intervals apply.
#[derive(Clone, Copy, Debug)]
pub struct Modulated<'b> {
    /// The command.
    pub command: Intervals<'b>,
    /// Phase voltages a, b: within the hexagon of the vectors in use.
    pub u: Phases<'b>,
}

impl<'b> Table2<'b> {
    /// The command of a voltage.
    pub fn modulate(
        &self,
        l: &Lowering<'b>,
        priority: Priority<impl FnOnce() -> Phases<'b>>,
        u: Phases<'b>,
    ) -> Modulated<'b> {
        let reach = CommonModeRule::of_vectors(l).reach(l, self.bus);
        let (limited, pairing) = self.limit(l, priority, u, reach);
        let doc = "Neighbouring three-phase vectors: two legs high, then one.";
        l.b.stage("share_three", &[doc]);
        let three = of_three_phases(l, limited.legs);
        named! {
            // Wider intervals come from the plane of the pairs alone.
            let v_three = limited.u.map(|u| within_bus(u, reach.volts));
        }
        let doc =
            "Neighbouring pair vectors, one leg off: the phase of the largest voltage is in both.";
        l.b.guarded_stage("share_pairs", pairing, false, &[doc]);
        named! {
            let v_pair = Phases::<2>::each(|x| {
                self.third * (limited.legs.0[x] - limited.legs.0[x + 1])
            });
        }
        let pairs = of_pairs(l, v_pair);
        let zero_now = self.zero_of_pairs(l);
        let [first, both, choice, zero, v_a, v_b] = l.b.join([
            ("time_first", pairs.first, three.first),
            ("time_both", pairs.both, three.both),
            ("choice", pairs.choice, three.choice),
            ("zero_states", zero_now, l.b.number(ALL_LOW)),
            ("v_a", v_pair.a(), v_three.a()),
            ("v_b", v_pair.b(), v_three.b()),
        ]);
        let doc =
            "Ends of the two vectors' intervals, and the legs in each; behind them a zero vector.";
        l.b.stage("set_intervals", &[doc]);
        named! {
            let end_first = compare_of(l, first, self.bus, None);
            let end_both = compare_of(l, both, self.bus, None);
            let legs_first = states(l, 0).at(choice);
            let legs_second = states(l, 1).at(choice);
        }
        Modulated {
            command: Intervals {
                ends: [end_first, end_both],
                states: [legs_first, legs_second, zero],
            },
            u: Phases([v_a, v_b]),
        }
    }

    /// The voltage within the hexagon of the vectors in use, in whose plane it is three-phase, and whether these are
    /// pair vectors.
    fn limit(
        &self,
        l: &Lowering<'b>,
        priority: Priority<impl FnOnce() -> Phases<'b>>,
        u: Phases<'b>,
        reach: Bus<'b>,
    ) -> (Limited<'b>, Flag<'b>) {
        let doc = "Plane of the limit: the phase voltages, or outside commutations their differences, whose hexagon is three-phase.";
        l.b.stage("choose_plane", &[doc]);
        named! {
            let pairing = !self.commutating;
        }
        let plane = |volts: Phases<'b>, name: &str| {
            let lines = lines(volts.with_c(name)).pair();
            volts.zip(lines, |volts, line| pairing.choose(line, volts))
        };
        named! {
            let u_plane = plane(u, "u_three");
            let v_plane = pairing.choose(reach.volts + (reach.volts >> 1), reach.volts);
        }
        let hexagon = Hexagon {
            bus: Bus {
                volts: v_plane,
                ..self.bus
            },
            third: self.third,
            lift: None,
        };
        let priority = priority.of_plane(|e| {
            named! {
                let e_plane = plane(e, "e_three");
            }
            e_plane
        });
        (hexagon.limit(l, priority, u_plane), pairing)
    }

    /// Legs of the zero vector outside commutations.
    fn zero_of_pairs(&self, l: &Lowering<'b>) -> Expr<'b> {
        match self.zero {
            ZeroVector::AllLow => l.b.number(ALL_LOW),
            ZeroVector::PairLow => {
                let of_sector = |phase: i32| {
                    let legs = [0, 1, 2].map(|leg| if leg == phase { OFF } else { LOW });
                    packed(legs)
                };
                let column = std::iter::once(ALL_LOW).chain(OFF_PHASE.map(of_sector));
                let doc = "Legs of the zero vector by sector, two bits each: the sector's pair low, the third off.";
                let table = l.b.column("sector", "zero_of_pair", column.collect(), doc);
                table.at(self.sector).named("zero_of_sector")
            }
        }
    }
}

/// Differences of neighbouring phases, a - c, b - a, c - b: turned by 30 degrees and sqrt(3) times as long.
fn lines(volts: Phases<'_, 3>) -> Phases<'_, 3> {
    let [a, b, c] = volts.0;
    Phases([a - c, b - a, c - b])
}

/// Two legs high for as long as the middle voltage is above the lowest, then the highest alone.
fn of_three_phases<'b>(l: &Lowering<'b>, legs: Phases<'b, 3>) -> Vectors<'b> {
    let [a, b, c] = legs.0;
    let [high, low] = legs.extremes(["leg_high", "leg_low"]);
    named! {
        let a_is_high = b.is_at_most(a) & c.is_at_most(a);
        let b_is_high = c.is_at_most(b);
        let leg_middle = a + b + c - high - low;
    }
    let is_high = [a_is_high, b_is_high];
    // Whether the leg behind the highest is the lowest; else the one before it is.
    let behind = pick(is_high, [b, c, a]);
    let before = pick(is_high, [c, a, b]);
    named! {
        let first_three = leg_middle - low;
        let both_three = high - low;
        let next_is_low = behind.is_below(before);
        let choice_three = pick(is_high, [6, 8, 10].map(|row| l.b.number(row)))
            + next_is_low.choose(1, 0);
    }
    Vectors {
        first: first_three,
        both: both_three,
        choice: choice_three,
    }
}

/// The phase of the largest voltage with the phase behind it, then with the one before it.
fn of_pairs<'b>(l: &Lowering<'b>, volts: Phases<'b>) -> Vectors<'b> {
    let volts = volts.with_c("v_pair");
    let [a, b, c] = volts.0;
    named! {
        let v_size = volts.map(Expr::abs);
    }
    let [size_a, size_b, size_c] = v_size.0;
    named! {
        let a_leads = size_b.is_at_most(size_a) & size_c.is_at_most(size_a);
        let b_leads = size_c.is_at_most(size_b);
    }
    let leads = [a_leads, b_leads];
    named! {
        let v_lead = pick(leads, [a, b, c]);
        let first_pair = pick(leads, [size_b, size_c, size_a]) << 1;
        let both_pair = v_lead.abs() << 1;
        let choice_pair = pick(leads, [0, 2, 4].map(|row| l.b.number(row)))
            + v_lead.is_below(0).choose(1, 0);
    }
    Vectors {
        first: first_pair,
        both: both_pair,
        choice: choice_pair,
    }
}

/// Rows of the table of choices: pair vectors by leading phase and sign, then three-phase vectors by the highest leg and
/// whether the leg behind it is the lowest.
const CHOICES: i32 = 12;

/// All legs low.
const ALL_LOW: i32 = packed([LOW; 3]);

/// States of legs a, b, c in two bits each, a's lowest.
const fn packed([a, b, c]: [i32; 3]) -> i32 {
    a | b << 2 | c << 4
}

/// Legs of a choice in the first or the second interval.
fn states_of(choice: i32, interval: usize) -> i32 {
    let lead = (choice % 6 / 2) as usize;
    let [behind, before] = [(lead + 1) % 3, (lead + 2) % 3];
    let is_odd = choice % 2 == 1;
    let mut legs = [OFF; 3];
    if choice < 6 {
        let other = [behind, before][interval];
        let (high, low) = if is_odd { (other, lead) } else { (lead, other) };
        (legs[high], legs[low]) = (PULSED, LOW);
    } else {
        let middle = if is_odd { before } else { behind };
        legs = [LOW; 3];
        legs[lead] = PULSED;
        if interval == 0 {
            legs[middle] = PULSED;
        }
    }
    packed(legs)
}

/// The table of legs in the first or the second interval.
fn states<'b>(l: &Lowering<'b>, interval: usize) -> Lut<'b> {
    let which = ["first", "second"][interval];
    let doc = format!(
        "Legs in the {which} interval, two bits each (0 high, 1 low, 2 off). Rows 0 to 5, outside commutation: 2 p + 1 if leg p is low, else 2 p, p (0 a, 1 b, 2 c) the leg in both pairs. Rows 6 to 11, in commutation: 6 + 2 p + 1 if the leg behind p is the lowest, else 6 + 2 p, p the highest leg."
    );
    let column = (0..CHOICES).map(|choice| states_of(choice, interval));
    l.b.column("choice", &format!("{which}_states"), column.collect(), &doc)
}

#[cfg(test)]
mod tests {
    use super::{ALL_LOW, CHOICES, states_of};
    use crate::design::vectors::{THREE_PHASE, TWO_PHASE};

    /// Legs as signs: 1 high, -1 low, 0 off.
    fn signs(states: i32) -> [i32; 3] {
        [0, 2, 4].map(|bit| [1, -1, 0][(states >> bit & 3) as usize])
    }

    #[test]
    fn choices_are_neighbouring_vectors_of_table_2() {
        assert_eq!(signs(ALL_LOW), [-1; 3]);
        let mut seen = vec![];
        for choice in 0..CHOICES {
            let vectors = if choice < 6 { TWO_PHASE } else { THREE_PHASE };
            let places = [0, 1].map(|interval| {
                let legs = signs(states_of(choice, interval));
                vectors.iter().position(|vector| *vector == legs)
            });
            let [Some(first), Some(second)] = places else {
                panic!("{choice}: {places:?}");
            };
            let apart = (first + 6 - second) % 6;
            assert!(apart == 1 || apart == 5, "{choice}: {places:?}");
            seen.push((choice < 6, first.min(second), first.max(second)));
        }
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 12, "each pair of neighbours once");
    }
}
