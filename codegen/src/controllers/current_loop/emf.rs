//! The EMF as the step sees it: estimated from the last period, or modelled (step 8).
//!
//! An estimate needs the voltage that was applied. Where a leg floated, that voltage was taken from the
//! leg's own EMF, so its estimate would only integrate noise; the motor's geometry says what it is.
//! The estimate is as old as the period that it was seen in: `observer` moves it on.

use super::words::{EmfUse, Words};
use super::{CurrentLoop, EMF_INTEGRAL_SHARE};
use crate::ir::{Comparison, Value};
use crate::lower::{Coefficient, Currents, Lowering, ModelledEmf, Rotor, product_bound};
use crate::spec::EmfSource;

/// EMF of phases a and b over the target period and over the present one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emf {
    pub target: [Value; 2],
    pub present: [Value; 2],
    /// What the next step compares with what it sees of the present period.
    pub expected: [Value; 2],
    /// The integral's new words.
    pub integral: Option<[Value; 2]>,
}

/// Coefficients of what a period shows of its EMF.
#[derive(Clone, Copy, Debug)]
struct Sight {
    k_di: Coefficient,
    k_r: Coefficient,
}

/// What the limit of an estimate is.
const BELIEVED: &str = "Largest EMF that is believed, the largest bus voltage";

/// An estimate of a phase's EMF, limited to what is believed; added to the open stage.
pub(super) fn believed(l: &mut Lowering<'_>, e: Value) -> Value {
    let bus = l.bus_interval().high;
    l.within_volts(e, "e_max", bus, BELIEVED)
}

impl CurrentLoop<'_, '_> {
    /// EMF over the target period and over the present one; none where the law needs none. `outgoing` is
    /// the phase that goes off in the sector, 0 to 2.
    pub(super) fn emf(
        &mut self,
        words: &Words,
        currents: &Currents,
        sector: Value,
        rotor: Option<&Rotor>,
        third: Coefficient,
        outgoing: Option<Value>,
    ) -> Option<Emf> {
        if self.needs.emf == EmfUse::None || self.options.emf == EmfSource::Held {
            return None;
        }
        if let (Some(rotor), EmfSource::Model) = (rotor, self.options.emf) {
            let flux = self.lowering.flux_model();
            let e_limit = self.design.e_limit;
            let e = self
                .lowering
                .model_emf(flux, rotor, self.options.delay, e_limit);
            Some(self.integrate_emf(words, currents, e))
        } else {
            let e = self.estimate_emf(words, currents);
            let e = self.meet_emf(words, third, outgoing, e);
            let (target, present) = self.move_emf(sector, e);
            Some(Emf {
                target,
                present,
                expected: present,
                integral: None,
            })
        }
    }

    /// Largest phase EMF of a step before it is moved on, words of voltage: an estimate up to the bus; where a leg
    /// may float, what [`Self::meet_emf`] makes of it.
    pub(super) fn e_bound(&mut self) -> i64 {
        let (design, options) = (self.design, self.options);
        if options.emf == EmfSource::Model {
            return self.lowering.volts_word(design.e_limit);
        }
        let bus = self.lowering.bus_interval().high;
        if self.needs.off_leg {
            bus + 2 * product_bound(1.0 / 3.0, options.word, 2 * bus)
        } else {
            bus
        }
    }

    /// The limit of the believed change of current, words of current: a power of two.
    fn di_limit(&self) -> i64 {
        self.lowering.ampere_word(self.design.di_limit)
    }

    fn sight(&mut self) -> Sight {
        let (options, design) = (*self.options, self.design);
        let l = &mut *self.lowering;
        let k_di = design.stiffness(l, options.word);
        let k_r = l.impedance(
            "k_r",
            design.k_r,
            options.word,
            "(1 - a)/b = R: resistive drop.",
            ["R", "ohm"],
        );
        Sight { k_di, k_r }
    }

    /// The EMF of phase `x`, 0 or 1, that the period shows which just ended, added to the open stage.
    fn see_emf(&mut self, words: &Words, currents: &Currents, sight: Sight, x: usize) -> Value {
        let limit = self.di_limit();
        let l = &mut *self.lowering;
        let (Some(i_prev), Some(v_prev)) = (words.i_prev, words.v_prev) else {
            return currents.phases[x];
        };
        let previous = l.b.state(i_prev[x]);
        let change = l.b.sub(currents.phases[x], previous);
        let doc = "Limit of the change of current in one period that is believed";
        let (low, high) = (
            l.current("di_min", -limit, doc),
            l.current("di_max", limit - 1, doc),
        );
        let change = l.b.clamp(change, low, high);
        l.b.name(["di_a", "di_b"][x], change);
        let applied = l.b.state(v_prev[x]);
        let rise = l.times(sight.k_di, change);
        let drop = l.times(sight.k_r, previous);
        let rest = l.b.sub(applied, rise);
        let seen = l.b.sub(rest, drop);
        l.b.name(["e_a_seen", "e_b_seen"][x], seen)
    }

    /// The modelled EMF with what it lacked so far, where the law integrates that.
    fn integrate_emf(&mut self, words: &Words, currents: &Currents, model: ModelledEmf) -> Emf {
        let expected = model.present;
        let (Some(e_prev), Some(integral)) = (words.e_prev, words.integral) else {
            return Emf {
                target: model.target,
                present: model.present,
                expected,
                integral: None,
            };
        };
        let sight = self.sight();
        let (share, word) = (EMF_INTEGRAL_SHARE, self.options.word);
        let l = &mut *self.lowering;
        let k_integral = l.coefficient(
            "k_integral",
            share,
            word,
            "Share that the integral takes over of what the modelled EMF lacks.",
            &format!("{share}"),
        );
        l.b.stage(
            "integrate_emf",
            &[
                "What the modelled EMF lacked in the period that just ended, against the one that voltage and currents show,",
                "goes slowly into an integral per phase, which stands for errors of the EMF constant, the angle, R and L.",
            ],
        );
        let sums = [0, 1].map(|x| {
            let seen = self.see_emf(words, currents, sight, x);
            let l = &mut *self.lowering;
            let bus = l.bus_interval().high;
            let expected = l.b.state(e_prev[x]);
            let lack = l.b.sub(seen, expected);
            let lack = l.within_volts(lack, "integral_max", bus, BELIEVED);
            l.b.name(["lack_a", "lack_b"][x], lack);
            let sum = l.b.state(integral[x]);
            let news = l.b.sub(lack, sum);
            let part = l.times(k_integral, news);
            let sum = l.b.add(sum, part);
            let sum = l.within_volts(sum, "integral_max", bus, BELIEVED);
            let doc = "Integral of what the modelled EMF lacks, after one step";
            let word = 1.0 / l.scale.voltage();
            l.b.state_error("integral", sum, [doc, "V"], word);
            l.b.name(["integral_a_now", "integral_b_now"][x], sum)
        });
        let l = &mut *self.lowering;
        let mut corrected = |e: [Value; 2], names: [&str; 2]| {
            [0, 1].map(|x| {
                let e = l.b.add(e[x], sums[x]);
                l.b.name(names[x], e)
            })
        };
        let target = corrected(model.target, ["e_a_corrected", "e_b_corrected"]);
        let present = if self.options.delay == 0 {
            target
        } else {
            corrected(model.present, ["e_a_now_corrected", "e_b_now_corrected"])
        };
        Emf {
            target,
            present,
            expected,
            integral: Some(sums),
        }
    }

    fn estimate_emf(&mut self, words: &Words, currents: &Currents) -> [Value; 2] {
        let options = *self.options;
        let floats = words.off_prev.is_some();
        let sight = self.sight();
        let l = &mut *self.lowering;
        let filter = (options.emf_filter < 1.0).then(|| {
            l.coefficient(
                "k_filter",
                options.emf_filter,
                options.word,
                "Share that the estimate takes over of what is seen in one period.",
                &format!("{}", options.emf_filter),
            )
        });
        l.b.stage(
            "estimate_emf",
            &[
                "EMF of the period that just ended: seen is e = v - K (i - i_prev) - R i_prev (the paper's (9), causal form),",
                "of which the estimate takes over a share.",
                "",
                "v is the voltage really applied; a change of current of several times what the bus can cause is not believed.",
            ],
        );
        [0, 1].map(|x| {
            let seen = self.see_emf(words, currents, sight, x);
            let l = &mut *self.lowering;
            let news = match (filter, words.e_prev) {
                (Some(filter), Some(e_prev)) => {
                    let old = l.b.state(e_prev[x]);
                    let news = l.b.sub(seen, old);
                    let part = l.times(filter, news);
                    l.b.add(old, part)
                }
                _ => seen,
            };
            let held = believed(l, news);
            let names = if floats {
                ["e_a_believed", "e_b_believed"]
            } else {
                ["e_a_past", "e_b_past"]
            };
            l.b.name(names[x], held)
        })
    }

    /// Gives a leg that floated the EMF that the motor's geometry says; the difference of the other two stays.
    fn meet_emf(
        &mut self,
        words: &Words,
        third: Coefficient,
        outgoing: Option<Value>,
        e: [Value; 2],
    ) -> [Value; 2] {
        let (Some(off_prev), Some(i_prev), Some(outgoing)) =
            (words.off_prev, words.i_prev, outgoing)
        else {
            return e;
        };
        let threshold = self.options.commutation_threshold;
        let l = &mut *self.lowering;
        l.b.stage(
            "find_floated_leg",
            &["Whether a leg was off in the period that just ended."],
        );
        let off = l.b.state(off_prev);
        let zero = l.zero();
        let floated = l.b.compare(Comparison::NotEqual, off, zero);
        l.b.name("floated", floated);
        l.b.guarded_stage(
            "meet_emf",
            floated,
            false,
            &[
                "A leg that floated shows nothing of its own EMF, only the difference of the other two is seen. In the",
                "sector in which the phase is off its EMF crosses zero, so zero is its mean; on entry of the next sector",
                "it has met that of the phase that goes off then. With current in its diode its voltage was known.",
            ],
        );
        let one = l.b.literal(1);
        let off_a = l.b.compare(Comparison::Equal, off, one);
        l.b.name("floated_a", off_a);
        let two = l.b.literal(2);
        let off_b = l.b.compare(Comparison::Equal, off, two);
        l.b.name("floated_b", off_b);
        let sum = l.b.add(e[0], e[1]);
        let e_c = l.b.neg(sum);
        let e_c = believed(l, e_c);
        l.b.name("e_c_believed", e_c);
        let phases = [e[0], e[1], e_c];
        let own = l.pick(off_a, off_b, phases);
        l.b.name("e_floated", own);
        let other = l.of_phase(outgoing, phases);
        l.b.name("e_outgoing", other);
        let i_prev = i_prev.map(|word| l.b.state(word));
        let i_c = l.third_phase("i_c_prev", i_prev[0], i_prev[1]);
        let current = l.pick(off_a, off_b, [i_prev[0], i_prev[1], i_c]);
        let current = l.b.abs(current);
        l.b.name("i_floated", current);
        let threshold = l.ampere_word(threshold);
        let doc = "Current above which an off leg's diode conducts";
        let limit = l.current("i_comm", threshold, doc);
        let conducted = l.b.compare(Comparison::Less, limit, current);
        l.b.name("conducted", conducted);
        let way = l.b.sub(other, own);
        let way = l.times(third, way);
        let zero = l.zero();
        let met = l.b.select(conducted, zero, way);
        // Legs count from 1, phases from 0.
        let one = l.b.literal(1);
        let outgoing_leg = l.b.add(outgoing, one);
        let crossing = l.b.compare(Comparison::Equal, outgoing_leg, off);
        l.b.name("crossing", crossing);
        let back = l.b.neg(own);
        let back = l.b.shift_right(back, 1);
        let half = l.b.select(crossing, back, met);
        l.b.name("half_way", half);
        let twice = l.b.shift_left(half, 1);
        l.b.name("whole_way", twice);
        let down = l.b.neg(half);
        l.b.name("half_back", down);
        let flags = [off_a, off_b];
        let moved = [0, 1].map(|x| {
            let way = l.b.select(flags[x], twice, down);
            let moved = l.b.add(e[x], way);
            l.b.name(["e_a_met", "e_b_met"][x], moved)
        });
        l.b.join([("e_a_past", moved[0], e[0]), ("e_b_past", moved[1], e[1])])
    }
}
