//! A generated drive that runs without being compiled: the generator's program in its interpreter,
//! under the runtime's own supervisor.
//!
//! The generator's tables of formats and limits come over in the runtime's types here, too: nothing
//! else knows both.

mod inputs;
mod interpreted;
mod tables;

pub use inputs::Inputs;
pub use interpreted::Interpreted;
pub use tables::{formats, limits, state_names};
