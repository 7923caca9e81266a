//! Predictive deadbeat control: the deadbeat voltage, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::dead_time::DeadTime;
use super::deadbeat::Form;
use super::intervals::{Modulated, Table2};
use super::{Decision, Inputs, pulses};
use crate::exact::Word;
use crate::model::bit_true::constants::Scale;
use crate::model::bit_true::limit::{self, Limited};
use crate::{Error, Modulation, Saturation, Spec};

#[derive(Clone, Debug)]
pub struct Pdcc<W> {
    pair: bool,
    saturation: Saturation,
    form: Form<W>,
    dead_time: DeadTime<W>,
    common_mode: CommonModeRule<W>,
    of_pair: CommonModeRule<W>,
    table2: Option<Table2<W>>,
}

impl<W: Word> Pdcc<W> {
    pub fn new(spec: &Spec, options: &crate::Pdcc, scale: &Scale) -> Result<Self, Error> {
        Ok(Self {
            pair: options.modulation == Modulation::Pair,
            saturation: options.saturation,
            form: Form::new(options.saturation == Saturation::TorquePriority, scale)?,
            dead_time: DeadTime::new(spec, scale)?,
            common_mode: CommonModeRule::new(spec, options.common_mode, scale)?,
            of_pair: CommonModeRule::of_pair(spec, options.modulation == Modulation::Pair, scale)?,
            table2: (options.modulation == Modulation::Table2)
                .then(|| Table2::new(spec, (options.saturation, options.zero), scale))
                .transpose()?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        let u_unsat = self.form.voltage(now);
        let e = self.form.emf(now);
        if let Some(table2) = &self.table2 {
            let Modulated { u, reach, command } = table2.modulate(now, u_unsat, e);
            return Decision {
                u_unsat,
                u,
                reach,
                vector: 0,
                command,
                integral: now.integral,
                hysteresis: now.hysteresis,
                past: self.form.past(now, u),
            };
        }
        let limited = limit::limit(
            self.saturation,
            now.k,
            self.common_mode.reach(now.v_bus),
            u_unsat,
            e,
        );
        let Limited { u, legs, reach } = self.common_mode.readable(now.k, now.v_bus, &limited);
        let shifts = self.dead_time.shifts(now, self.form.kept(now));
        let command = if self.pair && !now.commutating {
            pulses::pair(now, u_unsat, shifts, &self.of_pair)
        } else {
            pulses::three(now, legs, shifts, &self.common_mode, self.pair)
        };
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command,
            integral: now.integral,
            hysteresis: now.hysteresis,
            past: self.form.past(now, u),
        }
    }
}
