//! From a drive's command to the registers of an STM32's advanced timer (TIM1, TIM8).
//!
//! The timer counts up and down (`CMS`), its channels are in PWM mode 1: the upper switch of leg a,
//! b, c (channel 1, 2, 3) is on while the counter is below its compare value, so around the
//! underflow. A period begins at the overflow, in the middle of the lower switch's time, which is
//! where the ADCs sample. `RCR` = 1 leaves one update event per period, and the board's program
//! starts the timer so that this one is the overflow's.
//!
//! Two kinds of registers carry a command, and they take effect by different events:
//!
//! | register | preloaded by | takes effect at |
//! |---|---|---|
//! | `CCR1` to `CCR3` | `OCxPE` | the update event |
//! | `CCER` (`CCxE`, `CCxNE`) | `CCPC` | the commutation event `COM`, which an update does not cause |
//!
//! Without `CCPC` enables take effect when they are written, in the middle of the period before.
//! With `CCPC` and `CCUS` a rising edge of the trigger input makes `COM`. So a second timer closes
//! the circle: the advanced timer's update (`TRGO`) resets it, and [`LEAD`] clocks before the next
//! update its compare output, the advanced timer's trigger input, rises. `COM` then comes at the
//! same place of every period, whatever the interrupt does, as long as the command was written by
//! then.
//!
//! `COM` comes before the update and not behind it, because then no upper switch is ever on when it
//! should not be. Before the update a leg that comes back from off still has its compare value 0,
//! so its lower switch comes first, [`LEAD`] clocks early. Behind the update its reference might be
//! high already: with `CCxE` alone it goes to the upper switch, without a dead time. A leg that
//! goes off loses its lower switch [`LEAD`] clocks early; its upper one, if it is on, stays on
//! until the reference falls or the update takes it away, and the lower one does not follow.
//!
//! What a leg's state asks of its two outputs, with `OSSR` and `OSSI` set (in RM0440 and RM0090 the
//! table of output control bits of complementary channels):
//!
//! | state | `CCxE`, `CCxNE` | compare | upper | lower |
//! |---|---|---|---|---|
//! | pulsed | 1, 1 | of the command | reference, dead time inserted | its complement, likewise |
//! | low | 1, 1 | 0 | low | high |
//! | off | 1, 0 | 0 | low: the reference never rises | driven low, `OSSR`'s off-state |
//!
//! Off keeps `CCxE`. With both enables at 0 the timer lets go of its pins, and the gates fall as
//! fast as pull-down resistors discharge them; so, both pins stay driven.
//!
//! A break input clears `MOE`; `OSSI` with `OISx` = 0 then drives all six pins low.
#![no_std]

mod dead_time;

pub use dead_time::{dead_time, is_sampled_at_update, specified_dead_time};
use hexagen::{LegState, Legs};

/// `CC1E`; those of channels 2 and 3 are four bits up each.
const ENABLE: u32 = 1;
/// `CC1NE`, likewise.
const ENABLE_COMPLEMENTARY: u32 = 1 << 2;

/// Clocks of the advanced timer from the commutation event to the update event: longer than two
/// timers take to trigger each other (some clocks each way), and short beside a period.
pub const LEAD: u16 = 64;

/// What a control period writes to the timer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outputs {
    /// `CCR1`, `CCR2`, `CCR3`.
    pub compare: [u16; 3],
    /// `CCER`: enables of channels 1 to 3, active high; channel 4 is not used.
    pub enables: u32,
}

/// The registers of a command: leg a is channel 1, b is 2, c is 3.
///
/// ```
/// use hexagen::{LegState, Legs};
/// use hexagen_stm32::outputs;
///
/// let legs = Legs::new([900, 0, 0], [LegState::Pulsed, LegState::Low, LegState::Off]);
/// let outputs = outputs(legs);
/// assert_eq!(outputs.compare, [900, 0, 0]);
/// assert_eq!(outputs.enables, 0x155);
/// ```
#[inline]
#[must_use]
pub const fn outputs(legs: Legs) -> Outputs {
    let ([a, b, c], [state_a, state_b, state_c]) = (legs.compare(), legs.state());
    Outputs {
        compare: [on(state_a, a), on(state_b, b), on(state_c, c)],
        enables: enables(state_a) | enables(state_b) << 4 | enables(state_c) << 8,
    }
}

/// The compare value: 0 of all legs that are not pulsed, whatever stands in the command.
const fn on(state: LegState, compare: u16) -> u16 {
    match state {
        LegState::Pulsed => compare,
        LegState::Low | LegState::Off => 0,
    }
}

/// The enables of channel 1.
const fn enables(state: LegState) -> u32 {
    match state {
        LegState::Pulsed | LegState::Low => ENABLE | ENABLE_COMPLEMENTARY,
        LegState::Off => ENABLE,
    }
}
