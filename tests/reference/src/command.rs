//! Commands of any modulator, as models, simulation and tests pass them on.

use hexagen::{Command, Intervals, LegState, Legs};

/// A command of pulses or of intervals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnyCommand {
    /// Pulses in the middle of the period.
    Legs(Legs),
    /// Intervals with states of their own.
    Intervals(Intervals),
}

impl AnyCommand {
    /// Compare values of legs a, b, c, or the ends of the first two intervals and 0; timer counts.
    #[inline]
    pub fn instants(self) -> [u16; 3] {
        let [first, second, third, ..] = self.words();
        [first, second, third]
    }

    /// States of the legs, two bits each: of the whole period, or in each interval.
    #[inline]
    pub fn states(self) -> [u16; 3] {
        let [.., first, second, third] = self.words();
        [first, second, third]
    }

    /// States of legs a, b, c, in the first interval.
    #[inline]
    pub fn state(self) -> [LegState; 3] {
        match self {
            Self::Legs(legs) => legs.state(),
            Self::Intervals(intervals) => intervals.state()[0],
        }
    }

    /// The pulses; none of intervals.
    pub fn legs(self) -> Option<Legs> {
        match self {
            Self::Legs(legs) => Some(legs),
            Self::Intervals(_) => None,
        }
    }

    /// Share of the period in which the upper switches of legs a, b, c are on; of a leg that is off for the whole period
    /// none. `timer_period`: counts of the period.
    pub fn duty(self, timer_period: u16) -> [Option<f64>; 3] {
        let share = |on: u16| f64::from(on.min(timer_period)) / f64::from(timer_period);
        self.on().map(|on| on.map(share))
    }
}

impl From<Legs> for AnyCommand {
    #[inline]
    fn from(legs: Legs) -> Self {
        Self::Legs(legs)
    }
}

impl From<Intervals> for AnyCommand {
    #[inline]
    fn from(intervals: Intervals) -> Self {
        Self::Intervals(intervals)
    }
}

/// All legs off.
impl Default for AnyCommand {
    fn default() -> Self {
        Self::Legs(Legs::OFF)
    }
}

impl Command for AnyCommand {
    #[inline]
    fn at_rest(state: LegState) -> Self {
        Self::Legs(Legs::all(state))
    }

    #[inline]
    fn on(self) -> [Option<u16>; 3] {
        match self {
            Self::Legs(legs) => legs.on(),
            Self::Intervals(intervals) => intervals.on(),
        }
    }

    #[inline]
    fn words(self) -> [u16; 6] {
        match self {
            Self::Legs(legs) => legs.words(),
            Self::Intervals(intervals) => intervals.words(),
        }
    }
}
