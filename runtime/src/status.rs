//! Mode and fault of a drive.

use core::fmt;

/// Operating mode of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[repr(u8)]
pub enum Mode {
    /// Current control.
    #[default]
    Run = 0,
    /// Averaging the current offsets, all legs off.
    Calibrate = 1,
    /// Charging the bootstrap capacitors, all lower switches on.
    Precharge = 2,
    /// Tripped, all legs off, until `reset()`.
    Tripped = 3,
    /// All legs off on purpose, until `resume()`.
    Coast = 4,
    /// Slowing the rotor down, until `resume()`.
    Brake = 5,
    /// All legs off until the rotor's angle is known, or the rotor known to be slow; control follows.
    Start = 6,
}

impl Mode {
    /// The mode with this number; [`Mode::Tripped`] for any other.
    #[inline]
    #[must_use]
    pub const fn from_number(number: i32) -> Self {
        match number {
            0 => Self::Run,
            1 => Self::Calibrate,
            2 => Self::Precharge,
            4 => Self::Coast,
            5 => Self::Brake,
            6 => Self::Start,
            _ => Self::Tripped,
        }
    }
}

/// Cause of a trip. If one control period has several, the first of this list is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[repr(u8)]
pub enum Fault {
    /// The bus voltage that `set_bus` told was above `over_voltage`.
    OverVoltage = 6,
    /// The bus voltage that `set_bus` told was below `under_voltage`.
    UnderVoltage = 7,
    /// The currents did not follow the voltages for the `residual_timeout` longer than they did: a dead
    /// current sensor, an open or exchanged phase, a sensor's wrong sign, or wrong motor data.
    Residual = 8,
    /// Over seven Hall edges in a row, or with an angle sensor seven periods, the rotor turned faster
    /// than `over_speed`: a shaft that is driven, a load that was lost, or a speed loop with wrong gains.
    OverSpeed = 10,
    /// A current ADC was at an end of its range: count 0, the largest count, or more.
    AdcRange = 1,
    /// The Hall code was one that no sensors give (000, 111 or above; with sensors 60 degrees apart 010
    /// and 101 or others), or disturbed in more samples in a row than `hall_glitches`.
    Hall = 3,
    /// A phase current was above the trip level.
    OverCurrent = 2,
    /// The currents of three sensors did not add up in so many samples in a row as the specification
    /// says, `current_sum_samples`: a dead or wrong sensor, or a current that leaves the motor.
    CurrentSum = 9,
    /// No Hall edge within the stall time-out while the set-point was not 0.
    Stall = 4,
    /// A calibrated current offset was too far from its nominal value.
    Offset = 5,
}

impl Fault {
    /// The fault with this number.
    #[inline]
    #[must_use]
    pub const fn from_number(number: i32) -> Option<Self> {
        match number {
            1 => Some(Self::AdcRange),
            2 => Some(Self::OverCurrent),
            3 => Some(Self::Hall),
            4 => Some(Self::Stall),
            5 => Some(Self::Offset),
            6 => Some(Self::OverVoltage),
            7 => Some(Self::UnderVoltage),
            8 => Some(Self::Residual),
            9 => Some(Self::CurrentSum),
            10 => Some(Self::OverSpeed),
            _ => None,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AdcRange => "a current ADC is at an end of its range",
            Self::OverCurrent => "a phase current is above the trip level",
            Self::OverVoltage => "the bus voltage is too high",
            Self::UnderVoltage => "the bus voltage is too low",
            Self::Residual => "the currents do not follow the voltages",
            Self::OverSpeed => "the rotor turns too fast",
            Self::Hall => "the Hall code is invalid",
            Self::CurrentSum => "the phase currents do not add up",
            Self::Stall => "the rotor is stalled",
            Self::Offset => "a calibrated current offset is too far from its nominal value",
        })
    }
}

impl core::error::Error for Fault {}

/// Status of a drive: mode and fault as of the end of the last control period or call of its
/// control loop, staleness as of the last period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Status {
    /// Operating mode.
    pub mode: Mode,
    /// Cause of the trip, until `reset()`.
    pub fault: Option<Fault>,
    /// `v_bus: measured`: no call of `set_bus` took effect for 100 ms, so the controller uses an
    /// old voltage; before the first call, the nominal one. A warning, which trips nothing. Never
    /// set with `v_bus: fixed`.
    pub bus_is_stale: bool,
    /// Samples with a disturbed Hall code that were bridged since the drive was made or reset, at most
    /// 32,767; 0 unless the specification has `hall_glitches`. A warning of noise on the wires.
    pub hall_glitches: u16,
}

impl Status {
    /// Whether currents are controlled: not in start-up, tripped, or off on purpose.
    #[inline]
    #[must_use]
    pub const fn is_running(self) -> bool {
        matches!(self.mode, Mode::Run)
    }

    /// Mode, fault and bridged samples in one word, as the control loop publishes them.
    #[inline]
    pub(crate) const fn to_bits(mode: Mode, fault: Option<Fault>, hall_glitches: u16) -> i32 {
        mode as i32 | number(fault) << 8 | (hall_glitches as i32) << 16
    }

    /// Inverse of [`Status::to_bits`].
    #[inline]
    pub(crate) const fn from_bits(bits: i32, bus_is_stale: bool) -> Self {
        Self {
            mode: Mode::from_number(bits & 0xff),
            fault: Fault::from_number(bits >> 8 & 0xff),
            bus_is_stale,
            hall_glitches: (bits >> 16) as u16,
        }
    }
}

/// The number of a fault; 0 for none.
#[inline]
pub(crate) const fn number(fault: Option<Fault>) -> i32 {
    match fault {
        Some(fault) => fault as i32,
        None => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::{Fault, Mode, Status};
    use crate::supervisor::MOST_GLITCHES;

    #[test]
    fn every_status_round_trips_through_its_word() {
        for number in 0..7 {
            let mode = Mode::from_number(number);
            assert_eq!(mode as i32, number);
            for number in 0..=10 {
                let fault = Fault::from_number(number);
                for glitches in [0, 1, MOST_GLITCHES] {
                    let bits = Status::to_bits(mode, fault, glitches);
                    let status = Status::from_bits(bits, false);
                    let read = (status.mode, status.fault, status.hall_glitches);
                    assert_eq!(read, (mode, fault, glitches));
                }
            }
        }
        assert_eq!(Status::from_bits(0, false), Status::default());
    }

    #[test]
    fn a_fault_has_an_error_message() {
        let error: &dyn core::error::Error = &Fault::Hall;
        assert!(error.source().is_none());
        for number in 1..=10 {
            assert!(Fault::from_number(number).is_some_and(|fault| fault as i32 == number));
        }
    }
}
