//! Prediction and deadbeat control with the EMF held over the delay, folded: no estimate, no prediction, but what past
//! samples and commands add to this step's voltage, or error, and to the next one's (semantics, `emf: held`).

use super::emf::believed;
use super::{CurrentLoop, EmfUse, LoopDesign, Needs, Remembered, asked_for};
use crate::ir::{Interval, StateId, Value};
use crate::lower::{Coefficient, Lowering};
use crate::spec::LoopOptions;

/// The coefficients.
#[derive(Clone, Copy)]
struct Folded {
    /// What one unit of the present current takes from the voltage, negative.
    now: Coefficient,
    /// What it adds to the next one's.
    past: Coefficient,
    /// a - 1, in deadbeat control with delay 1; negative, so that its product is added, in one instruction with the
    /// multiplication.
    fade: Option<Coefficient>,
}

impl Folded {
    fn new(l: &mut Lowering<'_>, options: &LoopOptions, needs: Needs, design: &LoopDesign) -> Self {
        let (a, word) = (design.plant.pole, options.word);
        // Deadbeat control looks a second period ahead then.
        let fades = options.delay == 1 && needs.emf == EmfUse::Deadbeat;
        let (now, past, symbols) = if fades {
            (
                1.0 + a + a * a,
                a * (1.0 + a),
                ["-K (1 + a + a^2)", "K a (1 + a)"],
            )
        } else {
            (1.0 + a, a, ["-K (1 + a)", "K a"])
        };
        let now = l.impedance(
            "k_now",
            -design.k_di * now,
            word,
            "Weight of the present current.",
            [symbols[0], "V/A"],
        );
        let past = l.impedance(
            "k_past",
            design.k_di * past,
            word,
            "Weight of the present current in the next step's voltage.",
            [symbols[1], "V/A"],
        );
        let fade = fades.then(|| {
            let symbol = format!("a - 1 = {:.6}", -design.k_decay);
            l.coefficient(
                "k_fade",
                -design.k_decay,
                word,
                "What a voltage's effect changes by in one period.",
                &symbol,
            )
        });
        Self { now, past, fade }
    }

    /// Greatest magnitudes of the words `due` and `later`.
    fn bounds(&self, l: &Lowering<'_>, delayed: bool) -> [i64; 2] {
        let volts = l.bus_interval().high;
        let past = l.rounded_product(self.past, l.current_span()).abs() + 1;
        match self.fade {
            None if delayed => [past + 2 * volts, volts],
            None => [past + volts, 0],
            Some(fade) => {
                let lost = l.rounded_product(fade, volts).abs() + 1;
                let later = 2 * volts + lost;
                [past + later + volts + lost, later]
            }
        }
    }
}

/// The folded words of a step.
pub struct Held {
    folded: Folded,
    due: [StateId; 2],
    later: Option<[StateId; 2]>,
    due_words: [Value; 2],
    /// What is due and the present current's part together.
    carried: [Value; 2],
    later_words: Option<[Value; 2]>,
    currents: [Value; 3],
}

impl CurrentLoop<'_, '_> {
    /// Declares the folded words and reads them.
    pub(super) fn held(&mut self, currents: [Value; 3]) -> Held {
        let l = &mut *self.lowering;
        let folded = Folded::new(l, self.options, self.needs, self.design);
        let delayed = self.options.delay == 1;
        let [due_bound, later_bound] = folded.bounds(l, delayed);
        let memory = self.needs.memory;
        let doc = if memory == 0 {
            "What past samples and commands add to this step's voltage."
        } else {
            "What past samples, commands and wishes add to this step's voltage."
        };
        let due = ["due_a", "due_b"]
            .map(|name| l.state(name, 0, Interval::symmetric(due_bound + memory), doc));
        let later = delayed.then(|| {
            ["later_a", "later_b"].map(|name| {
                let doc = "What past commands add to the next step's voltage.";
                l.state(name, 0, Interval::symmetric(later_bound), doc)
            })
        });
        l.b.stage(
            "carry_past",
            &["What past samples and commands and the present current add to this step's voltage: due + k_now i."],
        );
        let due_words = due.map(|word| l.b.state(word));
        let carried = [0, 1].map(|x| {
            let taken = l.times(folded.now, currents[x]);
            let carried = l.b.add(due_words[x], taken);
            l.b.name(["carried_a", "carried_b"][x], carried)
        });
        Held {
            folded,
            due,
            later,
            due_words,
            carried,
            later_words: later.map(|words| words.map(|word| l.b.state(word))),
            currents,
        }
    }

    /// Step 9 with a held EMF: the voltage of phases a, b.
    pub(super) fn held_voltage(&mut self, held: &Held, reference: [Value; 2]) -> [Value; 2] {
        let l = &mut *self.lowering;
        l.b.stage(
            "deadbeat_voltage",
            &[
                "Deadbeat voltage, the paper's (11) corrected, with its estimate (9) and prediction (7) put in and the terms",
                "collected by their age: v = K i_ref + k_now i + due; the rest was summed up when it was sampled or commanded.",
            ],
        );
        [0, 1].map(|x| {
            let volts = held.sum(l, x, reference[x]);
            asked_for(l, x, volts)
        })
    }

    /// Step 12 with a held EMF: what the voltage `u` that this step commands leaves to the next two.
    pub(super) fn left_over(&mut self, held: &Held, u: [Value; 2]) -> LeftOver {
        let l = &mut *self.lowering;
        let Some(fade) = held.folded.fade else {
            return held.unfaded(u);
        };
        l.b.stage(
            "decay",
            &["What is left of this step's voltage one period later, a v, and both together."],
        );
        let left = [0, 1].map(|x| {
            let change = l.times(fade, u[x]);
            let left = l.b.add(u[x], change);
            l.b.name(["left_a", "left_b"][x], left)
        });
        let both = [0, 1].map(|x| {
            let both = l.b.add(u[x], left[x]);
            l.b.name(["both_a", "both_b"][x], both)
        });
        LeftOver {
            left,
            both: Some(both),
        }
    }

    /// Step 12 with a held EMF: what this step's currents and its command leave to the next two.
    pub fn fold(&mut self, held: &Held, left_over: LeftOver) -> Remembered {
        let l = &mut *self.lowering;
        l.b.stage(
            "fold",
            &["What this step's current and voltage add to the voltages of the next two steps."],
        );
        let mut remembered = vec![];
        for x in 0..2 {
            let sampled = l.times(held.folded.past, held.currents[x]);
            let left = left_over.left[x];
            let due_next = match held.later_words {
                Some(later) => {
                    let rest = l.b.sub(later[x], left);
                    l.b.add(rest, sampled)
                }
                None => l.b.add(left, sampled),
            };
            l.b.name(["due_a_now", "due_b_now"][x], due_next);
            remembered.push((held.due[x], due_next));
            if let (Some(words), Some(both)) = (held.later, left_over.both) {
                remembered.push((words[x], both[x]));
            }
        }
        remembered
    }
}

/// What a command leaves to later steps, phases a and b.
#[derive(Clone, Copy, Debug)]
pub struct LeftOver {
    /// What is left of the voltage when the next step's takes effect: a v in deadbeat control with delay 1, else v.
    pub left: [Value; 2],
    /// With delay 1, what the step after the next has of it: in deadbeat control (1 + a) v, else v.
    pub both: Option<[Value; 2]>,
}

impl Held {
    /// Reference, past and present current of phase `x` together, added to the open stage.
    pub fn sum(&self, l: &mut Lowering<'_>, x: usize, reference: Value) -> Value {
        l.b.add(self.carried[x], reference)
    }

    /// What voltages leave that count in full: all but those of deadbeat control with delay 1.
    pub fn unfaded(&self, volts: [Value; 2]) -> LeftOver {
        LeftOver {
            left: volts,
            both: self.later.map(|_| volts),
        }
    }

    /// a - 1, in deadbeat control with delay 1.
    pub fn fade(&self) -> Option<Coefficient> {
        self.folded.fade
    }

    /// The EMF of the last period out of the folded words, added to the open stage.
    pub fn seen_emf(&self, l: &mut Lowering<'_>, design: &LoopDesign, word: u32) -> [Value; 2] {
        let a = design.plant.pole;
        let k_di = design.stiffness(l, word);
        let unfolded = self.later_words.map(|later| {
            let k_due = l.coefficient(
                "k_due",
                1.0 / (1.0 + a),
                word,
                "Share of the EMF in what is due.",
                &format!("1/(1 + a) = {:.6}", 1.0 / (1.0 + a)),
            );
            let weight = a / (1.0 + a).powi(2);
            let k_later = l.coefficient(
                "k_later",
                weight,
                word,
                "Weight of the last command in what is due.",
                &format!("a/(1 + a)^2 = {weight:.6}"),
            );
            (k_due, k_later, later)
        });
        [0, 1].map(|x| {
            let known = match unfolded {
                Some((k_due, k_later, later)) => {
                    let due = l.times(k_due, self.due_words[x]);
                    let last = l.times(k_later, later[x]);
                    l.b.add(due, last)
                }
                None => self.due_words[x],
            };
            let drop = l.times(k_di, self.currents[x]);
            let seen = l.b.sub(known, drop);
            let seen = believed(l, seen);
            l.b.name(["e_a", "e_b"][x], seen)
        })
    }
}
