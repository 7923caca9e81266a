//! Commands of a control period to the inverter.

/// State of an inverter leg.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum LegState {
    /// Both switches follow the timer channel (complementary outputs).
    Pulsed = 0,
    /// The lower switch is on for the whole period, the upper one off.
    Low = 1,
    /// Both switches are off: the leg floats or its diodes conduct.
    #[default]
    Off = 2,
}

impl LegState {
    /// The state with this number: 0 pulsed, 1 low, else off.
    #[inline]
    #[must_use]
    pub const fn from_number(number: i32) -> Self {
        match number {
            0 => Self::Pulsed,
            1 => Self::Low,
            _ => Self::Off,
        }
    }
}

/// Command of one control period. At rest, all legs are in the same state.
pub trait Command: Copy + 'static {
    /// The command that keeps all legs in one state for the whole period, without pulses.
    fn at_rest(state: LegState) -> Self;
    /// Timer counts for which the upper switches of legs a, b, c are on; `None` for a leg that is
    /// off for the whole period.
    fn on(self) -> [Option<u16>; 3];
}

/// Compare values for a centre-aligned timer and a state per leg.
///
/// A compare value is the time for which the upper switch is on, timer counts from 0 to the timer's
/// period; 0 for a leg that is not pulsed. The whole command is one 64-bit word, which functions
/// return in two registers of a small core.
///
/// ```
/// use hexagen::{LegState, Legs};
///
/// let legs = Legs::new([900, 450, 0], [LegState::Pulsed, LegState::Pulsed, LegState::Off]);
/// assert_eq!(legs.compare(), [900, 450, 0]);
/// assert_eq!(legs.state()[2], LegState::Off);
/// ```
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Legs(u64);

impl Legs {
    /// All legs off: the safe command of a tripped drive.
    pub const OFF: Self = Self::all(LegState::Off);
    /// All lower switches on: charges the bootstrap capacitors.
    pub const LOW: Self = Self::all(LegState::Low);

    /// Compare values and states of legs a, b, c.
    #[inline]
    #[must_use]
    pub const fn new(compare: [u16; 3], state: [LegState; 3]) -> Self {
        let ([a, b, c], [state_a, state_b, state_c]) = (compare, state);
        let states = state_a as u32 | (state_b as u32) << 2 | (state_c as u32) << 4;
        let low = a as u32 | (b as u32) << 16;
        let high = c as u32 | states << 16;
        Self(low as u64 | (high as u64) << 32)
    }

    /// All legs in the same state, without pulses.
    #[inline]
    #[must_use]
    pub const fn all(state: LegState) -> Self {
        Self::new([0; 3], [state; 3])
    }

    /// Compare values of legs a, b, c, timer counts.
    #[inline]
    #[must_use]
    pub const fn compare(self) -> [u16; 3] {
        [self.0 as u16, (self.0 >> 16) as u16, (self.0 >> 32) as u16]
    }

    /// States of legs a, b, c.
    #[inline]
    #[must_use]
    pub const fn state(self) -> [LegState; 3] {
        let states = self.states() as i32;
        [
            LegState::from_number(states & 3),
            LegState::from_number(states >> 2 & 3),
            LegState::from_number(states >> 4 & 3),
        ]
    }

    /// States of legs a, b, c in two bits each, a's lowest: an index for a table of the timer's
    /// output enables.
    #[inline]
    #[must_use]
    pub const fn states(self) -> u16 {
        (self.0 >> 48) as u16
    }

    /// The word: compare values in 16 bits each from the lowest on, then [`states`](Self::states).
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        self.0
    }

    /// The legs with the bits of [`to_bits`](Self::to_bits).
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits)
    }
}

impl Command for Legs {
    #[inline]
    fn at_rest(state: LegState) -> Self {
        Self::all(state)
    }

    #[inline]
    fn on(self) -> [Option<u16>; 3] {
        let ([a, b, c], [state_a, state_b, state_c]) = (self.compare(), self.state());
        let on = |state, compare| match state {
            LegState::Pulsed => Some(compare),
            LegState::Low => Some(0),
            LegState::Off => None,
        };
        [on(state_a, a), on(state_b, b), on(state_c, c)]
    }
}

impl Default for Legs {
    fn default() -> Self {
        Self::OFF
    }
}

impl core::fmt::Debug for Legs {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Legs")
            .field("compare", &self.compare())
            .field("state", &self.state())
            .finish()
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Legs {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(
            f,
            "Legs {{ compare: {}, state: {} }}",
            self.compare(),
            self.state()
        );
    }
}

/// Up to three intervals of one period with a state per leg each, for modulators that turn legs off
/// and on within a period. Inverters need output enables that change by a compare event.
///
/// Instants are timer counts from the beginning of the period, in ascending order. A pulsed leg has
/// its upper switch on for the whole interval.
///
/// ```
/// use hexagen::{Command, Intervals, LegState};
/// use LegState::{Low, Off, Pulsed};
///
/// let two = Intervals::new([900, 1500, 1800], [[Pulsed, Low, Off], [Low; 3], [Pulsed, Off, Off]]);
/// assert_eq!(two.state()[0], [Pulsed, Low, Off]);
/// assert_eq!(two.on(), [Some(1200), Some(0), Some(0)]);
/// // A descending instant counts as the one before.
/// assert_eq!(Intervals::new([900, 100, 0], [[Off; 3]; 3]).ends(), [900; 3]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Intervals {
    ends: [u16; 3],
    state: [[LegState; 3]; 3],
}

impl Intervals {
    /// All legs off for the whole period: the safe command of a tripped drive.
    pub const OFF: Self = Self::new([0, 0, u16::MAX], [[LegState::Off; 3]; 3]);

    /// Ends of the intervals (the third at or after the end of the period), and states of legs a,
    /// b, c in each.
    #[inline]
    #[must_use]
    pub const fn new([first, second, third]: [u16; 3], state: [[LegState; 3]; 3]) -> Self {
        let second = if second < first { first } else { second };
        let third = if third < second { second } else { third };
        Self {
            ends: [first, second, third],
            state,
        }
    }

    /// Ends of the intervals, timer counts from the beginning of the period.
    #[inline]
    #[must_use]
    pub const fn ends(self) -> [u16; 3] {
        self.ends
    }

    /// States of legs a, b, c in each interval.
    #[inline]
    #[must_use]
    pub const fn state(self) -> [[LegState; 3]; 3] {
        self.state
    }
}

impl Command for Intervals {
    #[inline]
    fn at_rest(state: LegState) -> Self {
        Self::new([0, 0, u16::MAX], [[state; 3]; 3])
    }

    fn on(self) -> [Option<u16>; 3] {
        let [first, second, third] = self.ends;
        let lengths = [
            first,
            second.wrapping_sub(first),
            third.wrapping_sub(second),
        ];
        let [one, two, three] = self.state;
        let on = |[one, two, three]: [LegState; 3]| {
            let states = [one, two, three];
            let is_off = states.iter().all(|&state| state == LegState::Off);
            let pulsed = states.iter().zip(lengths);
            let pulsed = pulsed.filter(|(state, _)| **state == LegState::Pulsed);
            // The sum is at most the third instant.
            let sum = pulsed.fold(0_u16, |sum, (_, length)| sum.wrapping_add(length));
            (!is_off).then_some(sum)
        };
        let ([a1, b1, c1], [a2, b2, c2], [a3, b3, c3]) = (one, two, three);
        [on([a1, a2, a3]), on([b1, b2, b3]), on([c1, c2, c3])]
    }
}
