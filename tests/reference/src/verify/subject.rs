//! Subjects of a comparison with the bit-true model.

use crate::{AnyCommand, Stop};
use hexagen::fixed::types::I16F16;
use hexagen::{Control, Drive, Fault, Sample};

/// An implementation of a drive's steps: compiled code, an interpreter, a remote target.
pub trait Subject {
    /// Runs one control period.
    fn step(&mut self, sample: &Sample) -> AnyCommand;
    /// Sets the current set-point, bits of an `I16F16` in ampere.
    fn set_current(&mut self, bits: i32);
    /// Sets the torque set-point, bits of an `I16F16` in newton metres.
    fn set_torque(&mut self, bits: i32);
    /// Sets the speed, bits of an `I16F16` in rpm, if there is a speed loop.
    fn set_speed(&mut self, bits: i32);
    /// Sets the bus voltage as an ADC count.
    fn set_bus(&mut self, counts: u16);
    /// Clears a trip and all control state.
    fn reset(&mut self);
    /// Starts current-offset calibration.
    fn calibrate(&mut self);
    /// Starts bootstrap pre-charge.
    fn precharge(&mut self);
    /// Coasts, brakes, or ends both.
    fn stop(&mut self, stop: Stop);
    /// Fault of the drive.
    fn fault(&self) -> Option<Fault>;
    /// Whether a measured bus voltage is stale.
    fn bus_is_stale(&self) -> bool;
    /// Copies the state words, in the order of their names, to `words`.
    fn state_words(&self, words: &mut [i32]);
    /// Overwrites the state words.
    fn set_state_words(&mut self, words: &[i32]);
}

/// A compiled drive.
#[derive(Debug)]
pub struct Compiled<C: Control>(pub Drive<C>);

impl<C: Control> Compiled<C> {
    /// The drive in its initial state.
    pub const fn new() -> Self {
        Self(Drive::new())
    }
}

impl<C: Control> Default for Compiled<C> {
    fn default() -> Self {
        Self::new()
    }
}

impl<C: Control<Command: Into<AnyCommand>>> Subject for Compiled<C> {
    #[inline]
    fn step(&mut self, sample: &Sample) -> AnyCommand {
        self.0.step(sample).into()
    }

    fn set_current(&mut self, bits: i32) {
        self.0.set_current(I16F16::from_bits(bits));
    }

    fn set_torque(&mut self, bits: i32) {
        self.0.set_torque(I16F16::from_bits(bits));
    }

    fn set_speed(&mut self, bits: i32) {
        self.0.set_speed_bits(bits);
    }

    fn set_bus(&mut self, counts: u16) {
        self.0.set_bus_counts(counts);
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
        match stop {
            Stop::Coast => self.0.coast(),
            Stop::Brake => self.0.brake(),
            Stop::Resume => self.0.resume(),
        }
    }

    #[inline]
    fn fault(&self) -> Option<Fault> {
        self.0.status().fault
    }

    #[inline]
    fn bus_is_stale(&self) -> bool {
        self.0.status().bus_is_stale
    }

    #[inline]
    fn state_words(&self, words: &mut [i32]) {
        self.0.state_words(words);
    }

    fn set_state_words(&mut self, words: &[i32]) {
        self.0.set_state_words(words);
    }
}
