//! Predictive deadbeat control: the deadbeat voltage, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::dead_time::DeadTime;
use super::deadbeat::Form;
use super::intervals::{Modulated, Table2};
use super::{Decision, Inputs, pulses};
use crate::exact::Word;
use crate::model::bit_true::limit::Limited;
use crate::model::bit_true::scale::Scale;
use crate::{Error, Modulation, Saturation, Spec, Switch};

#[derive(Clone, Debug)]
pub struct Pdcc<W> {
    pair: bool,
    saturation: Saturation,
    form: Form<W>,
    dead_time: DeadTime<W>,
    /// Whether the prediction knows the rounding of compare values.
    rounding: bool,
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
            dead_time: DeadTime::new(spec, options.modulation == Modulation::ThreePhase, scale)?,
            rounding: options.rounding_prediction == Switch::On,
            common_mode: CommonModeRule::new(spec, options.common_mode, scale)?,
            of_pair: CommonModeRule::of_pair(spec, options.modulation == Modulation::Pair, scale)?,
            table2: Table2::of(
                spec,
                options.modulation,
                (options.saturation, options.zero),
                scale,
            )?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        let u_unsat = self.form.voltage(now);
        let e = self.form.emf(now);
        let Modulated { u, reach, command } = match &self.table2 {
            Some(table2) => table2.modulate(now, u_unsat, e),
            None => self.pulses(now, u_unsat, e),
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

    /// The limited voltage by pulses.
    #[inline]
    fn pulses(&self, now: &Inputs<W>, u_unsat: [W; 2], e: [W; 2]) -> Modulated<W> {
        let rule = &self.common_mode;
        let Limited {
            u,
            legs,
            reach,
            spread,
        } = rule.limited(now, self.saturation, u_unsat, e);
        let shifts = self.dead_time.shifts(now, self.form.kept(now), spread);
        if self.pair && !now.commutating {
            let command = pulses::pair(now, u_unsat, shifts, &self.of_pair);
            return Modulated { u, reach, command };
        }
        let (command, duties) = pulses::three(now, legs, shifts, rule, self.pair);
        let u = if self.rounding {
            pulses::written(now, u, duties)
        } else {
            u
        };
        Modulated { u, reach, command }
    }
}
