#![doc = include_str!("semantics.md")]

mod describe;
mod lower;
mod table;

pub use table::switching_table;

use super::current_loop::{LinearLoop, LoopDesign};
use super::{Description, Law, Period, StableRange, Start};
use crate::blocks::Scale;
use crate::scaling::Lowered;
use crate::spec::{PhccCandidates, PhccSpec, Spec, SwitchingTable};

/// Line EMF over the bus at which derived switching tables without floating legs are designed;
/// above it their vectors no longer move the current as intended.
const TABLE_EMF: f64 = 0.75;

impl Law for PhccSpec {
    fn lower(&self, spec: &Spec, design: &LoopDesign, scale: Scale) -> Lowered {
        lower::lower(spec, self, design, scale)
    }

    fn describe(&self, spec: &Spec, design: &LoopDesign, _: Option<StableRange>) -> Description {
        describe::describe(spec, self, design)
    }

    fn period(&self) -> Period {
        Period::OneVector
    }

    fn linear<'a>(&'a self, _: &'a Spec, _: &'a LoopDesign) -> Option<Box<dyn LinearLoop + 'a>> {
        None
    }

    fn uses_emf(&self) -> bool {
        self.common.delay == 1
    }

    fn start(&self, _: bool) -> Start {
        Start {
            part_of_bus: match (self.table, self.candidates) {
                (SwitchingTable::Derived, PhccCandidates::ThreePhase) => TABLE_EMF,
                (SwitchingTable::Derived, _) => 1.0,
                // A table from the specification is not analysed.
                _ => 0.0,
            },
            current: self.band,
            ..Start::default()
        }
    }

    fn loses_current(&self) -> bool {
        self.table == SwitchingTable::Printed
    }
}
