//! Dead-time compensation of the compare values (shared semantics page, step 11).

use super::CurrentLoop;
use crate::diagnostics::engineering;
use crate::ir::{Expr, Phases, named};

/// Current, over the largest set-point, over which the shift grows in proportion to the current.
const SOFT_BAND: f64 = 0.1;

/// Current of a leg below which it loses nothing, over (max - min) T/L of three pulsed legs: half the
/// ripple of a leg midway between the others, 1/12, where its current crosses zero. Of centred pulses the ripple
/// falls as the leg leaves the middle.
const QUIET: f64 = 1.0 / 24.0;

impl<'b> CurrentLoop<'_, 'b> {
    /// Shifts of phases a, b, c, words of the nominal bus. `reference` is the current wanted at the
    /// end of the target period and `held` the measured one, both as voltages with `stiffness` volt
    /// per ampere; `spread` is that of the voltages, if three legs are pulsed.
    pub fn dead_time_shifts(
        &self,
        reference: Phases<'b>,
        held: Phases<'b>,
        stiffness: f64,
        spread: Option<Expr<'b>>,
    ) -> Phases<'b, 3> {
        let l = self.l;
        let inverter = &l.spec.inverter;
        let lost = inverter.dead_time / inverter.pwm_period() * inverter.v_bus;
        let band = SOFT_BAND * inverter.max_current;
        let share = lost / (2.0 * stiffness * band);
        let doc = format!(
            "Slope of the dead-time compensation over {}.",
            engineering(band, "A")
        );
        let word = self.options.word;
        let k_dead = l.coefficient("k_dead", share, word, &doc, &format!("{share:.6}"));
        l.b.stage(
            "compensate_dead_time",
            &[
                "Dead-time compensation. A leg loses the dead time's share of the bus while current flows into the motor at its",
                "rising edge, and gains it while current flows out at its falling one; where the ripple reaches both signs, neither.",
                "The current is that in the middle of the target period, by the measured one and the reference at its end.",
            ],
        );
        let dead_time = engineering(inverter.dead_time, "s");
        let doc = format!("Voltage lost to {dead_time} of dead time");
        let limit = l.volts_word(lost);
        // From the sample to the end of the target period a proportional current turns evenly.
        let sum = reference + held;
        named! {
            let flow = if self.options.delay == 1 { reference + (sum >> 1) } else { sum };
        }
        let flow = flow.with_c("flow");
        let driven = match spread {
            Some(spread) => {
                let ratio =
                    2.0 * stiffness * QUIET * inverter.pwm_period() / l.spec.motor.inductance;
                let doc = "Flow that the ripple takes to zero, over the spread of the voltages.";
                let k_quiet = l.coefficient("k_quiet", ratio, word, doc, &format!("{ratio:.6}"));
                named! {
                    let quiet = (k_quiet * spread).max(0);
                }
                flow.map(|flow| flow - flow.within(quiet))
            }
            None => flow,
        };
        named! {
            let shift = (k_dead * driven).map(|shift| {
                shift.within(l.voltage("dead_max", limit, &doc))
            });
        }
        shift
    }
}
