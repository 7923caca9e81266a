//! From compare values to gate signals: centre-aligned pulses and dead time.
//!
//! The upper switch of a pulsed leg is on for `compare` counts around the middle of the period,
//! the lower one otherwise, so the start of a period (the sampling instant) is the middle of the
//! lower switch's time. Each change between the two switches is preceded by the dead time, also where the leg is off for
//! less than that in between.

use super::Wiring;
use hexagen::{Intervals, LegState, Legs};
use hexagen_reference::AnyCommand;

/// The conducting switch of a leg.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gate {
    /// The upper one.
    Upper,
    /// The lower one.
    Lower,
    /// Neither.
    #[default]
    Off,
}

/// One leg's switches: the present gate, and the one after the dead time.
#[derive(Clone, Copy, Debug, Default)]
struct LegGate {
    gate: Gate,
    wanted: Gate,
    /// The switch that was on last.
    last: Gate,
    /// End of the dead time, from the start of the period; infinite when none runs.
    ready: Option<f64>,
    /// Time of the last change, from the start of the period.
    changed: f64,
    turn_ons: u64,
}

impl LegGate {
    fn turn(&mut self, gate: Gate, t: f64) {
        self.ready = None;
        self.gate = gate;
        self.changed = t;
        if gate != Gate::Off {
            self.last = gate;
            self.turn_ons += 1;
        }
    }

    fn request(&mut self, wanted: Gate, t: f64, dead_time: f64) {
        if wanted == self.wanted {
            return;
        }
        let from_rest = self.wanted == Gate::Off;
        self.wanted = wanted;
        let ready = self.changed + dead_time;
        if from_rest && self.last != wanted && self.last != Gate::Off && t < ready {
            self.ready = Some(ready);
        } else if wanted == Gate::Off || from_rest || dead_time == 0.0 {
            self.turn(wanted, t);
        } else {
            self.gate = Gate::Off;
            self.ready = Some(t + dead_time);
        }
    }
}

/// The three legs' gate signals over one period at a time.
#[derive(Clone, Debug)]
pub struct Gates {
    legs: [LegGate; 3],
    /// Requests of the running period: time, leg, gate; sorted by time from `next`.
    requests: Vec<(f64, usize, Gate)>,
    next: usize,
    dead_time: f64,
    wiring: Wiring,
}

impl Gates {
    /// All switches off, with a dead time in seconds.
    pub fn new(dead_time: f64, wiring: Wiring) -> Self {
        Self {
            legs: [LegGate::default(); 3],
            requests: Vec::with_capacity(9),
            next: 0,
            dead_time,
            wiring,
        }
    }

    /// Another dead time and other switches from the next change on.
    pub(super) fn change(&mut self, dead_time: f64, wiring: Wiring) {
        (self.dead_time, self.wiring) = (dead_time, wiring);
    }

    /// Starts a period of so many pulses, each of `pwm_period` seconds, with the given command.
    pub fn begin(
        &mut self,
        command: AnyCommand,
        timer_period: u16,
        (pwm_period, pulses): (f64, u16),
    ) {
        self.requests.clear();
        self.next = 0;
        for pulse in 0..pulses {
            let start = f64::from(pulse) * pwm_period;
            match command {
                AnyCommand::Legs(legs) => self.add_pulses(legs, timer_period, (start, pwm_period)),
                AnyCommand::Intervals(intervals) => {
                    let count = pwm_period / f64::from(timer_period);
                    self.add_intervals(intervals, (start, count));
                }
            }
        }
        self.requests.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// Requests of centred pulses in the PWM period that begins at `start`.
    fn add_pulses(&mut self, legs: Legs, timer_period: u16, (start, pwm_period): (f64, f64)) {
        for (leg, (state, compare)) in legs.state().into_iter().zip(legs.compare()).enumerate() {
            match state {
                LegState::Off => self.requests.push((start, leg, Gate::Off)),
                LegState::Low => self.requests.push((start, leg, Gate::Lower)),
                LegState::Pulsed => {
                    let duty = f64::from(compare.min(timer_period)) / f64::from(timer_period);
                    if duty < 1.0 {
                        self.requests.push((start, leg, Gate::Lower));
                    }
                    if duty > 0.0 {
                        self.requests.push((
                            start + 0.5 * pwm_period * (1.0 - duty),
                            leg,
                            Gate::Upper,
                        ));
                    }
                    if duty > 0.0 && duty < 1.0 {
                        self.requests.push((
                            start + 0.5 * pwm_period * (1.0 + duty),
                            leg,
                            Gate::Lower,
                        ));
                    }
                }
            }
        }
    }

    /// Requests of intervals in the PWM period that begins at `start`; `count`: seconds of a timer count. An interval
    /// without length makes none.
    fn add_intervals(&mut self, intervals: Intervals, (start, count): (f64, f64)) {
        let [first, second] = intervals.ends();
        let begins = [0, first, second];
        let lengths = [first, second.saturating_sub(first), 1];
        let states = intervals.state();
        for (interval, begin) in begins
            .into_iter()
            .enumerate()
            .filter(|(x, _)| lengths[*x] > 0)
        {
            let is_last = interval == 2;
            for (leg, state) in states[interval].into_iter().enumerate() {
                let gate = match state {
                    LegState::Off => Gate::Off,
                    LegState::Pulsed if !is_last => Gate::Upper,
                    LegState::Pulsed | LegState::Low => Gate::Lower,
                };
                self.requests
                    .push((start + f64::from(begin) * count, leg, gate));
            }
        }
    }

    /// Ends a period: running dead times continue in the next one.
    pub fn end(&mut self, t_s: f64) {
        for leg in &mut self.legs {
            leg.ready = leg.ready.map(|ready| ready - t_s);
            leg.changed -= t_s;
        }
    }

    /// Applies all changes due at or before `t` and returns the time of the next one.
    pub fn advance_to(&mut self, t: f64) -> f64 {
        while let Some(&(at, leg, gate)) = self.requests.get(self.next).filter(|r| r.0 <= t) {
            self.next += 1;
            self.legs[leg].request(gate, at, self.dead_time);
        }
        let mut upcoming = self.requests.get(self.next).map_or(f64::INFINITY, |r| r.0);
        for leg in &mut self.legs {
            match leg.ready {
                Some(ready) if ready <= t => leg.turn(leg.wanted, ready),
                Some(ready) => upcoming = upcoming.min(ready),
                None => {}
            }
        }
        upcoming
    }

    /// How long each leg has been as it is, `t` seconds into the period.
    pub(super) fn held_for(&self, t: f64) -> [f64; 3] {
        self.legs.map(|leg| t - leg.changed)
    }

    /// What conducts in each leg: of a switch that is dead, nothing.
    pub fn state(&self) -> [Gate; 3] {
        std::array::from_fn(|x| match self.legs[x].gate {
            Gate::Upper if self.wiring.upper_dead[x] => Gate::Off,
            Gate::Lower if self.wiring.lower_dead[x] => Gate::Off,
            gate => gate,
        })
    }

    /// Turn-ons that all six switches were told so far.
    pub fn turn_ons(&self) -> u64 {
        self.legs.iter().map(|leg| leg.turn_ons).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times at which each leg's gate changes over the periods' commands.
    fn changes<C: Into<AnyCommand> + Copy>(
        dead_time: f64,
        commands: &[C],
    ) -> Vec<(f64, usize, Gate)> {
        let mut gates = Gates::new(dead_time, Wiring::default());
        let mut changes = Vec::new();
        for (period, command) in commands.iter().enumerate() {
            gates.begin((*command).into(), 100, (1.0, 1));
            let mut t = 0.0;
            while t < 1.0 {
                let before = gates.state();
                let next = gates.advance_to(t).min(1.0);
                for (leg, (was, is)) in before.iter().zip(gates.state()).enumerate() {
                    if *was != is {
                        changes.push((period as f64 + t, leg, is));
                    }
                }
                t = next;
            }
            gates.end(1.0);
        }
        changes
    }

    fn pulsed(compare: u16) -> Legs {
        Legs::new(
            [compare, 0, 0],
            [LegState::Pulsed, LegState::Off, LegState::Off],
        )
    }

    #[test]
    fn pulses_are_centred() {
        let got = changes(0.0, &[pulsed(50), pulsed(100), pulsed(0)]);
        let want = [
            (0.0, Gate::Lower),
            (0.25, Gate::Upper),
            (0.75, Gate::Lower),
            (1.0, Gate::Upper),
            (2.0, Gate::Lower),
        ];
        assert_eq!(got, want.map(|(t, g)| (t, 0, g)));
    }

    #[test]
    fn pulses_are_repeated_within_a_control_period() {
        let mut gates = Gates::new(0.0, Wiring::default());
        gates.begin(pulsed(50).into(), 100, (0.25, 2));
        let mut seen = vec![];
        let mut t = 0.0;
        while t < 0.5 {
            let next = gates.advance_to(t).min(0.5);
            seen.push((t, gates.state()[0]));
            t = next;
        }
        let want = [
            (0.0, Gate::Lower),
            (0.0625, Gate::Upper),
            (0.1875, Gate::Lower),
            (0.25, Gate::Lower),
            (0.3125, Gate::Upper),
            (0.4375, Gate::Lower),
        ];
        assert_eq!(seen, want);
    }

    #[test]
    fn intervals_have_legs_of_their_own() {
        use LegState::{Low, Off, Pulsed};
        let pairs = [[Pulsed, Low, Off], [Pulsed, Off, Low], [Low; 3]];
        let got = changes(0.0, &[Intervals::new([25, 75], pairs)]);
        let want = [
            (0.0, 0, Gate::Upper),
            (0.0, 1, Gate::Lower),
            (0.25, 1, Gate::Off),
            (0.25, 2, Gate::Lower),
            (0.75, 0, Gate::Lower),
            (0.75, 1, Gate::Lower),
        ];
        assert_eq!(got, want);
        // An interval of no length has no pulse, and the zero vector none at all.
        let got = changes(
            0.0,
            &[Intervals::new(
                [0, 50],
                [[Pulsed; 3], pairs[0], [Pulsed; 3]],
            )],
        );
        let want = [
            (0.0, 0, Gate::Upper),
            (0.0, 1, Gate::Lower),
            (0.5, 0, Gate::Lower),
            (0.5, 2, Gate::Lower),
        ];
        assert_eq!(got, want);
        // The dead time comes off a leg that changes from one switch to the other.
        let got = changes(0.125, &[Intervals::new([25, 75], pairs)]);
        let (_, change) = (&got[..4], &got[4..]);
        let want = [
            (0.75, 0, Gate::Off),
            (0.75, 1, Gate::Lower),
            (0.875, 0, Gate::Lower),
        ];
        assert_eq!(change, want);
        // Also where it is off for less than that in between.
        let legs = [[Low, Pulsed, Off], [Low, Off, Pulsed], [Low; 3]];
        let got = changes(0.125, &[Intervals::new([25, 26], legs)]);
        let of_b: Vec<_> = got.into_iter().filter(|(_, leg, _)| *leg == 1).collect();
        let want = [
            (0.0, 1, Gate::Upper),
            (0.25, 1, Gate::Off),
            (0.375, 1, Gate::Lower),
        ];
        assert_eq!(of_b, want);
    }

    #[test]
    fn dead_time_delays_every_turn_on_and_swallows_short_pulses() {
        let got = changes(0.125, &[pulsed(50), pulsed(10), pulsed(100)]);
        let want = [
            (0.0, Gate::Lower),
            (0.25, Gate::Off),
            (0.375, Gate::Upper),
            (0.75, Gate::Off),
            (0.875, Gate::Lower),
            (1.45, Gate::Off),
            (1.675, Gate::Lower),
            (2.0, Gate::Off),
            (2.125, Gate::Upper),
        ];
        assert_eq!(got.len(), want.len(), "{got:?}");
        for ((t, leg, gate), (t_want, gate_want)) in got.into_iter().zip(want) {
            assert!(
                (t - t_want).abs() < 1e-12 && leg == 0 && gate == gate_want,
                "{t} {gate:?}"
            );
        }
    }
}
