//! What a command does on an STM32's advanced timer is what it does in the laboratory's inverter.
//!
//! The timer's output stage is simulated here from the reference manuals (RM0440 chapter 28, RM0090
//! chapter 17), clock by clock: counter, preload registers and their two events, dead-time
//! generator, and the table of output control bits.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{Gate, Gates};
use hexagen_stm32::{Outputs, outputs};

/// `ARR`: a period has twice as many clocks.
const ARR: u16 = 50;
const PERIOD: u16 = 2 * ARR;

/// One channel behind its reference: rising edges of either output are late by the dead time.
#[derive(Clone, Copy, Default)]
struct DeadTimeGenerator {
    reference: bool,
    /// Clocks since the reference changed.
    since: u16,
}

impl DeadTimeGenerator {
    /// Both outputs, as the two enables leave them: only with both is a dead time inserted.
    fn clock(&mut self, reference: bool, dead_time: u16, enables: u32) -> (bool, bool) {
        self.since = if reference == self.reference {
            self.since.saturating_add(1)
        } else {
            0
        };
        self.reference = reference;
        let is_over = self.since >= dead_time;
        match enables & 5 {
            // OSSR: what is not enabled is driven to its inactive level.
            0b001 => (reference, false),
            0b100 => (false, !reference),
            0b101 => (reference && is_over, !reference && is_over),
            _ => (false, false),
        }
    }
}

/// The output stage of an advanced timer in centre-aligned mode, from one overflow to the next.
struct Timer {
    dead_time: u16,
    /// Clocks from the update event to the commutation event.
    commutation: u16,
    compare: [u16; 3],
    enables: u32,
    preloaded: Outputs,
    channels: [DeadTimeGenerator; 3],
}

impl Timer {
    fn new(dead_time: u16, commutation: u16) -> Self {
        let preloaded = outputs(Legs::OFF);
        Self {
            dead_time,
            commutation,
            compare: preloaded.compare,
            enables: preloaded.enables,
            preloaded,
            channels: [DeadTimeGenerator {
                reference: false,
                since: u16::MAX,
            }; 3],
        }
    }

    /// The pins at a clock of the period, which begins at the overflow with its update event.
    fn clock(&mut self, clock: u16) -> [(bool, bool); 3] {
        if clock == 0 {
            self.compare = self.preloaded.compare;
        }
        if clock == self.commutation {
            self.enables = self.preloaded.enables;
        }
        let counts_down = clock < ARR;
        let counter = if counts_down {
            ARR - clock
        } else {
            clock - ARR
        };
        let mut pins = [(false, false); 3];
        for (leg, pin) in pins.iter_mut().enumerate() {
            // PWM mode 1: counting down inactive while the counter is above, counting up active
            // while it is below.
            let compare = self.compare[leg];
            let reference = if counts_down {
                counter <= compare && compare != 0
            } else {
                counter < compare
            };
            let enables = self.enables >> (4 * leg);
            *pin = self.channels[leg].clock(reference, self.dead_time, enables);
        }
        pins
    }
}

fn gate((upper, lower): (bool, bool)) -> Gate {
    assert!(!(upper && lower), "both switches of a leg are on");
    match (upper, lower) {
        (true, _) => Gate::Upper,
        (_, true) => Gate::Lower,
        _ => Gate::Off,
    }
}

/// Runs commands, each of which takes effect at the update event after it was written, on both;
/// returns at how many clocks they differed.
fn differences(dead_time: u16, commutation: u16, commands: &[Legs]) -> usize {
    let mut timer = Timer::new(dead_time, commutation);
    let mut inverter = Gates::new(f64::from(dead_time));
    let mut count = 0;
    let mut previous = Legs::OFF;
    for &command in commands {
        timer.preloaded = outputs(command);
        inverter.begin(command, ARR, f64::from(PERIOD));
        for clock in 0..PERIOD {
            inverter.advance_to(f64::from(clock) + 0.25);
            let (pins, ideal) = (timer.clock(clock), inverter.state());
            for leg in 0..3 {
                let is = gate(pins[leg]);
                if is == ideal[leg] {
                    continue;
                }
                // Until the commutation event a leg that turns off may hold its lower switch, and
                // one that comes from off may lack it; nothing else may differ.
                let (was, wanted) = (previous.state()[leg], command.state()[leg]);
                let turns = (was == LegState::Off) != (wanted == LegState::Off);
                let harmless = matches!(
                    (is, ideal[leg]),
                    (Gate::Lower, Gate::Off) | (Gate::Off, Gate::Lower)
                );
                assert!(
                    turns && harmless && clock < commutation,
                    "leg {leg}, clock {clock}: {is:?} for {:?}; {previous:?}, then {command:?}",
                    ideal[leg]
                );
                count += 1;
            }
        }
        inverter.end(f64::from(PERIOD));
        previous = command;
    }
    count
}

/// Commands of all kinds, the ends of the compare values often among them.
fn commands(seed: u64, number: usize) -> Vec<Legs> {
    let mut random = fastrand::Rng::with_seed(seed);
    let leg = |random: &mut fastrand::Rng| match random.u8(0..6) {
        0 => (0, LegState::Off),
        1 => (0, LegState::Low),
        2 => (0, LegState::Pulsed),
        3 => (ARR, LegState::Pulsed),
        4 => (ARR - random.u16(0..6), LegState::Pulsed),
        _ => (random.u16(0..=ARR), LegState::Pulsed),
    };
    let legs = |random: &mut fastrand::Rng| {
        let [a, b, c] = [leg(random), leg(random), leg(random)];
        Legs::new([a.0, b.0, c.0], [a.1, b.1, c.1])
    };
    (0..number).map(|_| legs(&mut random)).collect()
}

#[test]
fn a_command_does_on_the_timer_what_it_does_in_the_inverter() {
    for dead_time in [0, 1, 4, 9] {
        let differing = differences(dead_time, 0, &commands(u64::from(dead_time), 20_000));
        assert_eq!(differing, 0, "dead time {dead_time}");
    }
}

#[test]
fn a_commutation_event_within_the_dead_time_delays_lower_switches_alone() {
    // A leg that comes from off meets the event late: its lower switch, for these clocks.
    assert!(differences(9, 6, &commands(1, 20_000)) > 0);
}

#[test]
fn within_the_dead_time_a_leg_goes_from_full_duty_to_off_at_once() {
    let full = Legs::new([ARR; 3], [LegState::Pulsed; 3]);
    assert_eq!(differences(9, 6, &[full, full, Legs::OFF]), 0);
    // Later, the lower switch is on in between.
    assert!(differences(9, 12, &[full, full, Legs::OFF]) > 0);
}

#[test]
fn off_legs_ignore_what_stands_in_their_compare_value() {
    let off = Legs::new([ARR; 3], [LegState::Off; 3]);
    assert_eq!(outputs(off), outputs(Legs::OFF));
    assert_eq!(differences(0, 0, &[off, Legs::LOW, off]), 0);
}
