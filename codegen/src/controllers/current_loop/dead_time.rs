//! Dead-time compensation: how far the compare value of each leg shifts (semantics page of predictive deadbeat, step 11).

use super::CurrentLoop;
use crate::diagnostics::engineering;
use crate::ir::Value;

/// Share of the largest set-point below which the shift is in proportion to the current: above the ripple's
/// chatter about zero, far below what makes torque.
const SOFT_BAND: f64 = 0.1;

impl CurrentLoop<'_, '_> {
    /// Shifts of phases a, b, c, words of the nominal bus. `reference` is the wanted current and `held` the measured
    /// one, both as voltages with `stiffness` volt per ampere.
    pub fn dead_time_shifts(
        &mut self,
        reference: [Value; 2],
        held: [Value; 2],
        stiffness: f64,
    ) -> [Value; 3] {
        let word = self.options.word;
        let l = &mut *self.lowering;
        let inverter = &l.spec.inverter;
        let lost = inverter.dead_time / inverter.t_s * inverter.v_bus;
        let band = SOFT_BAND * inverter.max_current;
        let dead_time = engineering(inverter.dead_time, "s");
        let share = lost / (2.0 * stiffness * band);
        let limit = l.volts_word(lost);
        let k_dead = l.coefficient(
            "k_dead",
            share,
            word,
            &format!(
                "Slope of the dead-time compensation within {}.",
                engineering(band, "A")
            ),
            &format!("{share:.6}"),
        );
        l.b.stage(
            "compensate_dead_time",
            &[
                "A leg loses the dead time's share of the bus while its current flows into the motor and gains it while it flows",
                "out; the current is the mean of the wanted and the measured one, and near zero the shift is in proportion.",
            ],
        );
        let [a, b] = [0, 1].map(|x| {
            let twice = l.b.add(reference[x], held[x]);
            l.b.name(["flow_a", "flow_b"][x], twice)
        });
        let c = l.third_phase("flow_c", a, b);
        [0, 1, 2].map(|x| {
            let shift = l.times(k_dead, [a, b, c][x]);
            let doc = format!("What {dead_time} of dead time cost");
            let shift = l.within_volts(shift, "dead_max", limit, &doc);
            l.b.name(["shift_a", "shift_b", "shift_c"][x], shift)
        })
    }
}
