//! Dead-time compensation of the compare values (semantics page of predictive deadbeat, step 11).

use super::CurrentLoop;
use crate::diagnostics::engineering;
use crate::ir::{Phases, named};

/// Current, over the largest set-point, below which the shift is proportional to the current: above
/// the ripple around zero, far below torque-making currents.
const SOFT_BAND: f64 = 0.1;

impl<'b> CurrentLoop<'_, 'b> {
    /// Shifts of phases a, b, c, words of the nominal bus. `reference` is the reference current and
    /// `held` the measured one, both as voltages with `stiffness` volt per ampere.
    pub fn dead_time_shifts(
        &self,
        reference: Phases<'b>,
        held: Phases<'b>,
        stiffness: f64,
    ) -> Phases<'b, 3> {
        let l = self.l;
        let inverter = &l.spec.inverter;
        let lost = inverter.dead_time / inverter.pwm_period() * inverter.v_bus;
        let band = SOFT_BAND * inverter.max_current;
        let share = lost / (2.0 * stiffness * band);
        let doc = format!(
            "Slope of the dead-time compensation within {}.",
            engineering(band, "A")
        );
        let k_dead = l.coefficient(
            "k_dead",
            share,
            self.options.word,
            &doc,
            &format!("{share:.6}"),
        );
        l.b.stage(
            "compensate_dead_time",
            &[
                "Dead-time compensation. A leg loses the dead time's share of the bus while current flows into the motor and",
                "gains it while it flows out. The current is the mean of reference and measured one; near zero the shift is proportional.",
            ],
        );
        let dead_time = engineering(inverter.dead_time, "s");
        let doc = format!("Voltage lost to {dead_time} of dead time");
        let limit = l.volts_word(lost);
        named! {
            let flow = reference + held;
            let shift = (k_dead * flow.with_c("flow")).map(|shift| {
                shift.within(l.voltage("dead_max", limit, &doc))
            });
        }
        shift
    }
}
