//! The EMF: estimated from the last period, or modelled (step 8).
//!
//! An estimate needs the applied voltage. The voltage of a floating leg was computed from the leg's
//! own EMF, so its estimate would only integrate noise; the motor's geometry gives its EMF instead.
//! The estimate is that of the last period: `observer` advances it.

use super::words::{EmfUse, Words};
use super::{CurrentLoop, read};
use crate::blocks::{
    Lowering, ProportionalShape, Rotor, SHAPE_BITS, lifted, model_emf, model_target_emf,
    product_bound,
};
use crate::ir::{Coefficient, Expr, Memory, Named, Phases, mul_add_floor, named, pick};
use crate::spec::EmfSource;

/// EMF of phases a and b over the target period and over the present one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emf<'b> {
    pub target: Phases<'b>,
    /// None where the state holds the net voltage of that period.
    pub present: Option<Phases<'b>>,
    /// Error of the modelled EMF, q and d.
    pub error: Option<[Expr<'b>; 2]>,
    /// Counts of the residual watch and of periods that tell the torque constant, and their new values.
    pub counts: [Option<(Memory<'b>, Expr<'b>)>; 2],
}

/// The rotor, and the shape at its angle.
pub(super) type Seen<'r, 'b> = (&'r Rotor<'b>, Option<ProportionalShape<'b>>);

/// Shift of the sums of products that correct the error: 1/16 of a sum is 3/32 of a component.
const OBSERVER_SHIFT: u32 = SHAPE_BITS + 4;

/// Gain of the observer: share of the residual per period, for a shape of unit length.
pub const OBSERVER_GAIN: f64 = 3.0 / 32.0;

/// Documentation of an estimate's limit.
const PLAUSIBLE: &str = "Largest plausible EMF, the largest bus voltage";

/// An EMF estimate of a phase, limited to the plausible range; added to the open stage.
pub(super) fn plausible<'b>(l: &Lowering<'b>, e: Expr<'b>) -> Expr<'b> {
    e.within(l.voltage("e_max", l.bus_interval().high, PLAUSIBLE))
}

/// Text of the stage that corrects the error of the modelled EMF.
const CORRECTION: &[&str] = &[
    "Correction of the EMF error by the components of the residual along the shape (q) and across it (d), which are",
    "2/3 and 2/sqrt(3) of these sums, with a gain of 3/32. The d component is stored over sqrt(3). Without an angle it",
    "stays.",
];

impl<'b> CurrentLoop<'_, 'b> {
    /// EMF over the target period and over the present one; none if the law needs none. `outgoing`
    /// is the outgoing phase, 0 to 2.
    pub(super) fn emf(
        &self,
        words: &Words<'b>,
        currents: Phases<'b, 3>,
        sector: Expr<'b>,
        (rotor, set_point, v_bus): (Option<Seen<'_, 'b>>, Expr<'b>, Expr<'b>),
        third: Coefficient,
        outgoing: Option<Expr<'b>>,
    ) -> Option<Emf<'b>> {
        if self.needs.emf == EmfUse::None || self.options.emf == EmfSource::Held {
            return None;
        }
        let i = currents.pair();
        let (delay, e_limit) = (self.options.delay, self.design.e_limit);
        match (rotor, self.options.emf) {
            (Some((rotor, _)), EmfSource::Model) => {
                let model = model_emf(self.l, rotor, delay, e_limit);
                return Some(Emf {
                    target: model.target,
                    present: Some(model.present),
                    error: None,
                    counts: [None; 2],
                });
            }
            (Some((rotor, Some(shape))), EmfSource::Observer) => {
                return self.observe_emf(words, i, rotor, shape, [set_point, v_bus]);
            }
            _ => {}
        }
        let e = self.estimate_emf(words, i)?;
        let e = self.meet_emf(words, third, outgoing, e);
        let (target, present) = self.move_emf(sector, e);
        Some(Emf {
            target,
            present: Some(present),
            error: None,
            counts: [None; 2],
        })
    }

    /// Largest phase EMF before the advance, words of voltage: the bus; with floating legs the
    /// range of [`Self::meet_emf`].
    pub(super) fn e_bound(&self) -> i64 {
        let bus = self.l.bus_interval().high;
        match self.options.emf {
            EmfSource::Model => return self.l.volts_word(self.design.e_limit),
            EmfSource::Observer => return 2 * self.emf_error_limit(),
            EmfSource::Estimated | EmfSource::Held => {}
        }
        if self.needs.off_leg {
            bus + 2 * product_bound(1.0 / 3.0, self.options.word, 2 * bus)
        } else {
            bus
        }
    }

    /// The voltage less that across inductance and resistance in the period that just ended; added to the open
    /// stage. Of the applied voltage that is the EMF, (9) in its causal form.
    fn behind_impedance(
        &self,
        volts: Phases<'b>,
        i_prev: Phases<'b>,
        i: Phases<'b>,
        sight: Sight,
    ) -> Phases<'b> {
        // A power of two.
        let limit = self.l.ampere_word(self.design.di_limit);
        let doc = "Largest plausible change of current in one period";
        let low = || self.l.current("di_min", -limit, doc);
        let high = || self.l.current("di_max", limit - 1, doc);
        named! {
            let di = (i - i_prev).map(|di| di.clamp(low(), high()));
        }
        volts - sight.k_di * di - sight.k_r * i_prev
    }

    fn sight(&self) -> Sight {
        Sight {
            k_di: self.k_di(),
            k_r: self.k_r(),
        }
    }

    /// Limit of the modelled EMF's error, words of voltage.
    pub(super) fn emf_error_limit(&self) -> i64 {
        self.l.volts_word(self.design.emf_error_limit)
    }

    /// The modelled EMF plus its error, which is observed in the rotor frame: q along `shape`, the
    /// proportional current, d across it. Errors of R, bus and k_b have a q component, those of
    /// angle and L a d component.
    fn observe_emf(
        &self,
        words: &Words<'b>,
        i: Phases<'b>,
        rotor: &Rotor<'b>,
        shape: ProportionalShape<'b>,
        [set_point, v_bus]: [Expr<'b>; 2],
    ) -> Option<Emf<'b>> {
        let l = self.l;
        let observer = words.observer?;
        let memories = observer.emf_error;
        let e_model = model_target_emf(l, rotor, self.options.delay, self.design.e_limit);
        let residual = self.emf_residual(words, i)?;
        let lines = shape_lines(shape.unit);
        l.b.stage("correct_emf_error", CORRECTION);
        named! {
            let learnt = residual.map(|volts| rotor.tracking.choose(volts, 0));
        }
        let ([r_a, r_b], [p_a, p_b], [line_a, line_b]) = (learnt.0, shape.unit.0, lines.0);
        let old = memories.map(Memory::read);
        let along = mul_add_floor([r_a, line_a], [r_b, line_b], OBSERVER_SHIFT);
        let across = mul_add_floor([r_b, p_a], [-r_a, p_b], OBSERVER_SHIFT);
        named! {
            let e_error_q_next = self.plausible_error(old[0] + along);
            let e_error_d_next = self.plausible_error(old[1] + across);
        }
        let [q, d] = [e_error_q_next, e_error_d_next];
        let doc = "Error of the modelled EMF, after one step";
        l.state_volts("e_error_q", q, doc);
        l.state_volts("e_error_d", d, doc);
        let watch = words.residual;
        let counts = [
            watch.map(|watch| watch.watch(l, residual, [q, d], rotor, set_point)),
            (words.torque).map(|learning| learning.follow(l, rotor, [set_point, q, v_bus])),
        ];
        let doc = "EMF over the target period: the modelled one plus its error, which turns with the rotor.";
        l.b.stage("observe_emf", &[doc]);
        let q_along = match shape.stretch(l) {
            Some(stretch) => stretch.of(q).named("q_stretched"),
            None => q,
        };
        let ([along, across], shift) = lifted([("q_lifted", q_along), ("d_lifted", d)]);
        let error = Phases([
            mul_add_floor([along, p_a], [-across, line_b], shift),
            mul_add_floor([along, p_b], [across, line_a], shift),
        ]);
        let limit = 2 * self.emf_error_limit();
        let doc =
            "Largest plausible EMF: the largest bus, up to the next power of two of timer counts";
        named! {
            let e = (e_model + error).map(|e| {
                e.clamp(l.voltage("e_least", -limit, doc), l.voltage("e_greatest", limit - 1, doc))
            });
        }
        // The last step's target is the period that begins now.
        let expected = observer.e_next.map(read);
        Some(Emf {
            target: e,
            present: expected.or_else(|| observer.net_next.is_none().then_some(e)),
            error: Some([q, d]),
            counts,
        })
    }

    /// The EMF of the last period minus the expected one.
    fn emf_residual(&self, words: &Words<'b>, i: Phases<'b>) -> Option<Phases<'b>> {
        let sight = self.sight();
        self.l.b.stage(
            "emf_residual",
            &[
                "Residual: the net voltage of the last period, v - e, less that across inductance and resistance,",
                "K (i - i_prev) + R i_prev: the EMF beyond the expected one.",
            ],
        );
        let (net, i_prev) = (read(words.observer?.net_prev), read(words.i_prev?));
        let open = self.behind_impedance(net, i_prev, i, sight);
        named! {
            let residual = open.map(|volts| self.plausible_error(volts));
        }
        Some(residual)
    }

    /// An error of the modelled EMF within its limit.
    fn plausible_error(&self, volts: Expr<'b>) -> Expr<'b> {
        let (l, limit) = (self.l, self.emf_error_limit());
        let doc = "Limit of the modelled EMF's error";
        volts.clamp(
            l.voltage("e_error_min", -limit, doc),
            l.voltage("e_error_max", limit - 1, doc),
        )
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
        let (v_prev, i_prev) = (read(words.v_prev?), read(words.i_prev?));
        named! {
            let e_seen = self.behind_impedance(v_prev, i_prev, i, sight);
        }
        let e = match filter.zip(words.e_prev) {
            Some((filter, e_prev)) => read(e_prev) + filter * (e_seen - read(e_prev)),
            None => e_seen,
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

/// Line values of the shape, a to c and b to c: sqrt(3) times the shape turned by 90 degrees.
fn shape_lines(shape: Phases<'_>) -> Phases<'_> {
    let [a, b] = shape.0;
    named! {
        let shape_line = Phases([(a << 1) + b, (b << 1) + a]);
    }
    shape_line
}

/// Coefficients of the EMF of a past period.
#[derive(Clone, Copy, Debug)]
struct Sight {
    k_di: Coefficient,
    k_r: Coefficient,
}
