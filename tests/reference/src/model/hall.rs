//! Timing of Hall edges (section 4 of the semantics): age of the last edge, length of the last
//! turn, and their validity. Ages are integer ticks; of a period with a fractional number of ticks
//! the integer part is counted, and a turn is corrected for the rest.

use super::sector::HallEvent;
use crate::exact::{Word, floor_shift, greater, lesser, within, word};
use crate::spec::{HallCapture, Inverter, Motor, Spec};

/// Constants of the timing, in ticks.
#[derive(Clone, Copy, Debug)]
pub struct HallClock {
    pub timer: bool,
    /// Ticks per control period.
    pub period: f64,
    /// TICKS: their integer part.
    pub ticks: f64,
    /// TURN_REST.
    pub turn_rest: f64,
    pub age_max: f64,
    pub rev_min: f64,
    /// Of a turn at the over-speed; 0 where the speed is not watched.
    pub over_speed_turn: f64,
    /// Whether the intervals tell the speed's rise.
    pub tells_rise: bool,
}

/// 4 (1/2 + 1/12): from the middle of a turn to the middle of the sector behind it.
pub const RISE: f64 = 7.0 / 3.0;
/// Limit of the change of half a turn's time, relative to a turn's.
pub const GREATEST_CHANGE: f64 = 0.125;

impl HallClock {
    pub fn new(spec: &Spec) -> Self {
        let Inverter {
            hall_capture,
            ticks,
            age_max,
            rev_min,
            over_speed_turn,
            ..
        } = spec.inverter;
        Self {
            timer: hall_capture == HallCapture::Timer,
            period: ticks,
            ticks: ticks.floor(),
            turn_rest: (6.0 * ticks.fract() + 0.5).floor(),
            age_max: f64::from(age_max),
            rev_min: f64::from(rev_min),
            over_speed_turn: f64::from(over_speed_turn.unwrap_or(0)),
            tells_rise: hall_capture == HallCapture::Timer && spec.motor.edges_are_opposite(),
        }
    }
}

/// Currents at which the EMF tells the angle, over the greatest.
pub const SMALL_CURRENT: f64 = 0.1;

/// Error of the EMF across the shape, over sqrt(3), where the angle is half a degree off, volt per electrical rad/s.
pub fn across_at_small_angle(motor: &Motor) -> f64 {
    let linkage = motor.emf_constant / f64::from(motor.pole_pairs);
    let length = 2.0 / 3.0 * motor.torque_constant / motor.emf_constant;
    0.5_f64.to_radians() * linkage / (length * 3.0_f64.sqrt())
}

/// State of the edge timing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HallTiming<W = f64> {
    /// 1 forward, -1 backward.
    pub direction: W,
    /// Ticks from the last edge to the last sample.
    pub age_prev: W,
    /// 0: nothing known; 1: one edge, or angle, seen; 2 and more: the speed is valid.
    pub edges: u8,
    /// The last six edge-to-edge intervals, newest first.
    pub intervals: [W; 6],
    /// Their sum: ticks of one electrical turn.
    pub rev: W,
    /// Edges in a row in one direction.
    pub steady: u8,
    /// Edges in a row at which the turn was too short, or periods in a row with too large an angle.
    pub too_fast: W,
    /// With an angle sensor: the last sample's angle, 2^32 a turn, signed.
    pub theta_prev: W,
    /// With an angle sensor: angle per period, 2^32 a turn, signed.
    pub step: W,
}

/// Edges in a row behind which all six intervals are measured.
const WHOLE_TURN: u8 = 7;

/// Edges in a row with too short a turn that are an over-speed.
const TOO_FAST: f64 = 7.0;

impl<W: Word> Default for HallTiming<W> {
    fn default() -> Self {
        Self {
            direction: word(0.0),
            age_prev: word(0.0),
            edges: 0,
            intervals: [word(1.0); 6],
            rev: word(6.0),
            steady: 0,
            too_fast: word(0.0),
            theta_prev: word(0.0),
            step: word(0.0),
        }
    }
}

impl<W: Word> HallTiming<W> {
    /// Tracks the direction only.
    #[inline]
    pub fn turn_direction(&mut self, event: &HallEvent) {
        if event.edge {
            if event.forward {
                self.direction = word(1.0);
            } else if event.backward {
                self.direction = word(-1.0);
            }
        }
    }

    /// What a ramp of the speed has begun at: 1, or 2 once the speed is known.
    #[inline]
    pub fn ramp_known(&self) -> f64 {
        if self.edges >= 2 { 2.0 } else { 1.0 }
    }

    /// By how many ticks the last half turn was shorter than the one before, less the tick that both may differ by at constant
    /// speed.
    #[inline]
    pub fn shortened(&self) -> W {
        let [last, middle, first, third, second, oldest] = self.intervals;
        let difference = (third + second + oldest) - (last + middle + first);
        difference - within(difference, -1.0, 1.0)
    }

    /// Whether the rotor turns too fast.
    #[inline]
    pub fn is_too_fast(&self) -> bool {
        self.too_fast >= TOO_FAST
    }

    /// Counts an edge, or a period, of a rotor that is too fast or not.
    #[inline]
    pub fn count_speed(&mut self, is_over: bool) {
        self.too_fast = if is_over {
            lesser(self.too_fast + 1.0, TOO_FAST)
        } else {
            word(0.0)
        };
    }

    /// One sample; `direction_before` is the direction before this sample's edge was evaluated.
    /// Leaves the present age in `age_prev`. Returns whether this is an edge behind a whole turn of steady speed.
    #[inline]
    pub fn step(
        &mut self,
        clock: &HallClock,
        event: &HallEvent,
        direction_before: W,
        hall_ticks: W,
    ) -> bool {
        let age_before = self.age_prev + clock.ticks;
        let since = match (clock.timer, event.edge) {
            (true, true) if hall_ticks > (2.0 * clock.period).floor() => word(0.0),
            (true, true) => hall_ticks,
            (true, false) => greater(hall_ticks, age_before),
            (false, true) => word(1.0),
            (false, false) => age_before,
        };
        let age = lesser(since, clock.age_max + 1.0);
        let mut tells = false;
        if event.edge {
            let interval = within(age_before - age, 1.0, clock.age_max);
            let step_ok = event.forward || event.backward;
            let again = step_ok && self.direction == direction_before && self.edges >= 1;
            if again && self.edges == 1 {
                self.intervals = [interval; 6];
            } else if again {
                self.intervals.rotate_right(1);
                self.intervals[0] = interval;
            }
            let is_whole = self.steady >= WHOLE_TURN - 1;
            self.steady = if again {
                (self.steady + 1).min(WHOLE_TURN)
            } else {
                1
            };
            self.edges = if !step_ok {
                0
            } else if again {
                2
            } else {
                1
            };
            let intervals = self.intervals.into_iter();
            let rev_before = self.rev;
            self.rev = intervals.fold(word(clock.turn_rest), |turn, interval| turn + interval);
            let is_steady = (self.rev - rev_before).abs() <= floor_shift(self.rev, 6);
            tells = again && is_whole && is_steady;
            self.count_speed(self.edges == 2 && self.rev < clock.over_speed_turn);
        }
        if age > clock.age_max || (self.edges == 2 && age * 3.0 > self.rev) {
            self.edges = 0;
        }
        self.age_prev = age;
        tells
    }
}
