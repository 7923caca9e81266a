//! Ways to run a generated drive: its program in the interpreter, under the runtime's own
//! supervisor, and its emitted code without Cargo ([`standalone`]).
//!
//! The generator's tables of formats and limits come over in the runtime's types here: nothing else
//! knows both.

mod inputs;
mod interpreted;
pub mod standalone;
mod tables;

pub use inputs::Inputs;
pub use interpreted::Interpreted;
pub use tables::{formats, limits, state_names};
