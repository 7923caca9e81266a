//! What a drive is doing, in one word that its control loop publishes and anyone may read.

use core::fmt;

use crate::arith::Word;
use crate::{Fault, mode};

/// What a drive is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Current control.
    #[default]
    Run,
    /// Averaging the current offsets, all legs off.
    Calibrate,
    /// Charging the bootstrap capacitors, all lower switches on.
    Precharge,
    /// Tripped, all legs off, until `reset()`.
    Tripped,
}

/// What a drive is doing and what tripped it, as of one instant: the end of the last control
/// period, or of the last call of its control loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    /// What it is doing.
    pub mode: Mode,
    /// What tripped it, or [`Fault::None`].
    pub fault: Fault,
    /// `v_bus: measured`: for 100 ms no call of `set_bus` took effect, so the controller goes by an old
    /// voltage; from the start to the first call by the nominal one. A warning, which trips nothing.
    /// Never with `v_bus: fixed`.
    pub bus_is_stale: bool,
}

impl Status {
    /// Whether currents are controlled: neither calibrating, pre-charging nor tripped.
    #[inline]
    #[must_use]
    pub fn is_running(self) -> bool {
        self.mode == Mode::Run
    }

    /// Mode and fault of the state as one word: a half each, as they lie side by side in the state
    /// of most drives, so that one load takes both.
    #[inline]
    #[must_use]
    pub fn word(mode: Word, fault: Word) -> Word {
        let (low, high) = (mode.to_u16() as u32, fault.to_u16() as u32);
        Word((low | (high << 16)) as i32)
    }

    /// What [`Status::word`] made one word of, with a bus voltage that is not stale.
    #[inline]
    #[must_use]
    pub fn from_word(word: Word) -> Self {
        let fault = word >> 16;
        let mode = match word - (fault << 16) {
            mode::RUN => Mode::Run,
            mode::CALIBRATE => Mode::Calibrate,
            mode::PRECHARGE => Mode::Precharge,
            _ => Mode::Tripped,
        };
        Self {
            mode,
            fault: Fault::from_word(fault),
            bus_is_stale: false,
        }
    }

    /// `Debug` of a drive or of one of its halves: its name and its status.
    ///
    /// # Errors
    /// Those of the formatter.
    pub fn debug(self, name: &str, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct(name)
            .field("mode", &self.mode)
            .field("fault", &self.fault)
            .field("bus_is_stale", &self.bus_is_stale)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::{Mode, Status};
    use crate::{Fault, mode};

    #[test]
    fn every_status_survives_its_word() {
        let modes = [
            (mode::RUN, Mode::Run),
            (mode::CALIBRATE, Mode::Calibrate),
            (mode::PRECHARGE, Mode::Precharge),
            (mode::TRIPPED, Mode::Tripped),
        ];
        for (word, mode) in modes {
            for fault in 0..8 {
                let fault = Fault::from_word(fault.into());
                let status = Status {
                    mode,
                    fault,
                    bus_is_stale: false,
                };
                assert_eq!(Status::from_word(Status::word(word, fault.word())), status);
            }
        }
        assert_eq!(Status::from_word(0.into()), Status::default());
    }
}
