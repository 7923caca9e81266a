//! Commands of a control period to the inverter.

/// State of an inverter leg, for the whole period ([`Legs`]) or one of its intervals ([`Intervals`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u8)]
pub enum LegState {
    /// In `Legs`: both switches follow the timer channel (complementary outputs). In `Intervals`: the
    /// upper switch is on throughout the interval.
    Pulsed = 0,
    /// The lower switch is on throughout, the upper one off.
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
    /// All that a command holds, as a word of 64 bits. For verification.
    fn to_bits(self) -> u64;
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
        // As `packed`, which would take an instruction more here.
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
        unpacked(self.states())
    }

    /// States of legs a, b, c in two bits each, a's lowest: an index for a table of the timer's
    /// output enables.
    #[inline]
    #[must_use]
    pub const fn states(self) -> u16 {
        (self.0 >> 48) as u16
    }

    /// The word: from the lowest bit on, the three compare values in 16 bits each, then [`states`](Self::states).
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

    #[inline]
    fn to_bits(self) -> u64 {
        self.0
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

/// Three intervals of each PWM period with a state per leg each, for modulators that turn legs off and
/// on within a period. The inverter's timer has to change output modes and enables by compare events
/// ([guide](crate::guide::boards#legs-that-change-within-a-period)).
///
/// The first two end at an instant, 0 to `TIMER_PERIOD` counts behind the beginning of the PWM period,
/// the second not before the first; the third ends with the period. One count is 1/`TIMER_PERIOD` of the
/// PWM period: two clocks of a centre-aligned timer, whose count goes up and down. The third interval is a zero
/// vector: there a pulsed leg counts as low. The whole command is one 64-bit word, as that of [`Legs`].
///
/// ```
/// use hexagen::{Command, Intervals, LegState};
/// use LegState::{Low, Off, Pulsed};
///
/// let two = Intervals::new([900, 1500], [[Pulsed, Low, Off], [Pulsed, Off, Low], [Low; 3]]);
/// assert_eq!(two.state()[0], [Pulsed, Low, Off]);
/// assert_eq!(two.on(), [Some(1500), Some(0), Some(0)]);
/// // Ends 900 = 0x384, 1500 = 0x5dc; states c, b, a in two bits each: 0b10_01_00, 0b01_10_00, 0b01_01_01.
/// assert_eq!(two.to_bits(), 0x0015_1824_05dc_0384);
/// assert_eq!(Intervals::from_bits(two.to_bits()), two);
/// ```
#[derive(Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Intervals(u64);

impl Intervals {
    /// All legs off for the whole period: the safe command of a tripped drive.
    pub const OFF: Self = Self::all(LegState::Off);

    /// Ends of the first two intervals, timer counts, and states of legs a, b, c in each of the three. An
    /// end before the first makes the second interval empty.
    #[inline]
    #[must_use]
    pub const fn new(ends: [u16; 2], [first, second, third]: [[LegState; 3]; 3]) -> Self {
        Self::of_states(ends, [packed(first), packed(second), packed(third)])
    }

    /// Ends of the first two intervals, timer counts, and [`states`](Self::states): of each leg 0, 1 or 2 as
    /// of [`LegState`], 3 counts as 2; bits from 6 on have no effect.
    #[inline]
    #[must_use]
    pub const fn of_states([end, next_end]: [u16; 2], [one, two, three]: [u16; 3]) -> Self {
        let low = end as u32 | (next_end as u32) << 16;
        let high = one as u32 & 63 | (two as u32 & 63) << 8 | (three as u32 & 63) << 16;
        Self(low as u64 | (high as u64) << 32)
    }

    /// All legs in the same state for the whole period.
    #[inline]
    #[must_use]
    pub const fn all(state: LegState) -> Self {
        Self::new([0; 2], [[state; 3]; 3])
    }

    /// Ends of the first two intervals, timer counts from the beginning of the PWM period.
    #[inline]
    #[must_use]
    pub const fn ends(self) -> [u16; 2] {
        [self.0 as u16, (self.0 >> 16) as u16]
    }

    /// States of legs a, b, c in each interval.
    #[inline]
    #[must_use]
    pub const fn state(self) -> [[LegState; 3]; 3] {
        let [first, second, third] = self.states();
        [unpacked(first), unpacked(second), unpacked(third)]
    }

    /// States of legs a, b, c in two bits each, a's lowest, in each interval: indices for a table of
    /// the timer's output enables.
    #[inline]
    #[must_use]
    pub const fn states(self) -> [u16; 3] {
        let states = (self.0 >> 32) as u32;
        [
            (states & 63) as u16,
            (states >> 8 & 63) as u16,
            (states >> 16 & 63) as u16,
        ]
    }

    /// The word: from the lowest bit on, the two ends in 16 bits each, then the three [`states`](Self::states) in 8
    /// bits each.
    #[inline]
    #[must_use]
    pub const fn to_bits(self) -> u64 {
        self.0
    }

    /// The intervals with the bits of [`to_bits`](Self::to_bits); others have no effect.
    #[inline]
    #[must_use]
    pub const fn from_bits(bits: u64) -> Self {
        Self(bits & 0x003f_3f3f_ffff_ffff)
    }
}

impl Command for Intervals {
    #[inline]
    fn at_rest(state: LegState) -> Self {
        Self::all(state)
    }

    fn on(self) -> [Option<u16>; 3] {
        let [first, second] = self.ends();
        let lengths = [first, second.saturating_sub(first)];
        let [one, two, three] = self.state();
        let on = |one: LegState, two: LegState, three: LegState| {
            let of = |state: LegState, length: u16| {
                if state == LegState::Pulsed { length } else { 0 }
            };
            let is_off = one == LegState::Off && two == LegState::Off && three == LegState::Off;
            // The sum is at most the greater of the two ends.
            (!is_off).then_some(of(one, lengths[0]).wrapping_add(of(two, lengths[1])))
        };
        let ([a1, b1, c1], [a2, b2, c2], [a3, b3, c3]) = (one, two, three);
        [on(a1, a2, a3), on(b1, b2, b3), on(c1, c2, c3)]
    }

    #[inline]
    fn to_bits(self) -> u64 {
        self.0
    }
}

impl core::fmt::Debug for Intervals {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Intervals")
            .field("ends", &self.ends())
            .field("state", &self.state())
            .finish()
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Intervals {
    fn format(&self, f: defmt::Formatter<'_>) {
        defmt::write!(
            f,
            "Intervals {{ ends: {}, state: {} }}",
            self.ends(),
            self.state()
        );
    }
}

/// States of legs a, b, c in two bits each, a's lowest.
#[inline]
const fn packed([a, b, c]: [LegState; 3]) -> u16 {
    a as u16 | (b as u16) << 2 | (c as u16) << 4
}

/// The legs' states in a word of [`packed`].
#[inline]
const fn unpacked(states: u16) -> [LegState; 3] {
    let states = states as i32;
    [
        LegState::from_number(states & 3),
        LegState::from_number(states >> 2 & 3),
        LegState::from_number(states >> 4 & 3),
    ]
}
