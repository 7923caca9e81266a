//! The reference models of every controller, written by hand and independent of the generator.
//!
//! Model A (`Ideal`) is the control law in f64 and physical units, without any rounding. Model B
//! (`BitTrue`) computes every bit of the emitted code in f64 with an explicit quantiser at every
//! rounding point. Both are built from a drive's normalised specification; only the format table is
//! taken from the generator, as data.

mod command;
mod discrete_phase;
mod emf_motion;
mod emf_shape;
mod error;
pub mod exact;
mod formats;
mod model;
mod spec;
pub mod verify;
mod word;

pub use command::AnyCommand;
pub use discrete_phase::DiscretePhase;
pub use emf_shape::EmfShape;
pub use error::Error;
pub use formats::FormatTable;
pub use model::{
    BitTrue, Course, Duties, Ideal, Mode, PhysicalState, Reach, Stop, Trace, Uniform, sixths,
};
pub use spec::{
    Bus, BusSense, Candidates, CommonMode, CommutationEnd, Controller, Discretisation,
    EmfShapeKind, EmfSource, FcsMpc, HallCapture, Inverter, LoopOptions, Modulation, Motor, OffLeg,
    PPwm, Pdcc, Phcc, PiPwm, Reference, Saturation, SensedPhases, Spec, Switch, SwitchingTable,
    Zero,
};
pub use verify::assert_bit_true;
