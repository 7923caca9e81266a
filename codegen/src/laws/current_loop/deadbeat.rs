//! The deadbeat voltage: it takes the current to the reference by the end of the target period
//! (shared semantics page, step 9).

use super::{CurrentLoop, Front};
use crate::blocks::Lowering;
use crate::ir::{Phases, named};

/// The deadbeat voltage.
#[derive(Clone, Copy, Debug)]
pub struct Deadbeat<'b> {
    /// Voltages of phases a and b, not limited.
    pub u: Phases<'b>,
    /// The measured current as a voltage, for the compensation of the dead time; if the law compensates.
    pub held: Option<Phases<'b>>,
}

/// Names the voltage of phases a and b before the limit, and states its error bound.
pub fn unlimited_voltage<'b>(l: &Lowering<'b>, volts: Phases<'b>) -> Phases<'b> {
    let doc = "Phase voltage before the limit";
    l.state_phase_volts("voltage", volts, doc);
    named! {
        let u_unsat = volts;
    }
    u_unsat
}

impl<'b> CurrentLoop<'_, 'b> {
    /// Step 9: the deadbeat voltage of phases a, b; `compensates`: whether the law compensates the dead time.
    pub fn deadbeat(&self, front: &Front<'b>, compensates: bool) -> Deadbeat<'b> {
        let (reference, i) = (front.reference, front.currents.pair());
        if let Some(held) = &front.held {
            let u = self.held_voltage(held, reference);
            let held = compensates.then(|| {
                let k_hold = self.k_hold();
                let doc = "Contribution of the present current when the voltage takes effect.";
                self.l.b.stage("hold_current", &[doc]);
                named! {
                    let held = k_hold * i;
                }
                held
            });
            return Deadbeat { u, held };
        }
        let k_hold = self.k_hold();
        let k_decay = (self.options.delay == 1).then(|| self.k_decay());
        let doc: &[&str] = if self.options.delay == 1 {
            &[
                "Deadbeat voltage, the paper's (11) corrected: v = K (i_ref - a i_pred) + e, with the prediction",
                "i_pred = a i + b (v_now - e_now) of (7) folded in:",
                "v = K i_ref - K a^2 i + (1 - a)(v_now - e_now) + e - (v_now - e_now).",
            ]
        } else {
            &["Deadbeat voltage without computation delay: v = K (i_ref - a i) + e."]
        };
        self.l.b.stage("deadbeat_voltage", doc);
        let held = k_hold * i;
        let held = if compensates {
            named! {
                let held = held;
            }
            held
        } else {
            held
        };
        let open = reference - held;
        let u = match (k_decay.zip(front.net_now()), front.e) {
            (Some((k_decay, net)), Some(e)) => open + k_decay * net + e - net,
            (None, Some(e)) => open + e,
            _ => open,
        };
        let u = unlimited_voltage(self.l, u);
        let held = compensates.then_some(held);
        Deadbeat { u, held }
    }
}
