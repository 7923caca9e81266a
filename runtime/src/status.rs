//! What a drive is doing, and what tripped it.

use core::fmt;

/// What a drive is doing.
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
}

impl Mode {
    /// The mode of a number; one that stands for none counts as [`Mode::Tripped`].
    #[inline]
    #[must_use]
    pub const fn from_number(number: i32) -> Self {
        match number {
            0 => Self::Run,
            1 => Self::Calibrate,
            2 => Self::Precharge,
            _ => Self::Tripped,
        }
    }
}

/// Why a drive tripped. Where one sample has several causes, the first of this list is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
#[repr(u8)]
pub enum Fault {
    /// A current ADC was at an end of its range: count 0, the largest count, or more.
    AdcRange = 1,
    /// The Hall code was none that three sensors can have: 000, 111 or above.
    Hall = 3,
    /// A phase current was above the trip level.
    OverCurrent = 2,
    /// No Hall edge within the stall time-out while a set-point was not 0.
    Stall = 4,
    /// A calibrated current offset was too far from its nominal value.
    Offset = 5,
}

impl Fault {
    /// The fault of a number; none of one that stands for none.
    #[inline]
    #[must_use]
    pub const fn from_number(number: i32) -> Option<Self> {
        match number {
            1 => Some(Self::AdcRange),
            2 => Some(Self::OverCurrent),
            3 => Some(Self::Hall),
            4 => Some(Self::Stall),
            5 => Some(Self::Offset),
            _ => None,
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::AdcRange => "a current ADC is at an end of its range",
            Self::OverCurrent => "a phase current is above the trip level",
            Self::Hall => "the Hall code is invalid",
            Self::Stall => "the rotor stands under demand",
            Self::Offset => "a calibrated current offset is too far from its nominal value",
        })
    }
}

impl core::error::Error for Fault {}

/// What a drive is doing and what tripped it: mode and fault of one instant, the end of the last
/// control period or of the last call of its control loop, and staleness as of the last period.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Status {
    /// What it is doing.
    pub mode: Mode,
    /// What tripped it, until `reset()`.
    pub fault: Option<Fault>,
    /// `v_bus: measured`: for 100 ms no call of `set_bus` took effect, so the controller goes by an
    /// old voltage; from the start to the first call by the nominal one. A warning, which trips
    /// nothing. Never with `v_bus: fixed`.
    pub bus_is_stale: bool,
}

impl Status {
    /// Whether currents are controlled: neither calibrating, pre-charging nor tripped.
    #[inline]
    #[must_use]
    pub const fn is_running(self) -> bool {
        matches!(self.mode, Mode::Run)
    }

    /// Mode and fault in one word, as the control loop publishes them.
    #[inline]
    pub(crate) const fn to_bits(mode: Mode, fault: Option<Fault>) -> i32 {
        mode as i32 | number(fault) << 8
    }

    /// What [`Status::to_bits`] made one word of.
    #[inline]
    pub(crate) const fn from_bits(bits: i32, bus_is_stale: bool) -> Self {
        Self {
            mode: Mode::from_number(bits & 0xff),
            fault: Fault::from_number(bits >> 8),
            bus_is_stale,
        }
    }
}

/// The number of a fault; 0 of none.
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

    #[test]
    fn every_status_survives_its_word() {
        for mode in [Mode::Run, Mode::Calibrate, Mode::Precharge, Mode::Tripped] {
            for number in 0..8 {
                let fault = Fault::from_number(number);
                let status = Status::from_bits(Status::to_bits(mode, fault), false);
                assert_eq!((status.mode, status.fault), (mode, fault));
            }
        }
        assert_eq!(Status::from_bits(0, false), Status::default());
    }

    #[test]
    fn a_fault_is_an_error_with_a_sentence() {
        let error: &dyn core::error::Error = &Fault::Hall;
        assert!(error.source().is_none());
        for number in 1..=5 {
            assert!(Fault::from_number(number).is_some_and(|fault| fault as i32 == number));
        }
    }
}
