//! Prediction and deadbeat control with the EMF held over the delay, folded: in place of estimate
//! and prediction, the contribution of past samples and commands to the voltage, or error, of this
//! step and the next (semantics, `emf: held`).

use super::emf::plausible;
use super::{CurrentLoop, EmfUse, Remembered, kept, read, unlimited_voltage};
use crate::ir::{Coefficient, Interval, Memory, Phases, named};

/// The coefficients.
#[derive(Clone, Copy)]
struct Folded {
    /// Weight of the present current in this step's voltage, negative.
    now: Coefficient,
    /// Weight of the present current in the next step's voltage.
    past: Coefficient,
    /// a - 1, in deadbeat control with delay 1; negative, so that a multiply-accumulate adds it.
    fade: Option<Coefficient>,
}

/// The folded words of a step.
#[derive(Clone, Copy)]
pub struct Held<'b> {
    folded: Folded,
    due: [Memory<'b>; 2],
    /// With delay 1.
    later: Option<[Memory<'b>; 2]>,
    /// due + k_now i
    carried: Phases<'b>,
    currents: Phases<'b>,
}

/// Contribution of a command to later steps, phases a and b.
#[derive(Clone, Copy, Debug)]
pub struct LeftOver<'b> {
    /// Contribution to the next step: a v in deadbeat control with delay 1, else v.
    pub left: Phases<'b>,
    /// Contribution to the step after the next, with delay 1: (1 + a) v in deadbeat control, else
    /// v.
    pub both: Option<Phases<'b>>,
}

impl<'b> CurrentLoop<'_, 'b> {
    fn folded(&self) -> Folded {
        let (l, k_di) = (self.l, self.design.k_di);
        let (a, word) = (self.design.plant.pole, self.options.word);
        // Deadbeat control then predicts two periods ahead.
        let fades = self.options.delay == 1 && self.needs.emf == EmfUse::Deadbeat;
        let (now, past, symbols) = if fades {
            (
                1.0 + a + a * a,
                a * (1.0 + a),
                ["-K (1 + a + a^2)", "K a (1 + a)"],
            )
        } else {
            (1.0 + a, a, ["-K (1 + a)", "K a"])
        };
        let doc = "Weight of the present current.";
        let now = l.impedance("k_now", -k_di * now, word, doc, [symbols[0], "V/A"]);
        let doc = "Weight of the present current in the next step's voltage.";
        let past = l.impedance("k_past", k_di * past, word, doc, [symbols[1], "V/A"]);
        let fade = fades.then(|| {
            let change = -self.design.k_decay;
            let doc = "Decay of a voltage's effect in one period.";
            l.coefficient("k_fade", change, word, doc, &format!("a - 1 = {change:.6}"))
        });
        Folded { now, past, fade }
    }

    /// Greatest magnitudes of the words `due` and `later`.
    fn folded_bounds(&self, folded: &Folded) -> [i64; 2] {
        let l = self.l;
        let volts = self.volts_bound();
        let past = l.rounded_product(folded.past, l.current_span()).abs() + 1;
        match folded.fade {
            None if self.options.delay == 1 => [past + 2 * volts, volts],
            None => [past + volts, 0],
            Some(fade) => {
                let lost = l.rounded_product(fade, volts).abs() + 1;
                let later = 2 * volts + lost;
                [past + later + volts + lost, later]
            }
        }
    }

    /// Declares the folded words and adds the present current's contribution.
    pub(super) fn held(&self, currents: Phases<'b>) -> Held<'b> {
        let l = self.l;
        let folded = self.folded();
        let [due_bound, later_bound] = self.folded_bounds(&folded);
        let memory = self.needs.memory;
        let doc = if memory == 0 {
            "Contribution of past samples and commands to this step's voltage."
        } else {
            "Contribution of past samples, commands and hysteresis states to this step's voltage."
        };
        let range = Interval::symmetric(due_bound + memory);
        let due = l.memories(["due_a", "due_b"], range, doc);
        let later = (self.options.delay == 1).then(|| {
            let doc = "Contribution of past commands to the next step's voltage.";
            l.memories(
                ["later_a", "later_b"],
                Interval::symmetric(later_bound),
                doc,
            )
        });
        let doc = "Contribution of past samples and commands and of the present current to this step's voltage: due + k_now i.";
        l.b.stage("carry_past", &[doc]);
        named! {
            let carried = read(due) + folded.now * currents;
        }
        Held {
            folded,
            due,
            later,
            carried,
            currents,
        }
    }

    /// Step 9 with a held EMF: the voltage of phases a, b.
    pub(super) fn held_voltage(&self, held: &Held<'b>, reference: Phases<'b>) -> Phases<'b> {
        self.l.b.stage(
            "deadbeat_voltage",
            &[
                "Deadbeat voltage, the paper's (11) corrected, with estimate (9) and prediction (7) substituted and the terms",
                "collected by age: v = K i_ref + k_now i + due, where due holds the terms of past samples and commands.",
            ],
        );
        unlimited_voltage(self.l, held.sum(reference))
    }

    /// Step 12 with a held EMF: contribution of the commanded voltage `u` to the next two steps.
    pub(super) fn left_over(&self, held: &Held<'b>, u: Phases<'b>) -> LeftOver<'b> {
        let Some(fade) = held.folded.fade else {
            return held.unfaded(u);
        };
        let doc = "Remainder of this step's voltage one period later, a v, and their sum.";
        self.l.b.stage("decay", &[doc]);
        named! {
            let left = u + fade * u;
            let both = u + left;
        }
        LeftOver {
            left,
            both: Some(both),
        }
    }

    /// Step 12 with a held EMF: contribution of currents and command to the next two steps.
    pub fn fold(&self, held: &Held<'b>, left_over: LeftOver<'b>) -> Remembered<'b> {
        let doc = "Contribution of this step's current and voltage to the voltages of the next two steps.";
        self.l.b.stage("fold", &[doc]);
        let sampled = held.folded.past * held.currents;
        named! {
            let due_now = match held.later {
                Some(later) => read(later) - left_over.left + sampled,
                None => left_over.left + sampled,
            };
        }
        let later = held.later.zip(left_over.both);
        let later = later.map(|(words, both)| kept(words, both));
        let due = kept(held.due, due_now).into_iter();
        due.chain(later.into_iter().flatten()).collect()
    }

    /// The EMF of the last period from the folded words; added to the open stage.
    pub fn held_emf(&self, held: &Held<'b>) -> Phases<'b> {
        let (l, a, word) = (self.l, self.design.plant.pole, self.options.word);
        let k_di = self.k_di();
        let due = read(held.due);
        let known = match held.later {
            None => due,
            Some(later) => {
                let share = 1.0 / (1.0 + a);
                let doc = "Share of the EMF in `due`.";
                let physical = format!("1/(1 + a) = {share:.6}");
                let k_due = l.coefficient("k_due", share, word, doc, &physical);
                let weight = a / (1.0 + a).powi(2);
                let doc = "Weight of the last command in `due`.";
                let physical = format!("a/(1 + a)^2 = {weight:.6}");
                let k_later = l.coefficient("k_later", weight, word, doc, &physical);
                k_due * due + k_later * read(later)
            }
        };
        named! {
            let e = (known - k_di * held.currents).map(|e| plausible(l, e));
        }
        e
    }
}

impl<'b> Held<'b> {
    /// Reference, past and present current together, added to the open stage.
    pub fn sum(&self, reference: Phases<'b>) -> Phases<'b> {
        self.carried + reference
    }

    /// Contribution of voltages without decay: all but deadbeat control with delay 1.
    pub fn unfaded(&self, volts: Phases<'b>) -> LeftOver<'b> {
        LeftOver {
            left: volts,
            both: self.later.map(|_| volts),
        }
    }

    /// a - 1, in deadbeat control with delay 1.
    pub fn fade(&self) -> Option<Coefficient> {
        self.folded.fade
    }
}
