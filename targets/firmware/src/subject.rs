//! A drive for replay, in Rust or in C.

use crate::wire::Stop;
use hexagen::fixed::types::I16F16;
use hexagen::{Control, Drive, Fault, State, Supervisor};

/// Maximum number of state words of a drive.
pub(crate) const MOST_WORDS: usize = 64;

/// A drive for replay, without its step function.
pub trait Subject {
    /// Number of its state words.
    const WORDS: usize;

    /// A drive in its initial state.
    fn new() -> Self;
    /// Sets the current, bits of an `I16F16` in ampere.
    fn set_current(&mut self, bits: i32);
    /// Sets the torque, bits of an `I16F16` in newton metres.
    fn set_torque(&mut self, bits: i32);
    /// Sets the speed, bits of an `I16F16` in rpm, if there is a speed loop.
    fn set_speed(&mut self, bits: i32);
    /// Sets the bus voltage, ADC counts, if it is measured.
    fn set_bus(&mut self, counts: u16);
    /// Clears a trip and all control state.
    fn reset(&mut self);
    /// Starts the offset calibration.
    fn calibrate(&mut self);
    /// Starts the bootstrap pre-charge.
    fn precharge(&mut self);
    /// Coasts, brakes, or ends both.
    fn stop(&mut self, stop: Stop);
    /// Fault of the drive.
    fn fault(&self) -> Option<Fault>;
    /// Copies its state words to the front of `words`.
    fn state_words(&self, words: &mut [i32]);
    /// Overwrites a state word.
    fn set_state_word(&mut self, index: usize, value: i32);
}

impl<C: Control> Subject for Drive<C> {
    const WORDS: usize = Supervisor::NAMES.len() + C::State::NAMES.len();

    fn new() -> Self {
        Self::new()
    }

    fn set_current(&mut self, bits: i32) {
        self.set_point().set_current(I16F16::from_bits(bits));
    }

    fn set_torque(&mut self, bits: i32) {
        self.set_point().set_torque(I16F16::from_bits(bits));
    }

    fn set_speed(&mut self, bits: i32) {
        self.set_speed_bits(bits);
    }

    fn set_bus(&mut self, counts: u16) {
        self.set_bus_counts(counts);
    }

    fn reset(&mut self) {
        self.control().reset();
    }

    fn calibrate(&mut self) {
        self.control().calibrate();
    }

    fn precharge(&mut self) {
        self.control().precharge();
    }

    fn stop(&mut self, stop: Stop) {
        let mut control = self.control();
        match stop {
            Stop::Coast => control.coast(),
            Stop::Brake => control.brake(),
            Stop::Resume => control.resume(),
        }
    }

    fn fault(&self) -> Option<Fault> {
        self.status().fault
    }

    fn state_words(&self, words: &mut [i32]) {
        Self::state_words(self, words);
    }

    fn set_state_word(&mut self, index: usize, value: i32) {
        let mut words = [0; MOST_WORDS];
        Self::state_words(self, &mut words);
        let words = &mut words[..<Self as Subject>::WORDS];
        if let Some(word) = words.get_mut(index) {
            *word = value;
        }
        self.set_state_words(words);
    }
}
