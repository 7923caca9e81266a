//! Engines that run a controller in the closed loop and in the bit-for-bit test.
//!
//! A [`Prepared`] drive is a specification taken through the whole generator. It provides the
//! fixed-point code (compiled if the drive is built in, else interpreted), the bit-true model and
//! the ideal model, all as [`CurrentLoop`].

mod built_in;
mod external;
mod motor;
mod plant;
mod prepared;
mod selected;
mod verifier;

pub use built_in::{AnySubject, BuiltIn, Library, built_in, drives, library};
pub use external::BuildError;
pub use motor::{MotorSource, SourceError, stem};
pub use plant::{plant_of, reach_of, run_of};
pub use prepared::{Prepared, SetPoint, prepare, prepare_ast};
pub use selected::{PerSensor, PlantOptions, SelectedMotor};
pub use verifier::Verifier;

use crate::closed_loop::CurrentLoop;
use crate::plant::Truth;
use hexagen::{Fault, Sample};
use hexagen_reference::verify::Subject;
use hexagen_reference::{AnyCommand, BitTrue, Ideal};
use serde::Serialize;

/// Model of a controller.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The generated fixed-point program
    #[default]
    Fixed,
    /// The bit-true reference: f64 with a quantiser at every rounding
    BitTrue,
    /// The ideal reference: f64 without rounding
    Ideal,
}

impl Model {
    /// Text for reports.
    pub fn text(self) -> &'static str {
        match self {
            Self::Fixed => "fixed point",
            Self::BitTrue => "bit-true model",
            Self::Ideal => "floating point",
        }
    }
}

/// Engine of the fixed-point program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum EngineKind {
    /// Emitted code, compiled.
    Compiled,
    /// The generator's interpreter.
    Interpreter,
}

impl EngineKind {
    /// Its name in tables and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Compiled => "compiled",
            Self::Interpreter => "interpreter",
        }
    }
}

/// A controller in the loop, whatever computes it. A measured bus voltage is set again before it is stale, as a main
/// program does.
#[derive(Debug)]
pub struct Engine<'g> {
    drive: AnyDrive<'g>,
    bus: Option<ToldBus>,
}

/// A bus voltage that is told before it is old.
#[derive(Clone, Copy, Debug)]
struct ToldBus {
    counts: u16,
    /// Control periods between two calls.
    every: u32,
    /// Control periods to the next call.
    left: u32,
    /// Whether it is told at present.
    is_told: bool,
}

/// A drive or a model of it.
#[derive(Debug)]
enum AnyDrive<'g> {
    /// The fixed-point program, compiled or interpreted.
    Fixed(AnySubject<'g>),
    /// Model B.
    BitTrue(Box<BitTrue>),
    /// Model A.
    Ideal(Box<Ideal>),
}

impl Engine<'_> {
    /// The fixed-point program, for calls other than those here; `None` of a model.
    pub fn subject(&mut self) -> Option<&mut dyn Subject> {
        match &mut self.drive {
            AnyDrive::Fixed(drive) => Some(drive),
            AnyDrive::BitTrue(_) | AnyDrive::Ideal(_) => None,
        }
    }

    /// Sets the set-point, in amperes: exact for the ideal model, else the nearest word.
    pub fn set_current(&mut self, amperes: f64) {
        let bits = (amperes * f64::from(1 << 16)).round() as i32;
        match &mut self.drive {
            AnyDrive::Fixed(drive) => drive.set_current(bits),
            AnyDrive::BitTrue(model) => model.set_current(bits),
            AnyDrive::Ideal(model) => model.set_current_amps(amperes),
        }
    }

    /// Sets the speed, in rpm; drives without a speed loop ignore it.
    pub fn set_speed(&mut self, rpm: f64) {
        let bits = (rpm * f64::from(1 << 16)).round() as i32;
        match &mut self.drive {
            AnyDrive::Fixed(drive) => drive.set_speed(bits),
            AnyDrive::BitTrue(model) => model.set_speed(bits),
            AnyDrive::Ideal(model) => model.set_speed(bits),
        }
    }

    /// Sets the measured bus voltage as an ADC count, which is told from the next step on; drives with a fixed bus
    /// ignore it.
    pub fn set_bus(&mut self, counts: u16) {
        if let Some(bus) = &mut self.bus {
            (bus.counts, bus.left, bus.is_told) = (counts, 0, true);
        }
    }

    /// Tells the bus voltage no longer, until [`set_bus`](Self::set_bus).
    pub fn stop_telling_bus(&mut self) {
        if let Some(bus) = &mut self.bus {
            bus.is_told = false;
        }
    }

    /// Tells the bus voltage where that is due.
    #[inline]
    fn tell_bus(&mut self) {
        let Some(bus) = self.bus.as_mut().filter(|bus| bus.is_told) else {
            return;
        };
        if bus.left > 0 {
            bus.left -= 1;
            return;
        }
        bus.left = bus.every - 1;
        let counts = bus.counts;
        match &mut self.drive {
            AnyDrive::Fixed(drive) => drive.set_bus(counts),
            AnyDrive::BitTrue(model) => model.set_bus(counts),
            AnyDrive::Ideal(model) => model.set_bus(counts),
        }
    }
}

impl CurrentLoop for Engine<'_> {
    #[inline]
    fn step(&mut self, sample: &Sample, _: &Truth) -> AnyCommand {
        self.tell_bus();
        match &mut self.drive {
            AnyDrive::Fixed(drive) => drive.step(sample),
            AnyDrive::BitTrue(model) => model.step(sample),
            AnyDrive::Ideal(model) => model.step_rounded(sample),
        }
    }

    #[inline]
    fn fault(&self) -> Option<Fault> {
        match &self.drive {
            AnyDrive::Fixed(drive) => drive.fault(),
            AnyDrive::BitTrue(model) => model.fault(),
            AnyDrive::Ideal(model) => model.fault(),
        }
    }
}
