//! Terminal voltage of each leg if off in the target period: a rail if its diode conducts, else
//! floating with its EMF.

use crate::ir::{Expr, Flag, Named, Phases, named, pick};
use crate::laws::current_loop::{CurrentLoop, Front};
use crate::spec::FcsMpcSpec;

/// Terminal voltages of the legs if off.
#[derive(Clone, Copy)]
pub(super) struct OffLegs<'b> {
    bus: Expr<'b>,
    /// Per leg, whether its predicted current flows through a diode, inward or outward.
    pub conducting: [[Flag<'b>; 2]; 3],
    /// Twice the terminal voltage beside a driven pair, less that of its high leg.
    pub offsets: Phases<'b, 3>,
    /// Floating terminal voltage above the driven legs' mean.
    lifts: Phases<'b, 3>,
}

impl<'b> CurrentLoop<'_, 'b> {
    /// None if vectors count with their nominal voltage.
    pub(super) fn predict_off_legs(
        &self,
        options: &FcsMpcSpec,
        front: &Front<'b>,
        u: Phases<'b>,
    ) -> Option<OffLegs<'b>> {
        let floats = options.floating() && front.commutation.is_some();
        let e = front.e.filter(|_| floats)?;
        let (l, k_hold) = (self.l, self.design.k_hold);
        let threshold_volts = options.common.commutation_threshold
            * if options.common.delay == 1 {
                k_hold / self.design.plant.pole
            } else {
                k_hold
            };
        l.b.stage(
            "predict_off_legs",
            &[
                "Terminal voltage of each leg if off in the target period: a rail while its predicted current flows through a",
                "diode, else floating with its EMF. h = K a i(k+1) = K i_ref + e - u needs no product.",
            ],
        );
        let limit = l.volts_word(threshold_volts);
        let doc = "Current threshold of an off leg's diode, as the voltage K a i";
        let limit = || l.voltage("i_comm_volts", limit, doc);
        let bus = front.bus.volts;
        let e = e.with_c("e_off");
        named! {
            let h = front.reference + e.pair() - u;
            let half_bus_off = front.reach.volts >> 1;
            let lift = e.map(|e| e + (e >> 1));
        }
        let h = h.with_c("h");
        let letters = ["a", "b", "c"];
        let conducting = [0, 1, 2].map(|x| {
            let (h, letter) = (h.0[x], letters[x]);
            let inward = h.is_above(limit()).named(&format!("{letter}_inward"));
            [
                inward,
                h.is_below(-limit()).named(&format!("{letter}_outward")),
            ]
        });
        named! {
            let d = Phases::each(|x| {
                let free = (half_bus_off + lift.0[x]).clamp(0, bus);
                (at_rail(conducting[x], free, bus) << 1) - front.reach.volts
            });
        }
        Some(OffLegs {
            bus,
            conducting,
            offsets: d,
            lifts: lift,
        })
    }
}

/// Terminal voltage of an off leg: a rail if its diode conducts, else `free`.
fn at_rail<'b>([inward, outward]: [Flag<'b>; 2], free: Expr<'b>, bus: Expr<'b>) -> Expr<'b> {
    inward.choose(0, outward.choose(bus, free))
}

impl<'b> OffLegs<'b> {
    /// Diode flags of the off leg: inward, outward.
    pub(super) fn conducting_of(&self, is_off: [Flag<'b>; 2]) -> [Flag<'b>; 2] {
        [0, 1].map(|way| pick(is_off, self.conducting.map(|flags| flags[way])))
    }

    /// The factors of the score of a pair's zero vector, by flags of leg a and leg b being off in
    /// it.
    pub(super) fn zero(&self, u: Phases<'b, 3>, is_off: [Flag<'b>; 2]) -> [Expr<'b>; 2] {
        let free = pick(is_off, self.lifts.0).clamp(0, self.bus);
        named! {
            let tau_zero = at_rail(self.conducting_of(is_off), free, self.bus);
            let aside_zero = (tau_zero << 2) - 12 * pick(is_off, u.0);
        }
        [tau_zero, aside_zero]
    }
}
