#![doc = include_str!("semantics.md")]

mod changes;
mod choose;
mod describe;
mod divide;
mod lower;
mod off_legs;
mod score;
mod torque;
mod two_steps;
mod weighted;

use super::current_loop::{LinearLoop, LoopDesign};
use super::{Description, Law, Period, StableRange};
use crate::blocks::Scale;
use crate::scaling::Lowered;
use crate::spec::{FcsMpcSpec, Spec};

impl Law for FcsMpcSpec {
    fn lower(&self, spec: &Spec, design: &LoopDesign, scale: Scale) -> Lowered {
        lower::lower(spec, self, design, scale)
    }

    fn describe(&self, spec: &Spec, design: &LoopDesign, _: Option<StableRange>) -> Description {
        describe::describe(spec, self, design)
    }

    fn period(&self) -> Period {
        if self.modulated {
            Period::TwoVectors
        } else {
            Period::OneVector
        }
    }

    fn linear<'a>(&'a self, _: &'a Spec, _: &'a LoopDesign) -> Option<Box<dyn LinearLoop + 'a>> {
        None
    }
}
