//! The EMF as the step sees it: estimated from the last period, or modelled (step 8).

use super::words::{EmfUse, Words};
use super::{CurrentLoop, EmfSource};
use crate::diagnostics::engineering;
use crate::ir::Value;
use crate::lower::{Currents, Rotor, product_bound, round_down};

type Pair = Option<[Value; 2]>;

impl CurrentLoop<'_, '_> {
    /// EMF over the target period and over the present one; none where the law needs none.
    pub(super) fn emf(
        &mut self,
        words: &Words,
        currents: &Currents,
        rotor: Option<&Rotor>,
    ) -> (Pair, Pair) {
        if self.needs.emf == EmfUse::None {
            return (None, None);
        }
        if let (Some(rotor), EmfSource::Model) = (rotor, self.options.emf) {
            let flux = self.lowering.flux_model();
            let e_limit = self.design.e_limit;
            let e = self
                .lowering
                .model_emf(flux, rotor, self.options.delay, e_limit);
            (Some(e.target), Some(e.present))
        } else {
            // An estimate is taken as constant over both periods.
            let e = self.estimate_emf(words, currents);
            (Some(e), Some(e))
        }
    }

    /// Largest zero-sum phase EMF that an estimate can reach, words of voltage: the applied voltage, the
    /// believed current change and the resistive drop at their limits.
    pub(super) fn e_bound(&mut self) -> i64 {
        let (design, options) = (self.design, self.options);
        if options.emf == EmfSource::Model {
            return self.lowering.volts_word(design.e_limit);
        }
        let scale = self.lowering.scale;
        let di_max = self.di_max();
        let volts_per_word = scale.voltage() / scale.current();
        let change = product_bound(design.k_di * volts_per_word, options.word, di_max);
        let span = self.lowering.current_span();
        let drop = product_bound(design.k_r * volts_per_word, options.word, span);
        self.lowering.bus_interval().high + change + drop
    }

    fn di_max(&self) -> i64 {
        round_down(self.design.di_max * self.lowering.scale.current()) as i64
    }

    fn estimate_emf(&mut self, words: &Words, currents: &Currents) -> [Value; 2] {
        let (options, design) = (*self.options, self.design);
        let di_max = self.di_max();
        let e_bound = self.e_bound();
        let l = &mut *self.lowering;
        let per_word = l.scale.voltage() / l.scale.current();
        let physical = engineering(design.k_di, "V/A");
        let k_di = l.coefficient(
            "k_di",
            design.k_di * per_word,
            options.word,
            "K = 1/b: voltage over one period per change of current.",
            &format!("K = {physical}"),
        );
        let k_r = l.coefficient(
            "k_r",
            design.k_r * per_word,
            options.word,
            "(1 - a)/b = R: resistive drop.",
            &format!("R = {}", engineering(design.k_r, "ohm")),
        );
        let filter = (options.emf_filter < 1.0).then(|| {
            l.coefficient(
                "k_filter",
                options.emf_filter,
                options.word,
                "Weight of the new estimate in the EMF filter.",
                &format!("{}", options.emf_filter),
            )
        });
        l.b.stage(
            "estimate_emf",
            &[
                "EMF of the period that just ended: e = v - K (i - i_prev) - R i_prev (the paper's (9), causal form).",
                "",
                "v is the voltage really applied; a change of current larger than the bus can cause is not believed.",
            ],
        );
        let (Some(i_prev), Some(v_prev)) = (words.i_prev, words.v_prev) else {
            return [currents.phases[0], currents.phases[1]];
        };
        [0, 1].map(|x| {
            let previous = l.b.state(i_prev[x]);
            let change = l.b.sub(currents.phases[x], previous);
            let doc =
                "Limit of the change of current in one period that is believed, words of current.";
            let (low, high) = (
                l.number("di_min", -di_max, doc),
                l.number("di_max", di_max, doc),
            );
            let change = l.b.clamp(change, low, high);
            l.b.name(["di_a", "di_b"][x], change);
            let applied = l.b.state(v_prev[x]);
            let rise = l.times(k_di, change);
            let drop = l.times(k_r, previous);
            let rest = l.b.sub(applied, rise);
            let seen = l.b.sub(rest, drop);
            let names = ["e_a", "e_b"];
            match (filter, words.e_prev) {
                (Some(filter), Some(e_prev)) => {
                    l.b.name(["e_a_seen", "e_b_seen"][x], seen);
                    let old = l.b.state(e_prev[x]);
                    let news = l.b.sub(seen, old);
                    let part = l.times(filter, news);
                    let filtered = l.b.add(old, part);
                    // A weighted mean never leaves the interval of its parts; the clamp is for the proof.
                    let doc = "Largest EMF that an estimate can reach, words of voltage.";
                    let (low, high) = (
                        l.number("e_min", -e_bound, doc),
                        l.number("e_max", e_bound, doc),
                    );
                    let held = l.b.clamp(filtered, low, high);
                    l.b.name(names[x], held)
                }
                _ => l.b.name(names[x], seen),
            }
        })
    }
}
