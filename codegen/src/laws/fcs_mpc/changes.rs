//! Switching cost of the legs (semantics, section on the weight of switching).

use super::score::{Candidate, Pair};
use crate::blocks::Lowering;
use crate::diagnostics::engineering;
use crate::ir::{Expr, Flag, Memory, Named, Phases, named, pick};
use crate::laws::whole_vectors::vector_legs;

/// Cost of switching each leg high, low and off, as scores over the bus.
pub(super) struct Changes<'b>(pub(super) [[Expr<'b>; 3]; 3]);

impl<'b> Changes<'b> {
    /// Looks up the costs by the vector of the last step.
    pub(super) fn new(l: &Lowering<'b>, memory: Memory<'b>, volts: f64, weight: f64) -> Self {
        let doc = "Cost of switching each leg high, low and off, by the vector of the last step.";
        l.b.stage("cost_of_changes", &[doc]);
        let cost = l.volts_word(volts);
        if i32::try_from(cost).is_err() {
            l.misfit("switching_weight");
        }
        let doc = format!(
            "by the vector of the last step: 0, or 9 (K {})^2/v_bus = {} in scores over the bus, words of voltage.",
            engineering(weight, "A"),
            engineering(volts, "V")
        );
        let last = memory.read();
        Self([0, 1, 2].map(|x| {
            let phase = ["a", "b", "c"][x];
            [("high", 1), ("low", -1), ("off", 0)].map(|(state, sign)| {
                let name = format!("change_to_{state}_{phase}");
                let costs = vector_legs().map(|legs| if legs[x] == sign { 0 } else { cost as i32 });
                let doc = format!("Cost of switching leg {phase} {state}, {doc}");
                let found = l.b.table(&name, costs.to_vec(), &[doc]).at(last);
                found.named(&format!("to_{state}_{phase}"))
            })
        }))
    }

    /// Cost of switching to a vector.
    pub(super) fn to(&self, number: usize) -> Expr<'b> {
        let legs = vector_legs()[number];
        let own = |x: usize| match legs[x] {
            1 => self.0[x][0],
            -1 => self.0[x][1],
            _ => self.0[x][2],
        };
        own(0) + own(1) + own(2)
    }

    /// Cost of switching to the zero vector of the sector's pair; flags: leg a, leg b is off in it.
    pub(super) fn to_zero(&self, is_off: [Flag<'b>; 2]) -> Expr<'b> {
        named! {
            let change_to_zero = pick(is_off, [13, 14, 15].map(|number| self.to(number)));
        }
        change_to_zero
    }

    /// The better of the two vectors with one leg off, and its score over the bus.
    pub(super) fn better(&self, pair: Pair, bus: Expr<'b>, u: Phases<'b, 3>) -> Candidate<'b> {
        let letter = pair.letter();
        let six = (6 * pair.line(u)).named(&format!("line_{letter}"));
        let [first, second] = pair.numbers();
        let forward = 3 * bus - six + self.to(first);
        let forward = forward.named(&format!("forward_{letter}"));
        let back = 3 * bus + six + self.to(second);
        let back = back.named(&format!("back_{letter}"));
        let vector = back.is_below(forward).choose(second as i32, first as i32);
        Candidate {
            vector: vector.named(&format!("pair_{letter}")),
            score: forward.min(back).named(&format!("along_{letter}")),
        }
    }
}
