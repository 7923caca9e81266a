//! Names and shapes of values in emitted code, whatever the language.

/// Shape of a value in emitted code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// A word.
    Word,
    /// True or false.
    Flag,
    /// The state of a leg.
    Leg,
}

/// The state of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leg {
    /// 0: both switches follow the timer.
    Pulsed,
    /// 1: the lower switch is on.
    Low,
    /// Any other number: both switches are off.
    Off,
}

impl Leg {
    /// The state by its number.
    pub(super) fn of(number: i32) -> Self {
        match number {
            0 => Self::Pulsed,
            1 => Self::Low,
            _ => Self::Off,
        }
    }
}

/// A named value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Signal {
    /// Name.
    pub name: String,
    /// Word, flag or leg state.
    pub shape: Shape,
}
