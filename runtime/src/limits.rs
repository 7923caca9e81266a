//! Limits of a drive's samples: what a count, a current or a Hall code may be.
#![expect(
    clippy::inline_always,
    reason = "what three sensors need vanishes for two only where their constants are seen"
)]

use crate::arith::Word;
use crate::sensors::{SensedPhases, Sensor, Sensors, third_of};
use crate::{Fault, Sample};

/// Limits of a drive's samples, and its start-up times. Where the current sensors differ, sign and
/// offset here are those of the first: see [`Sensors`].
///
/// Words of current are ADC counts with [`current_bits`](Self::current_bits) fraction bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Largest count of the current ADC.
    pub adc_max: u16,
    /// Whether counts fall with the current into the motor.
    pub adc_inverted: bool,
    /// Fraction bits of words of current.
    pub current_bits: u32,
    /// ADC count at zero current before calibration.
    pub offset: u16,
    /// Least and greatest offset that calibration accepts, counts.
    pub offsets: [u16; 2],
    /// Trip level, words of current: a phase current above it trips.
    pub trip: i32,
    /// Least and greatest current over all counts and accepted offsets, words of current.
    pub currents: [i32; 2],
    /// Base-2 logarithm of the number of calibration samples.
    pub calibration_log2: u32,
    /// Control periods of bootstrap pre-charge; 0 for none.
    pub precharge_periods: u16,
    /// Stall time-out: control periods without a Hall edge under demand; 0 for no stall detection.
    pub stall_periods: i32,
    /// Hall sensors whose signal is inverted before anything else, as bits of the code: one of three
    /// sensors that stand 60 degrees apart. With them the codes are 001 to 110.
    pub hall_inverted: u8,
    /// Samples in a row with a disturbed Hall code that are bridged; 0 for none.
    pub hall_glitches: u16,
    /// Sector 1 to 6 by Hall code, four bits each, code 0 lowest; 0 of an invalid code.
    pub sectors: u32,
    /// Control periods of a sector at the speed up to which the short-circuited motor takes no more
    /// than the largest current; 0 if it never takes more.
    pub brake_periods: i32,
    /// Longest wait of a start for the rotor's angle, control periods: two sectors at the speed up to
    /// which control may begin without the angle; 0 for no wait.
    pub start_periods: u16,
    /// Least and greatest ADC count of the bus voltage without a fault; 0 and 65535 for none.
    pub bus_counts: [u16; 2],
}

impl Limits {
    /// Whether sums and words of these limits fit 32 bits and [`currents`](Self::currents) holds
    /// every current, so that no computation of the supervisor can overflow.
    #[must_use]
    pub const fn hold(&self, sensors: &Sensors) -> bool {
        let [first, second, third] = self.each_of(sensors);
        let (one, other) = (
            self.range(first),
            Self::wider(self.range(second), self.range(third)),
        );
        let [low, high] = Self::wider(one, other);
        let sum = (self.adc_max as i64) << (self.calibration_log2 & 15);
        // The phase that is not read has the negative sum of two currents; three are added, too.
        let word = 0x7fff_ffff;
        let addends = if sensors.third.is_some() { 3 } else { 2 };
        // A law takes its current, within the trip level, where it is that of a or b.
        let is_within = (matches!(sensors.phases, SensedPhases::Ab) && sensors.third.is_none())
            || (low <= -(self.trip as i64) && self.trip as i64 <= high);
        self.current_bits < 31
            && self.calibration_log2 < 16
            && self.adc_max > 1
            && self.includes(first)
            && self.includes(second)
            && self.includes(third)
            && Self::are_sound(sensors)
            && self.trip > 0
            && self.stall_periods >= 0
            && self.stall_periods < word as i32
            && self.brake_periods >= 0
            && self.brake_periods < word as i32
            && low == self.currents[0] as i64
            && high == self.currents[1] as i64
            && -addends * low <= word
            && addends * high <= word
            && sum <= word
            && is_within
    }

    /// The first, the second and the third sensor of a drive; in place of a third that is not there,
    /// the first.
    #[inline]
    pub(crate) const fn each_of(&self, sensors: &Sensors) -> [Sensor; 3] {
        let one = Sensor {
            adc_inverted: self.adc_inverted,
            offset: self.offset,
            offsets: self.offsets,
            ratio: Sensor::ALIKE,
        };
        let second = match sensors.second {
            None => one,
            Some(second) => second,
        };
        let third = match sensors.third {
            None => one,
            Some(third) => third.sensor,
        };
        [one, second, third]
    }

    /// Whether offset and tolerance of a sensor are in the ADC's range.
    const fn includes(&self, sensor: Sensor) -> bool {
        let [least, most] = sensor.offsets;
        least <= sensor.offset && sensor.offset <= most && most <= self.adc_max
    }

    /// Least and greatest current over all counts and accepted offsets of a sensor.
    const fn range(&self, sensor: Sensor) -> [i64; 2] {
        let [least, most] = sensor.offsets;
        let one = 1_i64 << (self.current_bits & 31);
        let (top, zero) = (self.adc_max as i64 * one, 0);
        let (low, high) = (least as i64 * one, most as i64 * one);
        let [low, high] = if sensor.adc_inverted {
            [low - top, high - zero]
        } else {
            [zero - high, top - low]
        };
        let ratio = sensor.ratio as i64;
        let half = 1 << (Sensor::RATIO_BITS - 1);
        // A ratio that is none is refused, whatever comes of it here.
        [
            low.wrapping_mul(ratio).wrapping_add(half) >> Sensor::RATIO_BITS,
            high.wrapping_mul(ratio).wrapping_add(half) >> Sensor::RATIO_BITS,
        ]
    }

    /// Whether ratios are in their range, and what is made of a third sensor is possible.
    const fn are_sound(sensors: &Sensors) -> bool {
        let second = match sensors.second {
            None => true,
            Some(second) => Self::has_ratio(second),
        };
        let third = match sensors.third {
            None => true,
            Some(third) => {
                Self::has_ratio(third.sensor)
                    && third.sum_tolerance >= 0
                    && matches!(sensors.phases, SensedPhases::Ab)
            }
        };
        second && third
    }

    const fn has_ratio(sensor: Sensor) -> bool {
        sensor.ratio >= Sensor::ALIKE / 2 && sensor.ratio <= 2 * Sensor::ALIKE
    }

    /// The least and the greatest of two ranges.
    const fn wider([low, high]: [i64; 2], [other_low, other_high]: [i64; 2]) -> [i64; 2] {
        [
            if low < other_low { low } else { other_low },
            if high > other_high { high } else { other_high },
        ]
    }

    /// Counts, none above the ADC's range.
    #[inline]
    pub(crate) fn within_range(&self, [first, second, third]: [u16; 3]) -> [Word; 3] {
        let within = |count: u16| Word::from(count).min(self.adc_max);
        [within(first), within(second), within(third)]
    }

    /// Currents of the sensors' phases in words of current; `offsets` are words of current, too.
    #[inline(always)]
    pub(crate) fn measured(
        &self,
        sensors: &Sensors,
        counts: [Word; 3],
        offsets: [Word; 3],
    ) -> [Word; 3] {
        let [first, second, third] = self.each_of(sensors);
        let [first_count, second_count, third_count] = counts;
        let [first_offset, second_offset, third_offset] = offsets;
        let bits = self.current_bits;
        [
            first.current(first_count << bits, first_offset),
            second.current(second_count << bits, second_offset),
            third.current(third_count << bits, third_offset),
        ]
    }

    /// The Hall code of a sample, of which no sensor is inverted any more.
    #[inline]
    pub(crate) const fn hall_of(&self, sample: &Sample) -> u8 {
        sample.hall ^ self.hall_inverted
    }

    /// What is wrong with a bus voltage of so many ADC counts.
    #[inline]
    #[must_use]
    pub const fn bus_fault(&self, counts: u16) -> Option<Fault> {
        let [least, most] = self.bus_counts;
        if counts > most {
            Some(Fault::OverVoltage)
        } else if counts < least {
            Some(Fault::UnderVoltage)
        } else {
            None
        }
    }

    /// Sector of a Hall code; 0 of an invalid one.
    pub(crate) const fn sector(&self, hall: u8) -> u32 {
        if is_hall_code(hall) {
            self.sectors.wrapping_shr(4 * hall as u32) & 7
        } else {
            0
        }
    }

    /// Whether an ADC is at an end of its range: count 0, the largest, or more.
    #[inline]
    pub(crate) fn is_at_end(&self, count: u16) -> bool {
        count == 0 || count >= self.adc_max
    }

    /// Whether a phase current is above the trip level: one that is sensed, or the third.
    #[inline]
    pub(crate) fn is_over(&self, [first, second]: [Word; 2]) -> bool {
        let third = third_of([first, second]);
        first.exceeds(self.trip) || second.exceeds(self.trip) || third.exceeds(self.trip)
    }
}

/// Whether the Hall code is valid: 001 to 110.
#[inline]
pub(crate) const fn is_hall_code(hall: u8) -> bool {
    matches!(hall, 1..=6)
}
