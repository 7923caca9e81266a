//! The state of the bit-true model, and its words in the order of `laws/semantics.md`.

use super::constants::Constants;
use super::hall_learning::Learnt;
use super::parts::{Part, Parts};
use crate::exact::{Word, pow2, word};
use crate::model::hall::HallTiming;
use crate::model::sector;
use crate::model::supervision::{
    HallCode, Mode, Supervisor, Unread, fault_from_word, fault_to_word,
};
use crate::model::trace::Past;
use hexagen::Fault;

/// State words in f64, small enums as such. Words of other variants exist, too, but are never read.
#[derive(Clone, Copy, Debug, Default)]
pub struct State<W: Word> {
    pub supervisor: Supervisor<W>,
    pub offset: [W; 3],
    pub sector_prev: usize,
    pub timing: HallTiming<W>,
    pub speed: Speed<W>,
    pub learnt: Learnt<W>,
    pub speed_integral: W,
    pub speed_in_force: W,
    /// 1 once controlled, 2 once the speed is known.
    pub ramp_begun: W,
    pub j_in_force: W,
    pub j_withheld: W,
    /// `line_a_cmd`, `line_b_cmd`.
    pub line_cmd: [W; 2],
    /// `line_a_ended`, `line_b_ended`.
    pub line_ended: [W; 2],
    pub i_bus_mean: W,
    pub sector_eff_prev: usize,
    pub commutation_left: W,
    pub i_prev: [W; 2],
    pub v_cmd: [W; 2],
    pub t_cmd: [W; 3],
    pub off_cmd: usize,
    pub v_prev: [W; 2],
    pub off_prev: usize,
    pub e_prev: [W; 2],
    pub e_next: [W; 2],
    pub net_prev: [W; 2],
    pub net_next: [W; 2],
    /// `e_error_q`, `e_error_d`.
    pub emf_error: [W; 2],
    pub weakening: W,
    pub residual_count: W,
    pub torque: Torque<W>,
    pub integral: [W; 2],
    /// `j_a_next`, `j_b_next`.
    pub j_next: [W; 2],
    /// `j_a_due`, `j_b_due`.
    pub j_due: [W; 2],
    /// `h_a`, `h_b`; unless stored in the contributions of past periods.
    pub hysteresis: [W; 2],
    pub vector_prev: Vector,
    pub past: Past<W>,
}

/// The rotor's speed, as it was seen at the last edge.
#[derive(Clone, Copy, Debug, Default)]
pub struct Speed<W: Word> {
    /// Angle per tick, mean of the last turn.
    pub omega: W,
    /// This sector's speed over it less 1, 2^32 for 1.
    pub rise: W,
    /// Angle per period, signed.
    pub step: W,
}

/// What is learnt of the torque constant; the ratio has 28 fraction bits.
#[derive(Clone, Copy, Debug)]
pub struct Torque<W> {
    pub ratio: W,
    pub light: W,
}

impl<W: Word> Default for Torque<W> {
    fn default() -> Self {
        Self {
            ratio: word(pow2(28)),
            light: word(0.0),
        }
    }
}

/// Number of a vector, 0 to 15.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vector(pub usize);

/// A value stored as a state word.
trait WordValue {
    fn to_word(&self) -> i32;
    /// Sets a word, which stands for any of a range if it is a number.
    fn set_word(&mut self, word: i32, range: (i32, i32));
}

impl<W: Word> WordValue for W {
    #[inline]
    fn to_word(&self) -> i32 {
        Word::to_i32(*self)
    }

    fn set_word(&mut self, word: i32, (low, high): (i32, i32)) {
        *self = W::whole(word.into(), low.into(), high.into());
    }
}

/// A sector, or a leg by its number from 1.
impl WordValue for usize {
    #[inline]
    fn to_word(&self) -> i32 {
        *self as i32
    }

    fn set_word(&mut self, word: i32, _range: (i32, i32)) {
        *self = usize::try_from(word).unwrap_or(0).min(6);
    }
}

impl WordValue for Vector {
    #[inline]
    fn to_word(&self) -> i32 {
        self.0 as i32
    }

    fn set_word(&mut self, word: i32, _range: (i32, i32)) {
        self.0 = usize::try_from(word).unwrap_or(0).min(15);
    }
}

/// The number of observed edges or angles.
impl WordValue for u8 {
    #[inline]
    fn to_word(&self) -> i32 {
        i32::from(*self)
    }

    fn set_word(&mut self, word: i32, (low, high): (i32, i32)) {
        *self = word.clamp(low, high) as u8;
    }
}

impl WordValue for bool {
    #[inline]
    fn to_word(&self) -> i32 {
        i32::from(*self)
    }

    fn set_word(&mut self, word: i32, _range: (i32, i32)) {
        *self = word != 0;
    }
}

impl WordValue for Mode {
    #[inline]
    fn to_word(&self) -> i32 {
        *self as i32
    }

    fn set_word(&mut self, word: i32, _range: (i32, i32)) {
        *self = Self::from_word(word);
    }
}

impl WordValue for Option<Fault> {
    #[inline]
    fn to_word(&self) -> i32 {
        fault_to_word(*self)
    }

    fn set_word(&mut self, word: i32, _range: (i32, i32)) {
        *self = fault_from_word(word);
    }
}

impl WordValue for HallCode {
    #[inline]
    fn to_word(&self) -> i32 {
        self.0.into()
    }

    fn set_word(&mut self, word: i32, _range: (i32, i32)) {
        self.0 = word.clamp(0, 6) as u8;
    }
}

/// Two bits for each, 3 where all legs are read; that of the ended period lowest.
impl WordValue for Unread {
    fn to_word(&self) -> i32 {
        let [ended, next] = self.0.map(|unread| unread.unwrap_or(3) as i32);
        // Without a delay the next one is 0.
        ended | next << 2
    }

    fn set_word(&mut self, word: i32, _range: (i32, i32)) {
        self.0 = [word & 3, word >> 2 & 3].map(|leg| (leg < 3).then_some(leg as usize));
    }
}

/// Calls `$show!(name, place)` for every word of a variant: the supervisor's, then the law's in the
/// order of the semantics' list.
macro_rules! for_each_word {
    ($state:expr, $parts:expr, $show:ident) => {
        $show!("mode", $state.supervisor.mode);
        $show!("fault", $state.supervisor.fault);
        $show!("countdown", $state.supervisor.countdown);
        $show!("sum_a", $state.supervisor.sum[0]);
        $show!("sum_b", $state.supervisor.sum[1]);
        $show!("offset_a", $state.offset[0]);
        $show!("offset_b", $state.offset[1]);
        $show!("stall_count", $state.supervisor.stall_count);
        $show!("hall_prev", $state.supervisor.hall_prev);
        $show!("hall_gap", $state.supervisor.hall_gap);
        $show!("hall_glitches", $state.supervisor.hall_glitches);
        $show!("turn_hall", $state.supervisor.turn.hall);
        $show!("turn_age", $state.supervisor.turn.age);
        $show!("turn_interval", $state.supervisor.turn.interval);
        $show!("turn_direction", $state.supervisor.turn.direction);
        $show!("sum_c", $state.supervisor.sum[2]);
        $show!("offset_c", $state.offset[2]);
        $show!("sum_count", $state.supervisor.sum_count);
        $show!("unread", $state.supervisor.unread);
        if $parts.has(Part::Edges) {
            $show!("sector_prev", $state.sector_prev);
        }
        if $parts.has(Part::Direction) {
            $show!("direction", $state.timing.direction);
        }
        if $parts.has(Part::Rotor) {
            $show!("age_prev", $state.timing.age_prev);
            $show!("edges", $state.timing.edges);
            $show!("t1", $state.timing.intervals[0]);
            $show!("t2", $state.timing.intervals[1]);
            $show!("t3", $state.timing.intervals[2]);
            $show!("t4", $state.timing.intervals[3]);
            $show!("t5", $state.timing.intervals[4]);
            $show!("t6", $state.timing.intervals[5]);
            $show!("rev", $state.timing.rev);
            $show!("omega", $state.speed.omega);
            if $parts.has(Part::Rise) {
                $show!("rise", $state.speed.rise);
            }
            $show!("step_angle", $state.speed.step);
        }
        if $parts.has(Part::HallLearning) {
            $show!("shift_1", $state.learnt.shifts[0]);
            $show!("shift_2", $state.learnt.shifts[1]);
            $show!("shift_all", $state.learnt.all);
            $show!("sector_shift", $state.learnt.begin);
            $show!("sector_width", $state.learnt.width);
            $show!("steady_edges", $state.timing.steady);
        }
        if $parts.has(Part::Angle) {
            $show!("theta_prev", $state.timing.theta_prev);
            $show!("angles", $state.timing.edges);
            $show!("step_angle", $state.timing.step);
        }
        if $parts.has(Part::OverSpeed) {
            $show!("over_speed_count", $state.timing.too_fast);
        }
        if $parts.has(Part::Speed) {
            $show!("speed_integral", $state.speed_integral);
        }
        if $parts.has(Part::Ramp) {
            $show!("speed_in_force", $state.speed_in_force);
            $show!("ramp_begun", $state.ramp_begun);
        }
        if $parts.has(Part::Slew) {
            $show!("j_in_force", $state.j_in_force);
        }
        if $parts.has(Part::BusCurrent) {
            $show!("j_withheld", $state.j_withheld);
            if $parts.has(Part::LineCommand) {
                $show!("line_a_cmd", $state.line_cmd[0]);
                $show!("line_b_cmd", $state.line_cmd[1]);
            }
            $show!("line_a_ended", $state.line_ended[0]);
            $show!("line_b_ended", $state.line_ended[1]);
            $show!("i_bus_mean", $state.i_bus_mean);
        }
        if $parts.has(Part::Commutation) {
            if $parts.has(Part::SectorInForce) {
                $show!("sector_eff_prev", $state.sector_eff_prev);
            }
            $show!("commutation_left", $state.commutation_left);
        }
        if $parts.has(Part::Sight) {
            $show!("i_a_prev", $state.i_prev[0]);
            $show!("i_b_prev", $state.i_prev[1]);
        }
        if $parts.has(Part::VoltageCommand) {
            $show!("v_a_cmd", $state.v_cmd[0]);
            $show!("v_b_cmd", $state.v_cmd[1]);
        }
        if $parts.has(Part::TerminalCommand) {
            $show!("t_a_cmd", $state.t_cmd[0]);
            $show!("t_b_cmd", $state.t_cmd[1]);
            $show!("t_c_cmd", $state.t_cmd[2]);
            $show!("off_cmd", $state.off_cmd);
        }
        if $parts.has(Part::VoltageMemory) {
            $show!("v_a_prev", $state.v_prev[0]);
            $show!("v_b_prev", $state.v_prev[1]);
        }
        if $parts.has(Part::OffMemory) {
            $show!("off_prev", $state.off_prev);
        }
        if $parts.has(Part::EmfMemory) {
            $show!("e_a_prev", $state.e_prev[0]);
            $show!("e_b_prev", $state.e_prev[1]);
        }
        if $parts.has(Part::EmfNext) {
            $show!("e_a_next", $state.e_next[0]);
            $show!("e_b_next", $state.e_next[1]);
        }
        if $parts.has(Part::NetMemory) {
            $show!("net_a_prev", $state.net_prev[0]);
            $show!("net_b_prev", $state.net_prev[1]);
        }
        if $parts.has(Part::NetNext) {
            $show!("net_a_next", $state.net_next[0]);
            $show!("net_b_next", $state.net_next[1]);
        }
        if $parts.has(Part::EmfError) {
            $show!("e_error_q", $state.emf_error[0]);
            $show!("e_error_d", $state.emf_error[1]);
        }
        if $parts.has(Part::Weakening) {
            $show!("weakening", $state.weakening);
        }
        if $parts.has(Part::Residual) {
            $show!("residual_count", $state.residual_count);
        }
        if $parts.has(Part::TorqueLearning) {
            $show!("torque_ratio", $state.torque.ratio);
            $show!("light_periods", $state.torque.light);
        }
        if $parts.has(Part::Integral) {
            $show!("integral_a", $state.integral[0]);
            $show!("integral_b", $state.integral[1]);
        }
        if $parts.has(Part::PairIntegral) {
            $show!("integral", $state.integral[0]);
        }
        if $parts.has(Part::ReferenceNext) {
            $show!("j_a_next", $state.j_next[0]);
            $show!("j_b_next", $state.j_next[1]);
        }
        if $parts.has(Part::ReferenceDue) {
            $show!("j_a_due", $state.j_due[0]);
            $show!("j_b_due", $state.j_due[1]);
        }
        if $parts.has(Part::Due) {
            $show!("due_a", $state.past.due[0]);
            $show!("due_b", $state.past.due[1]);
        }
        if $parts.has(Part::Later) {
            $show!("later_a", $state.past.later[0]);
            $show!("later_b", $state.past.later[1]);
        }
        if $parts.has(Part::Hysteresis) {
            $show!("h_a", $state.hysteresis[0]);
            $show!("h_b", $state.hysteresis[1]);
        }
        if $parts.has(Part::VectorMemory) {
            $show!("vector_prev", $state.vector_prev);
        }
    };
}

/// Names of the words.
pub fn names(parts: Parts) -> Vec<&'static str> {
    let mut names = Vec::new();
    macro_rules! name {
        ($name:literal, $place:expr) => {
            names.push($name)
        };
    }
    for_each_word!(State, parts, name);
    names
}

impl<W: Word> State<W> {
    /// Tracks the commutation (section 5); returns whether it continues.
    #[inline]
    pub fn commutate(&mut self, k: &Constants<W>, sector_eff: usize, j: W, i: &[W; 3]) -> bool {
        let changed = sector_eff != self.sector_eff_prev && self.sector_eff_prev != 0;
        let torque = if j < 0.0 { -1.0 } else { 1.0 };
        let sign = self.timing.direction * (sector::OUT_SIGN[sector_eff] * torque);
        let flows = sign * i[sector::OUT_PHASE[sector_eff]] > k.i_comm;
        let kept = if changed {
            word(k.comm_samples)
        } else {
            self.commutation_left
        };
        let goes_on = kept > 0.0 && (changed || flows);
        self.commutation_left = if goes_on { kept - 1.0 } else { word(0.0) };
        goes_on
    }

    /// State after a period without control (section 12).
    pub fn stop(&mut self) {
        self.speed_integral = word(0.0);
        self.speed_in_force = word(0.0);
        self.ramp_begun = word(0.0);
        self.j_in_force = word(0.0);
        self.j_withheld = word(0.0);
        self.line_cmd = [word(0.0); 2];
        self.line_ended = [word(0.0); 2];
        self.i_bus_mean = word(0.0);
        self.v_cmd = [word(0.0); 2];
        self.t_cmd = [word(0.0); 3];
        self.off_cmd = 0;
        self.v_prev = [word(0.0); 2];
        self.off_prev = 0;
        self.e_prev = [word(0.0); 2];
        self.e_next = [word(0.0); 2];
        self.net_prev = [word(0.0); 2];
        self.net_next = [word(0.0); 2];
        self.emf_error = [word(0.0); 2];
        self.weakening = word(0.0);
        self.residual_count = word(0.0);
        self.torque.light = word(0.0);
        self.integral = [word(0.0); 2];
        self.j_next = [word(0.0); 2];
        self.j_due = [word(0.0); 2];
        self.hysteresis = [word(0.0); 2];
        self.vector_prev = Vector(0);
        self.past = Past::default();
        self.commutation_left = word(0.0);
    }

    /// Writes the words in order.
    #[inline]
    pub fn write(&self, parts: Parts, words: &mut [i32]) {
        let mut places = words.iter_mut();
        macro_rules! put {
            ($name:literal, $place:expr) => {
                if let Some(word) = places.next() {
                    *word = $place.to_word();
                }
            };
        }
        for_each_word!(self, parts, put);
    }

    /// Reads the words in order, each with its range; missing words leave their part of the state
    /// unchanged.
    pub fn read(&mut self, parts: Parts, mut words: impl Iterator<Item = (i32, (i32, i32))>) {
        macro_rules! take {
            ($name:literal, $place:expr) => {
                if let Some((word, range)) = words.next() {
                    $place.set_word(word, range);
                }
            };
        }
        for_each_word!(self, parts, take);
        // Without an advance the effective sector is that of the sample, without a word of its own.
        if !parts.has(Part::SectorInForce) {
            self.sector_eff_prev = self.sector_prev;
        }
    }
}
