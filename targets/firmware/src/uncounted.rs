//! The counter of hosts, where sessions run in tests: there is none.

use crate::drives::StepFn;
use hexagen::Sample;

/// Instructions of one call: unknown.
pub fn count<D>(_: StepFn<D>, _: &mut D, _: &Sample) -> Option<u32> {
    None
}

/// Instructions of an interrupt's function: unknown.
pub fn count_interrupt(_: extern "C" fn()) -> Option<u32> {
    None
}

/// Bytes of stack that one call uses: unknown.
pub fn sound<D>(_: StepFn<D>, _: &mut D, _: &Sample) -> Option<u32> {
    None
}
