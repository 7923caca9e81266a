#![doc = include_str!("semantics.md")]

mod linear;
mod lower;

use super::current_loop::{LinearLoop, LoopDesign};
use super::start::EMF_BY_PAIRS;
use super::{Description, Law, Period, StableRange, Start};
use crate::blocks::Scale;
use crate::scaling::Lowered;
use crate::spec::{Modulation, PdccSpec, Spec};
use linear::DeadbeatLoop;

impl Law for PdccSpec {
    fn lower(&self, spec: &Spec, design: &LoopDesign, scale: Scale) -> Lowered {
        lower::lower(spec, self, design, scale)
    }

    fn describe(&self, _: &Spec, _: &LoopDesign, stable: Option<StableRange>) -> Description {
        Description {
            title: "Predictive deadbeat current controller",
            notes: vec![],
            stable,
            constants: vec![],
        }
    }

    fn period(&self) -> Period {
        match self.modulation {
            Modulation::Table2 => Period::Intervals,
            Modulation::ThreePhase | Modulation::Pair => Period::Pulses,
        }
    }

    fn linear<'a>(
        &'a self,
        _: &'a Spec,
        design: &'a LoopDesign,
    ) -> Option<Box<dyn LinearLoop + 'a>> {
        let options = self;
        Some(Box::new(DeadbeatLoop { options, design }))
    }

    fn start(&self, _: bool) -> Start {
        Start {
            hides_leg: self.modulation == Modulation::Pair,
            part_of_bus: match self.modulation {
                Modulation::Table2 => EMF_BY_PAIRS,
                Modulation::ThreePhase | Modulation::Pair => 1.0,
            },
            ..Start::default()
        }
    }
}
