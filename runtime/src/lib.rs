//! What firmware depends on: the boundary types of generated current controllers.
//!
//! `hexagen::controller!` emits one `no_std` type per motor; this crate holds the few types that
//! all of them share: the sample that goes into a step, the leg commands that come out, the
//! double buffer behind the set-point, and the trait that lets generic firmware hold any drive.
//! Signs, sectors and wiring are in [`conventions`]; what the paper prints and is not so, in [`errata`].
#![no_std]

pub mod arith;
mod boundary;
mod bus_watch;
mod constants;
/// Signs, angles, sectors, wiring.
///
#[cfg_attr(doc, doc = include_str!("conventions.md"))]
pub mod conventions {}
mod double_buffer;
mod drive;
/// What the paper prints and is not so.
///
#[cfg_attr(doc, doc = include_str!("errata.md"))]
pub mod errata {}
mod shared_word;
mod status;
mod word;

pub use boundary::{Fault, Format, LegState, Legs, Rounding, Sample, mode};
pub use bus_watch::BusWatch;
pub use constants::pairs_from_bits;
pub use double_buffer::DoubleBuffer;
pub use drive::{Drive, DriveLoop, DriveSetPoint};
pub use fixed;
pub use hexagen_macros::{controller, verify};
pub use shared_word::SharedWord;
pub use status::{Mode, Status};
