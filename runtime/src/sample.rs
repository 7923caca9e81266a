//! Inputs of a control period.

use crate::arith::Word;

/// Measurements at the beginning of a control period, as the hardware gives them.
///
/// ADC counts of the phase currents, and the rotor's position: a Hall code or an electrical angle.
/// There is a count per phase; that of a phase without a sensor is ignored.
///
/// ```
/// use hexagen::Sample;
///
/// // Two current sensors and Hall sensors: code 101, 312 ticks of the edge timer after its edge.
/// let sample = Sample::with_hall([2048, 2100], 0b101).hall_ticks(312);
/// // Three current sensors and an encoder.
/// let turned = Sample::with_angle([2048, 2100], 0x4000_0000).third_current(1996);
/// assert_ne!(sample, turned);
/// // Sensors in phases b and c (`sensed_phases: bc`).
/// let of_b_and_c = Sample::with_hall([0, 2100], 0b101).third_current(1996);
/// assert_eq!(of_b_and_c.adc(), [0, 2100, 1996]);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    pub(crate) adc: [u16; 3],
    pub(crate) hall: u8,
    pub(crate) hall_ticks: u16,
    pub(crate) angle: u32,
}

impl Sample {
    /// ADC counts of the currents of phases a and b, which rise with the current into the motor
    /// (`adc_inverted: on`: fall), and the Hall code `Ha Hb Hc` with Ha in bit 2. Where one of the
    /// two phases has no sensor, any number may stand for its count, and
    /// [`third_current`](Self::third_current) adds the count of phase c. A drive with `hall_timer_clock`
    /// also needs [`hall_ticks`](Self::hall_ticks). Without them those counts are 0.
    ///
    /// Any code is accepted: one that Hall sensors cannot give (0, 7 and above) trips the drive.
    #[inline]
    #[must_use]
    pub const fn with_hall([adc_a, adc_b]: [u16; 2], hall: u8) -> Self {
        Self {
            adc: [adc_a, adc_b, 0],
            hall,
            hall_ticks: 0,
            angle: 0,
        }
    }

    /// The same with the angle of a sensor in place of a Hall code, 2^32 per turn of it, for drives with
    /// `rotor: angle`; their specification says what it has to do with the electrical angle. An angle
    /// of n bits is shifted left by 32 - n. It has no Hall code: a drive that needs one trips.
    #[inline]
    #[must_use]
    pub const fn with_angle([adc_a, adc_b]: [u16; 2], angle: u32) -> Self {
        Self {
            adc: [adc_a, adc_b, 0],
            hall: 0,
            hall_ticks: 0,
            angle,
        }
    }

    /// Timer ticks from the last Hall edge to this sample, rounded down, at most 65535, for drives
    /// with `hall_capture: timer`; the clock is `HALL_TIMER_HZ`.
    ///
    /// Code and ticks must belong together: latch both in the capture interrupt, or read the ticks,
    /// the code, and the ticks again, until the second count is not below the first.
    #[inline]
    #[must_use]
    pub const fn hall_ticks(self, ticks: u16) -> Self {
        Self {
            hall_ticks: ticks,
            ..self
        }
    }

    /// The ADC count of phase c, for drives with a current sensor there.
    #[inline]
    #[must_use]
    pub const fn third_current(self, adc_c: u16) -> Self {
        let [adc_a, adc_b, _] = self.adc;
        Self {
            adc: [adc_a, adc_b, adc_c],
            ..self
        }
    }

    /// ADC counts of phases a, b, c; ignored where there is no sensor.
    #[inline]
    #[must_use]
    pub const fn adc(&self) -> [u16; 3] {
        self.adc
    }

    /// The Hall code; 0 if the sample has an angle.
    #[inline]
    #[must_use]
    pub const fn hall(&self) -> u8 {
        self.hall
    }

    /// Ticks since the last Hall edge.
    #[inline]
    #[must_use]
    pub const fn ticks(&self) -> u16 {
        self.hall_ticks
    }

    /// The sensor's angle, 2^32 per turn; 0 if the sample has a Hall code.
    #[inline]
    #[must_use]
    pub const fn angle(&self) -> u32 {
        self.angle
    }
}

/// A sample that has passed the [`Supervisor`](crate::Supervisor), which alone makes one.
///
/// For any ADC counts, the currents lie in [`Limits::currents`](crate::Limits::currents).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checked {
    pub(crate) i: [Word; 2],
    pub(crate) hall: Word,
    /// Ticks, or of a drive with an angle sensor the electrical angle: one word, since the longer a
    /// checked sample is, the longer each step takes.
    pub(crate) timing: Word,
}

impl Checked {
    /// The same with the electrical angle of a sample that a sensor resolved
    /// ([`AngleSensor::resolve`](crate::AngleSensor::resolve)), for drives with an angle sensor.
    #[inline]
    #[must_use]
    pub const fn with_angle_of(self, sample: &Sample) -> Self {
        Self {
            timing: Word(sample.angle as i32),
            ..self
        }
    }

    /// Current of phase a into the motor, ADC counts with the drive's fraction bits.
    #[inline]
    #[must_use]
    pub const fn i_a(&self) -> Word {
        self.i[0]
    }

    /// Current of phase b, likewise.
    #[inline]
    #[must_use]
    pub const fn i_b(&self) -> Word {
        self.i[1]
    }

    /// The Hall code, 1 to 6, of an angle that of its sector; 0 only at rest, if it was invalid.
    #[inline]
    #[must_use]
    pub const fn hall(&self) -> Word {
        self.hall
    }

    /// Ticks since the last Hall edge, 0 to 65535; of a drive with an angle sensor without meaning.
    #[inline]
    #[must_use]
    pub const fn hall_ticks(&self) -> Word {
        self.timing
    }

    /// Electrical angle, bits of a word with 2^32 per turn, 0 where the EMF of phase a rises through 0;
    /// of a drive with Hall sensors without meaning.
    #[inline]
    #[must_use]
    pub const fn angle(&self) -> Word {
        self.timing
    }
}
