//! Where the phase currents are measured, and how long a leg must be low for it.

use super::words::words;
use super::{CommonMode, InverterSpec, Spec};
use crate::diagnostics::engineering;

words! {
    /// Which phases have a current sensor.
    pub enum SensedPhases {
        "ab" = Ab: "a and b",
        "bc" = Bc: "b and c",
        "ca" = Ca: "c and a",
        "abc" = Abc: "all three",
    }
}

impl SensedPhases {
    /// The phases with a sensor, 0 to 2 for a to c, in the order in which samples and lists name them.
    pub fn phases(self) -> &'static [usize] {
        match self {
            Self::Ab => &[0, 1],
            Self::Bc => &[1, 2],
            Self::Ca => &[2, 0],
            Self::Abc => &[0, 1, 2],
        }
    }
}

/// Words of `current_sensing`.
pub const IN_PHASE: &str = "in_phase";
pub const LOW_SIDE: &str = "low_side";

/// Where the sensors are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CurrentSensing {
    /// In the phase: every current can be read at any instant.
    InPhase,
    /// In the low leg: a current can be read while its leg's lower switch is on.
    LowSide(SensingTimes),
}

impl CurrentSensing {
    /// What the sensors need; none where they are in the phases.
    pub fn times(self) -> Option<SensingTimes> {
        match self {
            Self::InPhase => None,
            Self::LowSide(times) => Some(times),
        }
    }
}

/// When the currents of three sensors do not add up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentSum {
    /// Largest sum without a fault, ampere.
    pub tolerance: f64,
    /// Samples in a row with a larger one that are a fault.
    pub samples: u32,
}

/// What a sensor in the low leg needs, second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensingTimes {
    /// Time from the lower switch's turning on until its current can be sampled.
    pub settling: f64,
    /// Time from the sampling instant for which a converter's input must stay.
    pub aperture: f64,
    /// Time from a conversion to the next one of the same ADC.
    pub conversion: f64,
    /// Converters that sample different phases at once.
    pub converters: u32,
    /// Time from the sampling instant to the timer's turning point; negative behind it.
    pub lead: f64,
}

/// Fraction bits of the ratio of two sensors' gains.
pub const RATIO_BITS: u32 = 15;

/// A sensor of a phase current.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentSensor {
    /// Ampere per count; negative for inverting amplifiers.
    pub gain: f64,
    /// Count at zero current.
    pub offset: u32,
}

/// For how long a leg must be commanded low around the turning point at which control periods begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensingWindow {
    /// Before it, in the period that ends: dead time, settling and lead, second.
    pub before: f64,
    /// Behind it, in the period that begins: aperture and further conversions less the lead, second.
    pub after: f64,
}

impl InverterSpec {
    /// All current sensors, in the order of [`SensedPhases::phases`].
    pub fn sensors(&self) -> Vec<CurrentSensor> {
        let first = CurrentSensor {
            gain: self.adc_gain,
            offset: self.adc_offset,
        };
        let others = self.other_sensors.iter().copied();
        std::iter::once(first).chain(others).collect()
    }

    /// Greatest current of either sign that the first sensor shows, ampere.
    pub fn shown_current(&self) -> f64 {
        let converter = self.adc_gain.abs() * f64::from(1_u32 << self.adc_bits) / 2.0;
        self.amplifier_reach
            .map_or(converter, |reach| reach.min(converter))
    }

    /// Gain of a sensor over that of the first, with [`RATIO_BITS`].
    pub fn ratio(&self, sensor: CurrentSensor) -> i32 {
        let ratio = sensor.gain.abs() / self.adc_gain.abs();
        (ratio * f64::from(1 << RATIO_BITS)).round() as i32
    }

    /// Period of the PWM, second.
    pub fn pwm_period(&self) -> f64 {
        self.t_s / f64::from(self.pwm_per_control)
    }

    /// Frequency of the PWM at a control period of `t_s`, hertz.
    pub fn pwm_frequency(&self, t_s: f64) -> f64 {
        f64::from(self.pwm_per_control) / t_s
    }

    /// Time from the turning point at which a control period begins to the sampling instant, second; negative
    /// before it. With sensors in the low legs it is stated, or by rule as here where it is felt. Each edge of a leg
    /// comes late by the dead time or not at all, whichever way its current flows, so the middle of its pulses, at which
    /// the sample is the mean of the current, comes half of it late. A drive without computation delay samples before:
    /// its command acts from the turning point on.
    pub fn sampling_delay(&self, delay: u32) -> f64 {
        match self.current_sensing {
            CurrentSensing::InPhase if delay == 0 => 0.0,
            CurrentSensing::InPhase => self.dead_time / 2.0,
            CurrentSensing::LowSide(times) => -times.lead,
        }
    }

    /// For how long a leg that is sampled must be low; none with sensors in the phases.
    pub fn window(&self) -> Option<SensingWindow> {
        match self.current_sensing {
            CurrentSensing::InPhase => None,
            CurrentSensing::LowSide(times) => {
                let phases = self.sensed_phases.phases().len();
                Some(times.window(self.dead_time, phases))
            }
        }
    }

    /// Largest compare value of a leg that is sampled at both ends of a period: with more counts its lower switch
    /// would be on for too short a time. Pulses are centred, so that half of a leg's low time lies behind the
    /// turning point with which its period begins, and half before the one with which it ends.
    pub fn readable_top(&self) -> u32 {
        let window = self.window();
        let half = window.map_or(0.0, |window| window.before.max(window.after));
        self.counts_less(half).min(self.largest_compare())
    }

    /// Largest compare value of the leg that is high for longest. Of three sensors its own may be left unread at the
    /// end of the period; at the beginning it is read, if another leg is the highest of the period before.
    pub fn highest_top(&self) -> u32 {
        match (self.sensed_phases, self.window()) {
            (SensedPhases::Abc, Some(window)) => {
                self.counts_less(window.after).min(self.largest_compare())
            }
            _ => self.readable_top(),
        }
    }

    /// Largest compare value of a leg that is sampled at the end of its period; none with sensors in the phases.
    pub fn readable_at_end(&self) -> Option<u32> {
        self.window().map(|window| self.counts_less(window.before))
    }

    /// Largest difference of the compare values of three pulsed legs: centred ones leave as much below as above.
    pub fn reach(&self, common_mode: CommonMode) -> u32 {
        match common_mode {
            CommonMode::Centred => 2 * self.readable_top() - self.timer_period,
            CommonMode::Readable | CommonMode::ClampedLow => self.highest_top(),
        }
    }

    /// Largest compare value of any leg: `timer_period`, less what `minimum_low_time` takes.
    pub fn largest_compare(&self) -> u32 {
        self.counts_less(self.minimum_low_time / 2.0)
    }

    /// The compare value at which a leg is low for so long on either side of the turning point.
    fn counts_less(&self, half_low: f64) -> u32 {
        let counts = low_counts(half_low, self.pwm_period(), self.timer_period);
        self.timer_period.saturating_sub(counts)
    }
}

impl Spec {
    /// When currents are sampled, for people; none at the turning point of the timer, with which the period begins.
    pub fn sampling_instant(&self) -> Option<String> {
        let delay = self.inverter.sampling_delay(self.controller.common().delay);
        if delay == 0.0 {
            return None;
        }
        let time = engineering(delay.abs(), "s");
        let is_half = delay == self.inverter.dead_time / 2.0;
        let half = if is_half { " (half the dead time)" } else { "" };
        let side = if delay > 0.0 { "behind" } else { "before" };
        let begin = if self.controller.has_intervals() {
            "beginning of the period"
        } else {
            "turning point of the timer"
        };
        Some(format!("{time}{half} {side} the {begin}"))
    }

    /// Largest difference of two legs' compare values; without a common mode one of them is low throughout.
    pub fn reach(&self) -> u32 {
        match self.controller.common_mode() {
            Some(common_mode) => self.inverter.reach(common_mode),
            None => self.inverter.readable_top(),
        }
    }

    /// The same as a share of the bus voltage.
    pub fn reach_share(&self) -> f64 {
        f64::from(self.reach()) / f64::from(self.inverter.timer_period)
    }
}

impl SensingTimes {
    /// Mean instant of the conversions of so many phases behind the first, second.
    pub fn mean_of_conversions(self, phases: usize) -> f64 {
        let phases = phases as u32;
        let waits = (0..phases).map(|place| f64::from(place / self.converters));
        waits.sum::<f64>() / f64::from(phases) * self.conversion
    }

    /// The window of so many phases.
    pub fn window(self, dead_time: f64, phases: usize) -> SensingWindow {
        let further = f64::from((phases as u32).div_ceil(self.converters) - 1);
        let after = self.aperture + further * self.conversion - self.lead;
        SensingWindow {
            before: dead_time + self.settling + self.lead,
            after: after.max(0.0),
        }
    }
}

/// Whole counts of a timer that counts to `timer_period` in half of `pwm_period`, not fewer than `time`; a time
/// that is whole but for its rounding is that number.
pub(super) fn low_counts(time: f64, pwm_period: f64, timer_period: u32) -> u32 {
    let counts = time / (pwm_period / 2.0) * f64::from(timer_period);
    (counts - 1e-6).ceil().max(0.0) as u32
}
