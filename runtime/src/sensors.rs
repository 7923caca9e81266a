//! The current sensors of a drive: phases, signs, gains, and the leg that cannot be read.

use crate::arith::{Word, mul_round};

/// The phases of the first and the second current sensor. The third phase has the rest of their
/// currents, and its count in a [`Sample`](crate::Sample) is ignored, unless it has a [`ThirdSensor`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensedPhases {
    /// Phases a and b.
    Ab,
    /// Phases b and c.
    Bc,
    /// Phases c and a.
    Ca,
}

impl SensedPhases {
    /// What belongs to the first, the second and the third phase, of what belongs to a, b, c.
    #[inline]
    pub(crate) const fn of<T: Copy>(self, [a, b, c]: [T; 3]) -> [T; 3] {
        match self {
            Self::Ab => [a, b, c],
            Self::Bc => [b, c, a],
            Self::Ca => [c, a, b],
        }
    }

    /// Currents of phases a and b, from the sensed ones and that of the third phase.
    #[inline]
    pub(crate) fn a_and_b(self, [first, second]: [Word; 2], third: Word) -> [Word; 2] {
        match self {
            Self::Ab => [first, second],
            Self::Bc => [third, first],
            Self::Ca => [second, third],
        }
    }
}

/// Sign, gain and offset of a current sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensor {
    /// Whether counts fall with the current into the motor.
    pub adc_inverted: bool,
    /// ADC count at zero current before calibration.
    pub offset: u16,
    /// Least and greatest offset that calibration accepts, counts.
    pub offsets: [u16; 2],
    /// Amperes per count over those of the first sensor, 1/2 to 2, with
    /// [`RATIO_BITS`](Self::RATIO_BITS) fraction bits.
    pub ratio: i32,
}

impl Sensor {
    /// Fraction bits of [`ratio`](Self::ratio).
    pub const RATIO_BITS: u32 = 15;
    /// The ratio of a sensor with the first one's gain.
    pub const ALIKE: i32 = 0x8000;

    /// A phase current, of a count and an offset in words of current.
    #[inline]
    pub(crate) fn current(self, count: Word, offset: Word) -> Word {
        let current = if self.adc_inverted {
            offset - count
        } else {
            count - offset
        };
        if self.ratio == Self::ALIKE {
            current
        } else {
            mul_round(Word(self.ratio), current, Self::RATIO_BITS)
        }
    }
}

/// The third current sensor, and how a drive uses all three.
///
/// Sensors in the low legs show the currents of legs that are low for long enough. Of three, at least
/// two are: the leg that is high for longest, or is off, is the one that may not be read; its current
/// is the rest of the other two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThirdSensor {
    /// The sensor of the third phase.
    pub sensor: Sensor,
    /// For sensors in the low legs, the largest compare value of a leg that is read at the end of the
    /// period; none for sensors in the phases, which are read at any instant.
    pub readable: Option<u16>,
    /// Whether a command takes effect one period after the sample that it comes from.
    pub is_delayed: bool,
    /// Where all three are read, the largest sum of their currents without a fault, words of current.
    pub sum_tolerance: i32,
    /// Samples in a row with a larger sum, of those in which all three are read, that trip the drive;
    /// 0 for none.
    pub sum_samples: u16,
}

/// The current sensors of a drive, two or three.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensors {
    /// The phases of the first two.
    pub phases: SensedPhases,
    /// The second sensor, where it is not like the first, which [`Limits`](crate::Limits) have.
    pub second: Option<Sensor>,
    /// The third, if there is one.
    pub third: Option<ThirdSensor>,
}

impl Sensors {
    /// Two sensors alike, of phases a and b.
    pub const AB: Self = Self {
        phases: SensedPhases::Ab,
        second: None,
        third: None,
    };
}

/// The leg that a sample of three sensors in the low legs does not show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unread {
    First,
    Second,
    Third,
    /// All are read.
    None,
}

impl Unread {
    /// The leg with this number, of which two bits count: 0 to 2, or 3 for none.
    #[inline]
    pub(crate) const fn from_number(number: u8) -> Self {
        match number & 3 {
            0 => Self::First,
            1 => Self::Second,
            2 => Self::Third,
            _ => Self::None,
        }
    }

    /// The leg of a command that cannot be read at the end of its period: one that is off, or high for
    /// too long.
    #[inline]
    pub(crate) fn of([a, b, c]: [Option<u16>; 3], readable: u16) -> Self {
        let is_read = |on: Option<u16>| matches!(on, Some(on) if on <= readable);
        if !is_read(a) {
            Self::First
        } else if !is_read(b) {
            Self::Second
        } else if !is_read(c) {
            Self::Third
        } else {
            Self::None
        }
    }
}

/// Current of the phase that is not read.
#[inline]
pub(crate) fn third_of([first, second]: [Word; 2]) -> Word {
    -(first + second)
}
