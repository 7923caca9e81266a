#![doc = include_str!("semantics.md")]

mod linear;
mod lower;

use super::current_loop::{LinearLoop, LoopDesign};
use super::{Cause, Description, Law, Period, StableRange, Start};
use crate::blocks::Scale;
use crate::diagnostics::{engineering, percent};
use crate::scaling::Lowered;
use crate::spec::{PPwmSpec, Spec};
use linear::ProportionalLoop;

impl Law for PPwmSpec {
    fn lower(&self, spec: &Spec, design: &LoopDesign, scale: Scale) -> Lowered {
        lower::lower(spec, self, design, scale)
    }

    fn describe(&self, spec: &Spec, _: &LoopDesign, stable: Option<StableRange>) -> Description {
        let gain = self.proportional_gain(&spec.motor);
        let lack = spec.motor.resistance / (gain + spec.motor.resistance);
        Description {
            title: "Proportional current controller in the stationary plane",
            notes: vec![
                format!(
                    "Tuning: the proportional gain 2 pi f L = {} puts the crossover of the current loop at {}.",
                    engineering(gain, "V/A"),
                    engineering(self.bandwidth, "Hz"),
                ),
                format!(
                    "There is no integral: the current stays {} below its reference, R/(k_p + R).",
                    percent(lack)
                ),
            ],
            stable,
            constants: vec![],
        }
    }

    fn period(&self) -> Period {
        Period::Pulses
    }

    fn linear<'a>(
        &'a self,
        spec: &'a Spec,
        design: &'a LoopDesign,
    ) -> Option<Box<dyn LinearLoop + 'a>> {
        Some(Box::new(ProportionalLoop {
            options: self,
            gain: self.proportional_gain(&spec.motor),
            design,
        }))
    }

    fn start(&self, _: bool) -> Start {
        Start {
            integrates: self.common.emf.is_modelled(),
            ..Start::default()
        }
    }

    fn unstable_by(&self, _: &Spec) -> Cause {
        Cause {
            field: "bandwidth",
            value: engineering(self.bandwidth, "Hz"),
            remedy: "choose a lower bandwidth or a shorter control period",
        }
    }

    fn steadier(&self, _: &Spec) -> &'static str {
        "lower `bandwidth`"
    }
}
