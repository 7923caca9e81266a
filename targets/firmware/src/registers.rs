//! Registers of a motor's peripherals. No emulated board has them, so words of RAM stand in their place: an interrupt
//! reads and writes them as it would those of a chip, one load or store each.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use hexagen::{LegState, Legs, Sample};

/// Two ADCs, the Hall port, and a timer with three channels.
#[derive(Debug)]
pub struct Registers {
    adc_a: AtomicU32,
    adc_b: AtomicU32,
    hall: AtomicU32,
    hall_ticks: AtomicU32,
    compare: [AtomicU32; 3],
    legs: AtomicU32,
}

impl Registers {
    /// Without current, all legs off.
    #[must_use]
    #[expect(clippy::new_without_default, reason = "stands in a static")]
    pub const fn new() -> Self {
        Self {
            adc_a: AtomicU32::new(0),
            adc_b: AtomicU32::new(0),
            hall: AtomicU32::new(0),
            hall_ticks: AtomicU32::new(0),
            compare: [const { AtomicU32::new(0) }; 3],
            legs: AtomicU32::new(0x02_02_02),
        }
    }

    /// What the converters and the Hall port hold.
    #[inline]
    #[must_use]
    pub fn sample(&self) -> Sample {
        Sample {
            adc_a: self.adc_a.load(Relaxed) as u16,
            adc_b: self.adc_b.load(Relaxed) as u16,
            hall: self.hall.load(Relaxed) as u8,
            hall_ticks: self.hall_ticks.load(Relaxed) as u16,
        }
    }

    /// Writes the three compare values, and what the legs do besides into the timer's output enables.
    #[inline]
    pub fn apply(&self, legs: &Legs) {
        for (register, value) in self.compare.iter().zip(legs.compare) {
            register.store(u32::from(value), Relaxed);
        }
        let [a, b, c] = legs.state.map(|state| state as u8);
        self.legs.store(u32::from_le_bytes([a, b, c, 0]), Relaxed);
    }

    /// What the inverter is told.
    #[must_use]
    pub fn legs(&self) -> Legs {
        let [a, b, c, _] = self.legs.load(Relaxed).to_le_bytes();
        let state = |byte: u8| LegState::from_word(byte.into());
        Legs {
            compare: self
                .compare
                .each_ref()
                .map(|register| register.load(Relaxed) as u16),
            state: [a, b, c].map(state),
        }
    }

    /// Plays the converters and the Hall sensors.
    pub fn feed(&self, sample: &Sample) {
        self.adc_a.store(sample.adc_a.into(), Relaxed);
        self.adc_b.store(sample.adc_b.into(), Relaxed);
        self.hall.store(sample.hall.into(), Relaxed);
        self.hall_ticks.store(sample.hall_ticks.into(), Relaxed);
    }
}
