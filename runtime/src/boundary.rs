//! The hardware's boundary: what a control period reads and what it writes.

use crate::arith::Word;

/// One control period's measurements, taken at the start of the period.
///
/// `hall` and `hall_ticks` are one snapshot, which no edge may tear apart: latch both in the capture interrupt, or read the
/// ticks, the code, and the ticks again, until the second count is not below the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Phase-a current, raw ADC count: rises with the current into the motor (`adc_inverted: on`: falls).
    pub adc_a: u16,
    /// Phase-b current, likewise.
    pub adc_b: u16,
    /// Hall code `Ha Hb Hc`, Ha in bit 2. 0 and 7 are invalid and trip the drive; which code is which
    /// sector, and which way is forward: [`conventions`](crate::conventions).
    pub hall: u8,
    /// Timer ticks from the last Hall edge to this sample, rounded down, stopping at 65535; the
    /// clock is the specification's `hall_timer_clock`, `HALL_TIMER_HZ`. Read by drives with
    /// `hall_capture: timer` only.
    pub hall_ticks: u16,
}

/// What a leg of the inverter does for one PWM period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum LegState {
    /// Both switches follow the timer channel (complementary outputs).
    Pulsed = 0,
    /// The lower switch is on for the whole period, the upper one off.
    Low = 1,
    /// Both switches are off: the leg floats or its diodes conduct.
    #[default]
    Off = 2,
}

impl LegState {
    /// The state that a word of the step stands for: 0 pulsed, 1 low, else off.
    #[inline]
    #[must_use]
    pub const fn from_word(word: Word) -> Self {
        match word.0 {
            0 => Self::Pulsed,
            1 => Self::Low,
            _ => Self::Off,
        }
    }
}

/// The three legs' commands: compare values for a centre-aligned timer and a state per leg.
///
/// A compare value is the time during which the upper switch is on, in counts, from 0 to the
/// timer's period; it is 0 for a leg that is not pulsed. All of them are one word of 64 bits, which functions
/// return in two registers of a small core.
///
/// ```
/// use hexagen::{LegState, Legs};
///
/// let legs = Legs::new([900, 450, 0], [LegState::Pulsed, LegState::Pulsed, LegState::Off]);
/// assert_eq!(legs.compare(), [900, 450, 0]);
/// assert_eq!(legs.state()[2], LegState::Off);
/// ```
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Legs(u64);

impl Legs {
    /// All legs off: the safe command of a tripped drive.
    pub const OFF: Self = Self::at_rest(LegState::Off);
    /// All lower switches on: charges the bootstrap capacitors.
    pub const LOW: Self = Self::at_rest(LegState::Low);

    /// Compare values and states of legs a, b, c.
    #[inline]
    #[must_use]
    pub const fn new(compare: [u16; 3], state: [LegState; 3]) -> Self {
        let ([a, b, c], [state_a, state_b, state_c]) = (compare, state);
        let states = state_a as u32 | (state_b as u32) << 2 | (state_c as u32) << 4;
        let low = a as u32 | (b as u32) << 16;
        let high = c as u32 | states << 16;
        Self(low as u64 | (high as u64) << 32)
    }

    /// All legs alike, without pulses.
    #[inline]
    #[must_use]
    pub const fn at_rest(state: LegState) -> Self {
        Self::new([0; 3], [state; 3])
    }

    /// Compare values of phases a, b, c, in timer counts.
    #[inline]
    #[must_use]
    pub const fn compare(self) -> [u16; 3] {
        [self.0 as u16, (self.0 >> 16) as u16, (self.0 >> 32) as u16]
    }

    /// States of legs a, b, c.
    #[inline]
    #[must_use]
    pub const fn state(self) -> [LegState; 3] {
        let states = self.states() as i32;
        [
            LegState::from_word(Word(states & 3)),
            LegState::from_word(Word(states >> 2 & 3)),
            LegState::from_word(Word(states >> 4 & 3)),
        ]
    }

    /// States of legs a, b, c in two bits each, a's lowest: the place in a table of what a timer's output enables take.
    #[inline]
    #[must_use]
    pub const fn states(self) -> u16 {
        (self.0 >> 48) as u16
    }

    /// The word: compare values in 16 bits each from the lowest on, then [`states`](Self::states).
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        self.0
    }

    /// The legs of a word as [`to_bits`](Self::to_bits) gives it; of other words, what they read as.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }
}

impl Default for Legs {
    fn default() -> Self {
        Self::OFF
    }
}

impl core::fmt::Debug for Legs {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Legs")
            .field("compare", &self.compare())
            .field("state", &self.state())
            .finish()
    }
}

/// Why a drive tripped. Latched until `reset()`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Fault {
    /// Not tripped.
    #[default]
    None = 0,
    /// A current converter was at an end of its range: count 0, the largest count, or more.
    AdcRange = 1,
    /// A phase current exceeded the trip level.
    OverCurrent = 2,
    /// The Hall code was 000, 111 or above.
    Hall = 3,
    /// No Hall edge within the stall time-out while a current was demanded.
    Stall = 4,
    /// A calibrated current offset was too far from its nominal value.
    Offset = 5,
}

impl Fault {
    /// The word of the state that stands for this fault.
    #[inline]
    #[must_use]
    pub const fn word(self) -> Word {
        Word(self as i32)
    }

    /// The fault that a word of the state stands for; words that stand for none count as
    /// [`Fault::None`].
    #[inline]
    #[must_use]
    pub const fn from_word(word: Word) -> Self {
        match word.0 {
            1 => Self::AdcRange,
            2 => Self::OverCurrent,
            3 => Self::Hall,
            4 => Self::Stall,
            5 => Self::Offset,
            _ => Self::None,
        }
    }
}

/// What a drive is doing: the values of its state word `mode`.
pub mod mode {
    use crate::arith::Word;

    /// Current control.
    pub const RUN: Word = Word(0);
    /// Averaging the current offsets, all legs off.
    pub const CALIBRATE: Word = Word(1);
    /// Charging the bootstrap capacitors, all lower switches on.
    pub const PRECHARGE: Word = Word(2);
    /// Tripped, all legs off, until `reset()`.
    pub const TRIPPED: Word = Word(3);
}

/// How a result is rounded to its format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rounding {
    /// Towards minus infinity.
    Floor,
    /// To the nearest, ties towards plus infinity.
    RoundHalfUp,
}

/// The fixed-point format of a kind of signals (`current`, `voltage`, …), a coefficient or a table of
/// a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Name of the signals, coefficient or table.
    pub name: &'static str,
    /// Bits of two's complement that hold it: of signals, every one that outlives a call (within a
    /// step all are 32-bit words); of a coefficient or table, its values.
    pub storage_bits: u8,
    /// Fraction bits relative to the signals' base (negative: the ulp is larger than the base); of a
    /// coefficient, the bits that its products are shifted by.
    pub frac_bits: i8,
    /// Rounding of results into this format.
    pub rounding: Rounding,
    /// Equal parts of a turn that the table has; 0 for what is no table.
    pub segments: u8,
}

impl Format {
    /// A row of the format table.
    #[must_use]
    pub const fn new(
        name: &'static str,
        storage_bits: u8,
        frac_bits: i8,
        rounding: Rounding,
    ) -> Self {
        Self {
            name,
            storage_bits,
            frac_bits,
            rounding,
            segments: 0,
        }
    }

    /// The same for a table over so many equal parts of a turn.
    #[must_use]
    pub const fn over(self, segments: u8) -> Self {
        Self { segments, ..self }
    }
}
