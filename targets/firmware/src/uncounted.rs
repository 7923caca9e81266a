//! The counter on hosts, where sessions run in tests: there is none.

use crate::drives::StepFn;
use hexagen::Sample;

/// Instructions of one call: unknown.
pub fn count<D>(_: StepFn<D>, _: &mut D, _: Sample) -> Option<u32> {
    None
}

/// A call for a log of instructions: there is none.
pub fn trace<D>(_: StepFn<D>, _: &mut D, _: Sample) -> Option<()> {
    None
}

/// An interrupt's function as a step.
pub fn interrupt_step(_: extern "C" fn()) -> StepFn<()> {
    extern "C" fn nothing(_: &mut (), _: u16, _: u16, _: u8, _: u16) -> u64 {
        0
    }
    StepFn::Bits(nothing)
}

/// Bytes of stack of one call: unknown.
pub fn sound<D>(_: StepFn<D>, _: &mut D, _: Sample) -> Option<u32> {
    None
}
