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
        match self {
            Self::Legs(legs) => legs.compare(),
            Self::Intervals(intervals) => {
                let [first, second] = intervals.ends();
                [first, second, 0]
            }
        }
    }

    /// States of the legs, two bits each: of the whole period and two zeros, or in each interval.
    #[inline]
    pub fn states(self) -> [u16; 3] {
        match self {
            Self::Legs(legs) => [legs.states(), 0, 0],
            Self::Intervals(intervals) => intervals.states(),
        }
    }

    /// Pulses or intervals with these bits.
    #[inline]
    pub fn from_bits(bits: u64, has_intervals: bool) -> Self {
        if has_intervals {
            Intervals::from_bits(bits).into()
        } else {
            Legs::from_bits(bits).into()
        }
    }

    /// Its words by name, to show where two commands differ.
    pub fn named_words(self) -> Vec<(&'static str, u16)> {
        match self {
            Self::Legs(legs) => {
                let [a, b, c] = legs.compare();
                let states = legs.states();
                vec![
                    ("compare_a", a),
                    ("compare_b", b),
                    ("compare_c", c),
                    ("states", states),
                ]
            }
            Self::Intervals(intervals) => {
                let ([first, second], [one, two, three]) = (intervals.ends(), intervals.states());
                let ends = [("end_1", first), ("end_2", second)];
                let states = [("states_1", one), ("states_2", two), ("states_3", three)];
                ends.into_iter().chain(states).collect()
            }
        }
    }

    /// States of legs a, b, c, in the first interval.
    #[inline]
    pub fn state(self) -> [LegState; 3] {
        match self {
            Self::Legs(legs) => legs.state(),
            Self::Intervals(intervals) => intervals.state()[0],
        }
    }

    /// All legs in one state for the whole period, as pulses or as intervals.
    #[inline]
    pub fn all(state: LegState, has_intervals: bool) -> Self {
        if has_intervals {
            Intervals::all(state).into()
        } else {
            Legs::all(state).into()
        }
    }

    /// How many of [`Self::instants`] mean something.
    pub fn instant_count(self) -> usize {
        match self {
            Self::Legs(_) => 3,
            Self::Intervals(_) => 2,
        }
    }

    /// Timer counts for which legs a, b, c are off. `timer_period`: counts of the period.
    pub fn off(self, timer_period: u16) -> [u16; 3] {
        let (states, lengths) = match self {
            Self::Legs(legs) => ([legs.state(); 3], [timer_period, 0, 0]),
            Self::Intervals(intervals) => {
                let [first, second] = intervals.ends();
                let lengths = [
                    first,
                    second.saturating_sub(first),
                    timer_period.saturating_sub(second),
                ];
                (intervals.state(), lengths)
            }
        };
        [0, 1, 2].map(|leg| {
            let intervals = states.iter().zip(lengths);
            let off = intervals.filter(|(legs, _)| legs[leg] == LegState::Off);
            off.map(|(_, length)| length).sum()
        })
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
        Self::all(state, false)
    }

    #[inline]
    fn on(self) -> [Option<u16>; 3] {
        match self {
            Self::Legs(legs) => legs.on(),
            Self::Intervals(intervals) => intervals.on(),
        }
    }

    #[inline]
    fn to_bits(self) -> u64 {
        match self {
            Self::Legs(legs) => legs.to_bits(),
            Self::Intervals(intervals) => intervals.to_bits(),
        }
    }
}
