//! Runtime of generated current controllers: the dependency of firmware.
//!
//! `hexagen::controller!` emits a type per motor and controller: constants, tables and the law.
//! This crate has the parts that all drives share: the [`Drive`] and its two halves, the
//! [`Supervisor`] (faults, calibration, start-up), inputs ([`Sample`]) and outputs ([`Legs`], [`Intervals`]).
//!
//! - [`guide`]: from a data sheet to a motor that turns, in chapters of a few minutes each; begin with
//!   [the first drive](guide::first_drive).
//! - [`specification`]: every field, option and unit.
//! - [`conventions`]: signs, angles, sectors, wiring.
//! - [`errata`]: errors of the paper.
#![no_std]

mod angle;
pub mod arith;
mod bus;
mod bus_watch;
mod command;
mod constants;
mod control;
/// Signs, angles, sectors, wiring.
///
#[cfg_attr(doc, doc = include_str!("conventions.md"))]
pub mod conventions {}
mod double_buffer;
mod drive;
/// Errors in the paper.
///
#[cfg_attr(doc, doc = include_str!("errata.md"))]
pub mod errata {}
mod format;
#[cfg(doc)]
pub mod guide;
mod limits;
mod sample;
mod sensors;
mod set_point;
mod shared;
#[cfg(feature = "signals")]
mod signals;
#[cfg(not(feature = "signals"))]
#[path = "no_signals.rs"]
mod signals;
/// Reference: fields of motor, inverter and controller, and units.
///
#[cfg_attr(doc, doc = include_str!("specification/fields.md"))]
#[cfg_attr(doc, doc = include_str!("specification/options.md"))]
#[cfg_attr(doc, doc = include_str!("specification/units.md"))]
pub mod specification {
    hexagen_macros::specification_fields!();
}
mod status;
mod supervisor;
mod trip;
mod word;

pub use angle::AngleSensor;
pub use bus::{Bus, FixedBus, ToldBus};
pub use command::{Command, Intervals, LegState, Legs};
pub use constants::pairs_from_bits;
pub use control::{
    BusWords, Control, HallShifts, MeasuredBus, Observation, SpeedLoop, State, Unit, Units, Words,
};
pub use drive::{ControlLoop, Drive, DynLoop};
pub use fixed;
pub use format::{Format, Rounding};
pub use hexagen_macros::{State, controller, verify};
pub use limits::Limits;
pub use sample::{Checked, Sample};
pub use sensors::{SensedPhases, Sensor, Sensors, ThirdSensor};
pub use set_point::SetPoint;
#[cfg(feature = "signals")]
pub use signals::Signals;
pub use status::{Fault, Mode, Status};
pub use supervisor::{Supervisor, Unfit};
pub use trip::{Places, Trip};
