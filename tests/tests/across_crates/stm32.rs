//! What a command does on an STM32's advanced timer is what it does in the laboratory's inverter.
//!
//! The timer's output stage is simulated here from the reference manuals (RM0440 chapter 29, RM0090
//! chapter 17), clock by clock: counter, preload registers and their two events, dead-time
//! generator, and the table of output control bits.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{Gate, Gates, Wiring};
use hexagen_stm32::{Outputs, outputs};

/// `ARR`: a period has twice as many clocks.
const ARR: u16 = 50;
const PERIOD: u16 = 2 * ARR;
/// Clock of a period at which its interrupt writes the next command.
const WRITE: u16 = 30;

/// One channel behind its reference: rising edges of either output are late by the dead time.
#[derive(Clone, Copy)]
struct DeadTimeGenerator {
    reference: bool,
    /// Clocks since the reference changed.
    since: u16,
}

impl DeadTimeGenerator {
    /// Upper and lower output, as the two enables select them. The generator runs with any enables;
    /// with one alone its output is the reference itself, and with `OSSR` the other is driven low.
    fn clock(&mut self, reference: bool, dead_time: u16, enables: u32) -> (bool, bool) {
        self.since = if reference == self.reference {
            self.since.saturating_add(1)
        } else {
            0
        };
        self.reference = reference;
        let is_over = self.since >= dead_time;
        match enables & 0b101 {
            0b001 => (reference, false),
            0b100 => (false, reference),
            0b101 => (reference && is_over, !reference && is_over),
            _ => (false, false),
        }
    }
}

/// What sets the preload registers apart from plain ones.
#[derive(Clone, Copy, Default)]
struct Preload {
    /// Without `OCxPE` compare values take effect when they are written.
    compare_at_once: bool,
    /// Without `CCPC` enables take effect when they are written.
    enables_at_once: bool,
}

/// The output stage of an advanced timer in centre-aligned mode, from one overflow to the next.
struct Timer {
    dead_time: u16,
    /// Clocks from the commutation event to the update event.
    lead: u16,
    preload: Preload,
    compare: [u16; 3],
    enables: u32,
    written: Outputs,
    channels: [DeadTimeGenerator; 3],
}

impl Timer {
    fn new(dead_time: u16, lead: u16, preload: Preload) -> Self {
        let written = outputs(Legs::OFF);
        let rest = DeadTimeGenerator {
            reference: false,
            since: u16::MAX,
        };
        Self {
            dead_time,
            lead,
            preload,
            compare: written.compare,
            enables: written.enables,
            written,
            channels: [rest; 3],
        }
    }

    fn write(&mut self, written: Outputs) {
        self.written = written;
        if self.preload.compare_at_once {
            self.compare = written.compare;
        }
        if self.preload.enables_at_once {
            self.enables = written.enables;
        }
    }

    /// The pins at a clock of the period, which begins at the overflow with its update event.
    fn clock(&mut self, clock: u16) -> [Gate; 3] {
        if clock == 0 {
            self.compare = self.written.compare;
        }
        if clock == (PERIOD - self.lead) % PERIOD {
            self.enables = self.written.enables;
        }
        // Down from ARR to 1, then up from 0 to ARR - 1. PWM mode 1: counting down inactive while
        // the counter is above, counting up active while it is below.
        let is_active = |compare: u16| match clock.checked_sub(ARR) {
            None => ARR - clock <= compare,
            Some(counter) => counter < compare,
        };
        let legs: [usize; 3] = [0, 1, 2];
        legs.map(|leg| {
            let (reference, enables) = (is_active(self.compare[leg]), self.enables >> (4 * leg));
            match self.channels[leg].clock(reference, self.dead_time, enables) {
                (true, true) => panic!("both switches of leg {leg} are on"),
                (true, false) => Gate::Upper,
                (false, true) => Gate::Lower,
                (false, false) => Gate::Off,
            }
        })
    }
}

/// How the timer may differ from the inverter at a clock of a period, by its very nature.
fn is_known(timer: &Timer, clock: u16, gates: [Gate; 2], legs: [(LegState, u16); 2]) -> bool {
    let [(was, _), (wanted, compare)] = legs;
    match gates {
        // Enables change before the period does: the lower switch of a leg that goes off goes first,
        // and that of a leg that comes back comes first.
        [Gate::Off, Gate::Lower] | [Gate::Lower, Gate::Off] if clock >= PERIOD - timer.lead => {
            (was == LegState::Off) != (wanted == LegState::Off)
        }
        // A leg that comes back with its upper switch: the reference rises with the period, which the
        // dead-time generator delays; the inverter knows that the lower switch was off.
        [Gate::Off, Gate::Upper] if clock < timer.dead_time => {
            was == LegState::Off && wanted == LegState::Pulsed && compare == ARR
        }
        _ => false,
    }
}

/// Runs commands on both, each written in the period before its own; how many clocks of a leg differ
/// in a way that is known, or the first other difference.
fn differences(mut timer: Timer, commands: &[Legs]) -> Result<usize, String> {
    let mut inverter = Gates::new(f64::from(timer.dead_time), Wiring::default());
    let mut known = 0;
    let of = |legs: Legs, leg: usize| (legs.state()[leg], legs.compare()[leg]);
    let (mut previous, mut command) = (Legs::OFF, Legs::OFF);
    for &next in commands {
        inverter.begin(command.into(), ARR, (f64::from(PERIOD), 1));
        for clock in 0..PERIOD {
            if clock == WRITE {
                timer.write(outputs(next));
            }
            inverter.advance_to(f64::from(clock) + 0.25);
            let pins = timer.clock(clock);
            // Shortly before the next period it is that one's leg that enables are already for.
            let about = if clock < ARR {
                [previous, command]
            } else {
                [command, next]
            };
            for (leg, gates) in pins.into_iter().zip(inverter.state()).enumerate() {
                let (is, ideal) = gates;
                if is == ideal {
                    continue;
                }
                if !is_known(&timer, clock, [is, ideal], about.map(|legs| of(legs, leg))) {
                    return Err(format!(
                        "leg {leg}, clock {clock}: {is:?} for {ideal:?}; {about:?}"
                    ));
                }
                known += 1;
            }
        }
        inverter.end(f64::from(PERIOD));
        (previous, command) = (command, next);
    }
    Ok(known)
}

/// Commands of all kinds, the ends of the compare values often among them.
fn commands(seed: u64, number: usize) -> Vec<Legs> {
    let mut random = fastrand::Rng::with_seed(seed);
    let leg = |random: &mut fastrand::Rng| match random.u8(0..6) {
        0 => (random.u16(0..=ARR), LegState::Off),
        1 => (random.u16(0..=ARR), LegState::Low),
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

const DEAD_TIMES: [u16; 4] = [0, 1, 4, 9];
const PRELOADED: Preload = Preload {
    compare_at_once: false,
    enables_at_once: false,
};

#[test]
fn all_six_switches_change_with_the_period() {
    for dead_time in DEAD_TIMES {
        for lead in [0, 1, 6, 20] {
            let timer = Timer::new(dead_time, lead, PRELOADED);
            let known = differences(timer, &commands(u64::from(dead_time), 20_000));
            // With neither nothing at all differs.
            let expected = dead_time > 0 || lead > 0;
            assert!(
                known.as_ref().is_ok_and(|&known| (known > 0) == expected),
                "dead time {dead_time}, lead {lead}: {known:?}"
            );
        }
    }
}

#[test]
fn a_leg_that_goes_off_from_full_duty_does_not_touch_its_lower_switch() {
    let full = Legs::new([ARR; 3], [LegState::Pulsed; 3]);
    let commands = [Legs::LOW, full, Legs::OFF, Legs::OFF];
    for dead_time in DEAD_TIMES {
        let timer = Timer::new(dead_time, 0, PRELOADED);
        assert_eq!(differences(timer, &commands), Ok(0), "{dead_time}");
    }
}

#[test]
fn off_and_low_legs_ignore_what_stands_in_their_compare_values() {
    for (state, plain) in [(LegState::Off, Legs::OFF), (LegState::Low, Legs::LOW)] {
        assert_eq!(outputs(Legs::new([ARR; 3], [state; 3])), outputs(plain));
    }
}

/// Why both registers are preloaded, and why the commutation event comes first.
#[test]
fn registers_that_take_effect_at_another_time_are_found() {
    let found = |lead, preload| differences(Timer::new(4, lead, preload), &commands(1, 100));
    let compare_at_once = Preload {
        compare_at_once: true,
        ..PRELOADED
    };
    let enables_at_once = Preload {
        enables_at_once: true,
        ..PRELOADED
    };
    assert!(found(6, compare_at_once).is_err());
    assert!(found(6, enables_at_once).is_err());
    // Behind the update event: a lead of almost a period is a delay of some clocks.
    assert!(found(PERIOD - 6, PRELOADED).is_err());
}
