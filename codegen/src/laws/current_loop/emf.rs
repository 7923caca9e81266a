//! The EMF: estimated from the last period, or modelled (step 8).
//!
//! An estimate needs the voltage that was applied. Where a leg floated, that voltage was taken from the
//! leg's own EMF, so its estimate would only integrate noise; the motor's geometry says what it is.
//! The estimate is as old as the period that it was seen in: `observer` moves it on.

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
    /// What the next step compares with what it sees of the present period.
    pub expected: Phases<'b>,
    /// The integral's new words.
    pub integral: Option<Phases<'b>>,
}

/// What the limit of an estimate is.
const BELIEVED: &str = "Largest plausible EMF, the largest bus voltage";

/// An estimate of a phase's EMF, limited to what is believed; added to the open stage.
pub(super) fn believed<'b>(l: &Lowering<'b>, e: Expr<'b>) -> Expr<'b> {
    e.within(l.voltage("e_max", l.bus_interval().high, BELIEVED))
}

impl<'b> CurrentLoop<'_, 'b> {
    /// EMF over the target period and over the present one; none where the law needs none. `outgoing` is
    /// the phase that goes off in the sector, 0 to 2.
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

    /// Largest phase EMF of a step before it is moved on, words of voltage: an estimate up to the bus; where a leg
    /// may float, what [`Self::meet_emf`] makes of it.
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

    /// The EMF that the period shows which just ended, added to the open stage: (9) in its causal form.
    fn see_emf(&self, words: &Words<'b>, i: Phases<'b>, sight: Sight) -> Option<Phases<'b>> {
        let (i_prev, v_prev) = (read(words.i_prev?), read(words.v_prev?));
        // A power of two.
        let limit = self.l.ampere_word(self.design.di_limit);
        let doc = "Limit of the plausible change of current in one period";
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

    /// The modelled EMF with what it lacked so far, where the law integrates that.
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
        let doc = "Share that the integral takes over of what the modelled EMF lacks.";
        let word = self.options.word;
        let k_integral = l.coefficient("k_integral", share, word, doc, &share.to_string());
        l.b.stage(
            "integrate_emf",
            &[
                "Error of the modelled EMF in the last period, against the EMF that voltage and currents show,",
                "goes slowly into an integral per phase, which stands for errors of the EMF constant, the angle, R and L.",
            ],
        );
        let Some(seen) = self.see_emf(words, i, sight) else {
            return unchanged;
        };
        let (e_prev, integral) = (read(e_prev), read(integral));
        let most = || l.voltage("integral_max", l.bus_interval().high, BELIEVED);
        named! {
            let lack = (seen - e_prev).map(|lack| lack.within(most()));
            let integral_now = (integral + k_integral * (lack - integral)).map(|sum| sum.within(most()));
        }
        let doc = "Integral of what the modelled EMF lacks, after one step";
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
            let doc = "Share that the estimate takes over of what is seen in one period.";
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
                "EMF of the period that just ended: seen is e = v - K (i - i_prev) - R i_prev (the paper's (9), causal form),",
                "of which the estimate takes over a share.",
                "",
                "v is the voltage really applied; a change of current is limited to several times what the bus can cause.",
            ],
        );
        let seen = self.see_emf(words, i, sight)?;
        let e = match filter.zip(words.e_prev) {
            Some((filter, e_prev)) => read(e_prev) + filter * (seen - read(e_prev)),
            None => seen,
        };
        let e = e.map(|e| believed(l, e));
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

    /// Gives a leg that floated the EMF that the motor's geometry says; the difference of the other two stays.
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
                "A leg that floated shows nothing of its own EMF, only the difference of the other two is seen. In the",
                "sector in which the phase is off its EMF crosses zero, so zero is its mean; on entry of the next sector",
                "it has met that of the phase that goes off then. With current in its diode its voltage was known.",
            ],
        );
        let i = read(i_prev).with_c("i_prev");
        named! {
            let floated_a = off.is(1);
            let floated_b = off.is(2);
            let e_c_believed = believed(l, -(e.a() + e.b()));
        }
        let (own, phases) = ([floated_a, floated_b], [e.a(), e.b(), e_c_believed]);
        let conducts = l.ampere_word(self.options.commutation_threshold);
        let doc = "Current above which an off leg's diode conducts";
        named! {
            let e_floated = pick(own, phases);
            let e_outgoing = pick([outgoing.is(0), outgoing.is(1)], phases);
            let i_floated = pick(own, i.0).abs();
            let conducted = i_floated.is_above(l.current("i_comm", conducts, doc));
            // Legs count from 1, phases from 0.
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

/// Coefficients of what a period shows of its EMF.
#[derive(Clone, Copy, Debug)]
struct Sight {
    k_di: Coefficient,
    k_r: Coefficient,
}
