#![doc = include_str!("semantics.md")]

mod linear;
mod lower;

use super::current_loop::{LinearLoop, LoopDesign};
use super::start::{EMF_BY_PAIRS, INTEGRATED_EMF};
use super::{Cause, Description, Law, Period, StableRange, Start};
use crate::blocks::Scale;
use crate::diagnostics::engineering;
use crate::scaling::Lowered;
use crate::spec::{PiModulation, PiPwmSpec, Spec};
use linear::{PiLoop, is_stable_with_winding_time};

impl Law for PiPwmSpec {
    fn lower(&self, spec: &Spec, design: &LoopDesign, scale: Scale) -> Lowered {
        lower::lower(spec, self, design, scale)
    }

    fn describe(&self, spec: &Spec, _: &LoopDesign, stable: Option<StableRange>) -> Description {
        let gain = self.proportional_gain(&spec.motor);
        Description {
            title: if self.six_step {
                "Six-step PI current controller"
            } else {
                "PI current controller in the stationary plane"
            },
            notes: vec![
                format!(
                    "Tuning: the proportional gain 2 pi f L = {} puts the crossover of the current loop at {};",
                    engineering(gain, "V/A"),
                    engineering(self.bandwidth, "Hz"),
                ),
                format!(
                    "the integral time of {} cancels the winding's pole if it equals L/R = {}. The anti-windup tracks",
                    engineering(self.integral_time, "s"),
                    engineering(spec.motor.inductance / spec.motor.resistance, "s"),
                ),
                "with the same time.".to_owned(),
            ],
            stable,
            constants: vec![],
        }
    }

    fn period(&self) -> Period {
        match self.modulation {
            PiModulation::Table2 => Period::Intervals,
            PiModulation::ThreePhase => Period::Pulses,
        }
    }

    fn linear<'a>(
        &'a self,
        spec: &'a Spec,
        design: &'a LoopDesign,
    ) -> Option<Box<dyn LinearLoop + 'a>> {
        Some(Box::new(PiLoop {
            options: self,
            design,
            spec,
        }))
    }

    fn uses_emf(&self) -> bool {
        self.feed_forward
    }

    fn start(&self, slow: bool) -> Start {
        Start {
            part_of_bus: if self.feed_forward && slow {
                INTEGRATED_EMF
            } else if self.modulation == PiModulation::Table2 {
                EMF_BY_PAIRS
            } else {
                1.0
            },
            integrates: self.feed_forward && self.common.emf.is_modelled(),
            ..Start::default()
        }
    }

    fn unstable_by(&self, spec: &Spec) -> Cause {
        if is_stable_with_winding_time(spec, self) {
            Cause {
                field: "integral_time",
                value: engineering(self.integral_time, "s"),
                remedy: "choose a longer integral time, such as the default L/R",
            }
        } else {
            Cause {
                field: "bandwidth",
                value: engineering(self.bandwidth, "Hz"),
                remedy: "choose a lower bandwidth or a shorter control period",
            }
        }
    }

    fn steadier(&self, _: &Spec) -> &'static str {
        "lower `bandwidth`"
    }
}
