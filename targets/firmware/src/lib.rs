//! Common part of the firmware of all targets.
//!
//! A firmware crate lists its drives with [`drives!`]; the test bench (`cargo xtask pil`,
//! `cargo xtask cost`) sends vectors to the core, and [`session`] replays them on the drive, with
//! answers as digests, in full, or as counts of instructions. [`wire`] is the common format. The
//! modules in `on_target` are part of each firmware crate: they emit step functions, or use its
//! board.
#![no_std]

#[cfg_attr(not(target_os = "none"), path = "uncounted.rs")]
mod counter;
#[cfg(target_os = "none")]
pub mod demonstration;
mod drives;
pub mod interrupt;
pub mod link;
pub mod peers;
mod registers;
#[cfg(target_os = "none")]
pub mod semihosted;
pub mod session;
mod subject;
mod supervised;
pub mod wire;

pub use drives::{Drives, LegsInC, Listed, SampleInC, StepFn, sample_of, state_names};
pub use hexagen;
pub use registers::Registers;
pub use subject::Subject;
pub use supervised::{Supervised, step_supervised};
