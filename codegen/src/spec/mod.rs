//! Specification: two front ends, one syntax tree, units, checks, and the checked types.
//!
//! Macro tokens, TOML files and command-line variants become a [`SpecAst`]; [`check()`] turns it into
//! a [`Spec`] in SI units with every default filled in, or into all errors at once.
//!
// Its example is a documentation test of the crate `hexagen`, which shows it, too.
#![cfg_attr(not(doctest), doc = include_str!("reference.md"))]
#![doc = include_str!("options.md")]
#![doc = include_str!("units.md")]

mod alternatives;
mod angle;
pub mod ast;
mod basis;
mod board;
mod board_library;
pub(crate) mod check;
pub(crate) mod controller;
mod emf_shape;
mod envelope;
mod field_rule;
pub(crate) mod field_texts;
pub(crate) mod fields;
mod harmonics;
pub(crate) mod health;
mod load;
mod long_period;
mod macro_syntax;
mod model;
mod normalised;
mod option_row;
mod option_texts;
mod pwm_ripple;
pub(crate) mod reader;
mod rule;
mod sampled_halls;
mod sensing;
mod set_point;
#[cfg(test)]
mod tests;
mod toml_syntax;
mod torque_share;
pub mod units;
mod value;
mod variant;
mod words;

pub use angle::{AngleDirection, AngleSensor, RotorSource};
pub use ast::{Board, BoardFile, Field, OF_CORE, SpecAst, TARGET};
pub use board_library::{BOARDS, LibraryBoard};
pub use check::{Origin, Origins, check};
pub(crate) use controller::TABLE2;
pub use controller::{
    Candidates, CommonMode, ControllerSpec, Core, Discretisation, EmfSource, FcsMpcSpec, KINDS,
    Kind, Learning, LimitRule, LoopOptions, Modulation, OffLegModel, PPwmSpec, PdccSpec,
    PhccCandidates, PhccSpec, PiModulation, PiPwmSpec, Reference, SpeedLoop, SwitchingTable,
    Target, ZeroVector,
};
pub use emf_shape::{proportional_current, zero_sum_integral};
pub use envelope::Envelope;
pub use fields::section_of;
pub use harmonics::{Harmonics, ORDERS};
pub use load::{load_motor_file, motor_text, reason_of};
pub use macro_syntax::{FileName, MacroInput, parse_macro};
pub use model::{
    BUS_FRESH, BusCurrents, BusSource, EmfShape, Fade, HALL_ANGLES, InverterSpec, MotorSpec,
    RotorSensing, Spec,
};
pub use option_texts::help as option_help;
pub use rule::Rule;
pub use sampled_halls::MOST_RIPPLE;
pub use sensing::{
    CurrentSensing, CurrentSensor, CurrentSum, RATIO_BITS, SensedPhases, SensingTimes,
    SensingWindow,
};
pub use toml_syntax::{parse_board, parse_toml};
pub use torque_share::{MOST_TURN, share_of_torque};
pub use variant::{apply_variant, variant_of};
pub use words::Word;
