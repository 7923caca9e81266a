//! The EMF: estimated from the last period, or modelled (step 8).
//!
//! An estimate needs the applied voltage. The voltage of a floating leg was computed from the leg's
//! own EMF, so its estimate would only integrate noise; the motor's geometry gives its EMF instead.
//! The estimate is that of the last period: `observer` advances it.

use super::words::{EmfUse, Words};
use super::{CurrentLoop, EMF_INTEGRAL_SHARE, read};
use crate::blocks::{Lowering, ModelledEmf, Rotor, model_emf, product_bound};
use crate::ir::{Coefficient, Expr, Phases, named, pick};
use crate::spec::EmfSource;

/// EMF of phases a and b over the target period and over the present one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emf<'b> {
    pub target: Phases<'b>,
    pub present: Phases<'b>,
    /// EMF of the present period that the next step's estimate starts from.
    pub expected: Phases<'b>,
    /// New words of the integral.
    pub integral: Option<Phases<'b>>,
}

/// Documentation of an estimate's limit.
const PLAUSIBLE: &str = "Largest plausible EMF, the largest bus voltage";

/// An EMF estimate of a phase, limited to the plausible range; added to the open stage.
pub(super) fn plausible<'b>(l: &Lowering<'b>, e: Expr<'b>) -> Expr<'b> {
    e.within(l.voltage("e_max", l.bus_interval().high, PLAUSIBLE))
}

impl<'b> CurrentLoop<'_, 'b> {
    /// EMF over the target period and over the present one; none if the law needs none. `outgoing`
    /// is the outgoing phase, 0 to 2.
    pub(super) fn emf(
        &self,
        words: &Words<'b>,
        currents: Phases<'b, 3>,
        sector: Expr<'b>,
        rotor: Option<&Rotor<'b>>,
        third: Coefficient,
        outgoing: Option<Expr<'b>>,
    ) -> Option<Emf<'b>> {
        if self.needs.emf == EmfUse::None || self.options.emf == EmfSource::Held {
            return None;
        }
        let i = currents.pair();
        if let (Some(rotor), EmfSource::Model) = (rotor, self.options.emf) {
            let model = model_emf(self.l, rotor, self.options.delay, self.design.e_limit);
            return Some(self.integrate_emf(words, i, model));
        }
        let e = self.estimate_emf(words, i)?;
        let e = self.meet_emf(words, third, outgoing, e);
        let (target, present) = self.move_emf(sector, e);
        Some(Emf {
            target,
            present,
            expected: present,
            integral: None,
        })
    }

    /// Largest phase EMF before the advance, words of voltage: the bus; with floating legs the
    /// range of [`Self::meet_emf`].
    pub(super) fn e_bound(&self) -> i64 {
        if self.options.emf == EmfSource::Model {
            return self.l.volts_word(self.design.e_limit);
        }
        let bus = self.l.bus_interval().high;
        if self.needs.off_leg {
            bus + 2 * product_bound(1.0 / 3.0, self.options.word, 2 * bus)
        } else {
            bus
        }
    }

    /// EMF of the period that just ended, (9) in its causal form; added to the open stage.
    fn see_emf(&self, words: &Words<'b>, i: Phases<'b>, sight: Sight) -> Option<Phases<'b>> {
        let (i_prev, v_prev) = (read(words.i_prev?), read(words.v_prev?));
        // A power of two.
        let limit = self.l.ampere_word(self.design.di_limit);
        let doc = "Largest plausible change of current in one period";
        let low = || self.l.current("di_min", -limit, doc);
        let high = || self.l.current("di_max", limit - 1, doc);
        named! {
            let di = (i - i_prev).map(|di| di.clamp(low(), high()));
            let e_seen = v_prev - sight.k_di * di - sight.k_r * i_prev;
        }
        Some(e_seen)
    }

    fn sight(&self) -> Sight {
        Sight {
            k_di: self.k_di(),
            k_r: self.k_r(),
        }
    }

    /// The modelled EMF corrected by the integral of its error, if the law has one.
    fn integrate_emf(&self, words: &Words<'b>, i: Phases<'b>, model: ModelledEmf<'b>) -> Emf<'b> {
        let unchanged = Emf {
            target: model.target,
            present: model.present,
            expected: model.present,
            integral: None,
        };
        let Some((e_prev, integral)) = words.e_prev.zip(words.integral) else {
            return unchanged;
        };
        let (l, sight, share) = (self.l, self.sight(), EMF_INTEGRAL_SHARE);
        let doc = "Share of the modelled EMF's error that the integral adds per period.";
        let word = self.options.word;
        let k_integral = l.coefficient("k_integral", share, word, doc, &share.to_string());
        l.b.stage(
            "integrate_emf",
            &[
                "Integral per phase of the modelled EMF's error in the last period, against the EMF from voltage and currents.",
                "It compensates errors of the EMF constant, the angle, R and L.",
            ],
        );
        let Some(seen) = self.see_emf(words, i, sight) else {
            return unchanged;
        };
        let (e_prev, integral) = (read(e_prev), read(integral));
        let most = || l.voltage("integral_max", l.bus_interval().high, PLAUSIBLE);
        named! {
            let lack = (seen - e_prev).map(|lack| lack.within(most()));
            let integral_now = (integral + k_integral * (lack - integral)).map(|sum| sum.within(most()));
        }
        let doc = "Integral of the modelled EMF's error after one step";
        l.state_phase_volts("integral", integral_now, doc);
        named! {
            let e_corrected = model.target + integral_now;
        }
        let present = if self.options.delay == 0 {
            e_corrected
        } else {
            named! {
                let e_now_corrected = model.present + integral_now;
            }
            e_now_corrected
        };
        Emf {
            target: e_corrected,
            present,
            expected: model.present,
            integral: Some(integral_now),
        }
    }

    fn estimate_emf(&self, words: &Words<'b>, i: Phases<'b>) -> Option<Phases<'b>> {
        let (l, share, sight) = (self.l, self.options.emf_filter, self.sight());
        let filter = (share < 1.0).then(|| {
            let doc = "Filter coefficient of the EMF estimate per period.";
            l.coefficient(
                "k_filter",
                share,
                self.options.word,
                doc,
                &share.to_string(),
            )
        });
        l.b.stage(
            "estimate_emf",
            &[
                "EMF estimate of the period that just ended: e = v - K (i - i_prev) - R i_prev (the paper's (9), causal form),",
                "through a first-order filter.",
                "",
                "v is the voltage really applied; the change of current is limited to its plausible range.",
            ],
        );
        let seen = self.see_emf(words, i, sight)?;
        let e = match filter.zip(words.e_prev) {
            Some((filter, e_prev)) => read(e_prev) + filter * (seen - read(e_prev)),
            None => seen,
        };
        let e = e.map(|e| plausible(l, e));
        if words.off_prev.is_some() {
            named! {
                let e_believed = e;
            }
            return Some(e_believed);
        }
        named! {
            let e_past = e;
        }
        Some(e_past)
    }

    /// Sets the EMF of a floating leg by the motor's geometry; the difference of the other two
    /// stays.
    fn meet_emf(
        &self,
        words: &Words<'b>,
        third: Coefficient,
        outgoing: Option<Expr<'b>>,
        e: Phases<'b>,
    ) -> Phases<'b> {
        let (Some(off_prev), Some(i_prev), Some(outgoing)) =
            (words.off_prev, words.i_prev, outgoing)
        else {
            return e;
        };
        let (l, off) = (self.l, off_prev.read());
        let doc = "Off leg in the last period.";
        l.b.stage("find_floated_leg", &[doc]);
        named! {
            let floated = off.is_not(0);
        }
        l.b.guarded_stage(
            "meet_emf",
            floated,
            false,
            &[
                "EMF of a leg that floated: only the difference of the other two is observable. In its off sector the",
                "phase's EMF crosses zero, so its mean is zero; on entry of the next sector it equals that of the next",
                "outgoing phase. While its diode conducts, its voltage is known and the estimate stays.",
            ],
        );
        let i = read(i_prev).with_c("i_prev");
        named! {
            let floated_a = off.is(1);
            let floated_b = off.is(2);
            let e_c_believed = plausible(l, -(e.a() + e.b()));
        }
        let (own, phases) = ([floated_a, floated_b], [e.a(), e.b(), e_c_believed]);
        let conducts = l.ampere_word(self.options.commutation_threshold);
        let doc = "Current threshold of an off leg's diode";
        named! {
            let e_floated = pick(own, phases);
            let e_outgoing = pick([outgoing.is(0), outgoing.is(1)], phases);
            let i_floated = pick(own, i.0).abs();
            let conducted = i_floated.is_above(l.current("i_comm", conducts, doc));
            // Off legs are numbered from 1, phases from 0.
            let crossing = (outgoing + 1).is(off);
        }
        let met = conducted.choose(0, third * (e_outgoing - e_floated));
        named! {
            let half_way = crossing.choose((-e_floated) >> 1, met);
            let whole_way = half_way << 1;
            let half_back = -half_way;
            let e_met = Phases::<2>::each(|x| e.0[x] + own[x].choose(whole_way, half_back));
        }
        Phases(l.b.join([
            ("e_a_past", e_met.a(), e.a()),
            ("e_b_past", e_met.b(), e.b()),
        ]))
    }
}

/// Coefficients of the EMF of a past period.
#[derive(Clone, Copy, Debug)]
struct Sight {
    k_di: Coefficient,
    k_r: Coefficient,
}
