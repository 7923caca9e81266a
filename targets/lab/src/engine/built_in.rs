//! The motor library and the drives compiled into this program by its build script.

use hexagen::{Control, Drive, Fault, Format, Sample};
use hexagen_reference::verify::{Compiled, Subject};
use hexagen_reference::{AnyCommand, Stop};
use std::fmt;

/// A motor of the library.
#[derive(Clone, Copy, Debug)]
pub struct Library {
    /// File name without ending.
    pub name: &'static str,
    /// File name for messages.
    pub file: &'static str,
    /// TOML text.
    pub text: &'static str,
}

/// A compiled drive.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// Name of the library's motor.
    pub motor: &'static str,
    /// Normalised specification.
    pub spec: &'static str,
    /// Formats of signals and coefficients.
    pub formats: &'static [Format],
    /// Names of the state words.
    pub state_names: fn() -> Vec<&'static str>,
    /// A drive at rest with zero set-point.
    pub new: fn() -> Box<dyn Subject + Send>,
}

impl BuiltIn {
    const fn of<C: Control<Command: Into<AnyCommand>>>(motor: &'static str) -> Self {
        Self {
            motor,
            spec: C::SPEC,
            formats: C::FORMATS,
            state_names: || Drive::<C>::state_names().collect(),
            new: || Box::new(Compiled::<C>::new()),
        }
    }
}

mod generated {
    include!(concat!(env!("OUT_DIR"), "/library.rs"));
}

pub use generated::drives;

/// The motor library, by name.
pub fn library() -> &'static [Library] {
    generated::MOTORS
}

/// The compiled drive of a normalised specification, whatever its name.
pub fn built_in(spec: &str) -> Option<&'static BuiltIn> {
    generated::DRIVES
        .iter()
        .find(|drive| nameless(drive.spec) == nameless(spec))
}

/// A normalised specification without its first line, the name, as key.
fn nameless(spec: &str) -> &str {
    spec.split_once('\n').map_or(spec, |(_, rest)| rest)
}

/// Any drive behind a pointer.
pub struct AnySubject<'g>(pub Box<dyn Subject + Send + 'g>);

impl fmt::Debug for AnySubject<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("AnySubject")
    }
}

impl Subject for AnySubject<'_> {
    #[inline]
    fn step(&mut self, sample: &Sample) -> AnyCommand {
        self.0.step(sample)
    }
    fn set_current(&mut self, bits: i32) {
        self.0.set_current(bits);
    }
    fn set_torque(&mut self, bits: i32) {
        self.0.set_torque(bits);
    }
    fn set_speed(&mut self, bits: i32) {
        self.0.set_speed(bits);
    }
    fn set_bus(&mut self, counts: u16) {
        self.0.set_bus(counts);
    }
    fn reset(&mut self) {
        self.0.reset();
    }
    fn calibrate(&mut self) {
        self.0.calibrate();
    }
    fn precharge(&mut self) {
        self.0.precharge();
    }

    fn stop(&mut self, stop: Stop) {
        self.0.stop(stop);
    }
    #[inline]
    fn fault(&self) -> Option<Fault> {
        self.0.fault()
    }
    #[inline]
    fn bus_is_stale(&self) -> bool {
        self.0.bus_is_stale()
    }
    #[inline]
    fn state_words(&self, words: &mut [i32]) {
        self.0.state_words(words);
    }
    fn set_state_words(&mut self, words: &[i32]) {
        self.0.set_state_words(words);
    }
}
