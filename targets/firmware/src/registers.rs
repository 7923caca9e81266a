//! Registers of a motor's peripherals. No emulated board has them, so words of RAM replace them: an
//! interrupt accesses them as on a chip, by one load or store each that no compiler removes.
#![expect(
    unsafe_code,
    reason = "what is written to a register counts as read; only a volatile access says so"
)]

use core::sync::atomic::AtomicU16;
use hexagen::{Legs, Sample};

/// One register, of which a halfword is used, as in data registers of ADCs and compare registers of
/// timers.
#[derive(Debug)]
struct Register(AtomicU16);

impl Register {
    const fn new(word: u16) -> Self {
        Self(AtomicU16::new(word))
    }

    #[inline]
    fn read(&self) -> u16 {
        // SAFETY: the word is valid while borrowed, and aligned; only one core accesses it.
        unsafe { self.0.as_ptr().read_volatile() }
    }

    #[inline]
    fn write(&self, word: u16) {
        // SAFETY: as above.
        unsafe { self.0.as_ptr().write_volatile(word) }
    }
}

/// Two ADCs, the Hall port, and a timer with three channels.
#[derive(Debug)]
pub struct Registers {
    adc_a: Register,
    adc_b: Register,
    hall: Register,
    compare: [Register; 3],
    legs: Register,
}

impl Registers {
    /// Without current, all legs off.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "stands in a static")]
    pub const fn new() -> Self {
        Self {
            adc_a: Register::new(0),
            adc_b: Register::new(0),
            hall: Register::new(0),
            compare: [const { Register::new(0) }; 3],
            legs: Register::new(Legs::OFF.states()),
        }
    }

    /// Contents of the ADCs and the Hall port. The interrupts' drives see edges at samples: no
    /// timer captures them.
    #[inline]
    #[must_use]
    pub fn sample(&self) -> Sample {
        let adc = [self.adc_a.read(), self.adc_b.read()];
        Sample::with_hall(adc, self.hall.read() as u8)
    }

    /// Writes the three compare values, and the leg states into the timer's output enables.
    #[inline]
    pub fn apply(&self, legs: Legs) {
        for (register, value) in self.compare.iter().zip(legs.compare()) {
            register.write(value);
        }
        self.legs.write(legs.states());
    }

    /// The inverter's command.
    #[must_use]
    pub fn legs(&self) -> Legs {
        let [a, b, c] = self.compare.each_ref().map(Register::read).map(u64::from);
        Legs::from_bits(a | b << 16 | c << 32 | u64::from(self.legs.read()) << 48)
    }

    /// Simulates the ADCs and the Hall sensors.
    pub fn feed(&self, sample: &Sample) {
        let [adc_a, adc_b, _] = sample.adc();
        self.adc_a.write(adc_a);
        self.adc_b.write(adc_b);
        self.hall.write(sample.hall().into());
    }
}
