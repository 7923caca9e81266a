//! What a value is in emitted code, whatever the language.

use crate::ir::Word;

/// What a value is in emitted code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// A word.
    Word,
    /// A word that says what the drive is doing, one of the boundary's modes.
    Mode,
    /// A word that says what tripped the drive, one of the boundary's faults.
    Fault,
    /// True or false.
    Flag,
    /// A flag as a word that is not 0 where it holds: it does nothing but end the path, together with others.
    Alarm,
    /// The state of a leg: a word that does nothing but leave the step as such.
    Leg,
}

impl Shape {
    /// The shape of a state word.
    pub(super) fn of_state(word: &Word) -> Self {
        match word.name.as_str() {
            "mode" => Self::Mode,
            "fault" => Self::Fault,
            _ => Self::Word,
        }
    }

    /// What a number means in this shape, where it has a name.
    pub(super) fn code(self, number: i32) -> Option<Code> {
        Some(match (self, number) {
            (Self::Mode, 0) => Code::Run,
            (Self::Mode, 1) => Code::Calibrate,
            (Self::Mode, 2) => Code::Precharge,
            (Self::Mode, 3) => Code::Tripped,
            (Self::Fault, 0) => Code::NoFault,
            (Self::Fault, 1) => Code::AdcRange,
            (Self::Fault, 2) => Code::OverCurrent,
            (Self::Fault, 3) => Code::Hall,
            (Self::Fault, 4) => Code::Stall,
            (Self::Fault, 5) => Code::Offset,
            (Self::Leg, 0) => Code::Pulsed,
            (Self::Leg, 1) => Code::Low,
            (Self::Leg, _) => Code::Off,
            _ => return None,
        })
    }

    /// Whether a word holds it.
    pub(super) fn is_word(self) -> bool {
        matches!(self, Self::Word | Self::Mode | Self::Fault)
    }
}

/// A number with a name of the boundary: a mode, a fault, the state of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Code {
    /// Mode 0.
    Run,
    /// Mode 1.
    Calibrate,
    /// Mode 2.
    Precharge,
    /// Mode 3.
    Tripped,
    /// Fault 0.
    NoFault,
    /// Fault 1.
    AdcRange,
    /// Fault 2.
    OverCurrent,
    /// Fault 3.
    Hall,
    /// Fault 4.
    Stall,
    /// Fault 5.
    Offset,
    /// Leg 0.
    Pulsed,
    /// Leg 1.
    Low,
    /// Any other leg.
    Off,
}

/// A named value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Signal {
    /// Name.
    pub name: String,
    /// Word, flag or leg state.
    pub shape: Shape,
}
