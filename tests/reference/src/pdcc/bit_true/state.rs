//! The state of the bit-true model, and its words in the order of `semantics.md`.

use super::constants::Constants;
use crate::exact::to_i32;
use crate::pdcc::hall::HallTiming;
use crate::pdcc::sector;
use crate::pdcc::supervision::{Mode, Supervisor, fault_from_word};
use crate::pdcc::trace::PhysicalState;
use hexagen::Fault;

/// State words in f64; small enums as such. Words that the variant does not have are kept as well
/// and never read.
#[derive(Clone, Copy, Debug, Default)]
pub struct State {
    pub supervisor: Supervisor,
    pub offset: [f64; 2],
    pub sector_prev: usize,
    pub timing: HallTiming,
    pub omega: f64,
    pub sector_eff_prev: usize,
    pub commutating: bool,
    pub commutation_age: f64,
    pub i_prev: [f64; 2],
    pub v_cmd: [f64; 2],
    pub t_cmd: [f64; 3],
    pub off_cmd: usize,
    pub v_prev: [f64; 2],
    pub e_prev: [f64; 2],
}

/// A group of state words that not every variant has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    Stall,
    Direction,
    Rotor,
    Pair,
    Estimated,
    VoltageCommand,
    TerminalCommand,
    EmfMemory,
}

/// The groups that a variant has.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parts(u8);

impl Parts {
    /// Those of the groups whose condition is true.
    pub fn new(groups: &[(Part, bool)]) -> Self {
        Self(
            groups
                .iter()
                .filter(|(_, present)| *present)
                .fold(0, |set, (part, _)| set | 1 << *part as u8),
        )
    }

    /// Whether the variant has the group.
    #[inline]
    pub fn has(self, part: Part) -> bool {
        self.0 >> part as u8 & 1 != 0
    }
}

/// Where a state word is kept.
enum Slot<'a> {
    Mode(&'a mut Mode),
    Fault(&'a mut Fault),
    Word(&'a mut f64),
    /// An index and the greatest that it may be.
    Index(&'a mut usize, usize),
    Edges(&'a mut u8),
    Flag(&'a mut bool),
}

impl Slot<'_> {
    #[inline]
    fn get(&self) -> i32 {
        match self {
            Self::Mode(mode) => **mode as i32,
            Self::Fault(fault) => **fault as i32,
            Self::Word(word) => to_i32(**word),
            Self::Index(index, _) => **index as i32,
            Self::Edges(edges) => i32::from(**edges),
            Self::Flag(flag) => i32::from(**flag),
        }
    }

    fn set(&mut self, word: i32) {
        match self {
            Self::Mode(mode) => **mode = Mode::from_word(word),
            Self::Fault(fault) => **fault = fault_from_word(word),
            Self::Word(place) => **place = f64::from(word),
            Self::Index(index, greatest) => {
                **index = usize::try_from(word).unwrap_or(0).min(*greatest);
            }
            Self::Edges(edges) => **edges = word.clamp(0, 2) as u8,
            Self::Flag(flag) => **flag = word != 0,
        }
    }
}

/// Names of the words.
pub fn names(parts: Parts) -> Vec<&'static str> {
    let mut names = Vec::new();
    State::default().visit(parts, |name, _| names.push(name));
    names
}

impl State {
    /// Follows the commutation (section 5).
    #[inline]
    pub fn commutate(&mut self, k: &Constants, sector_eff: usize, j: f64, i: &[f64; 3]) {
        let changed = sector_eff != self.sector_eff_prev && self.sector_eff_prev != 0;
        let torque = if j < 0.0 { -1.0 } else { 1.0 };
        let sign = sector::OUT_SIGN[sector_eff] * torque * self.timing.direction;
        let ended = sign * i[sector::OUT_PHASE[sector_eff]] <= k.i_comm
            || self.commutation_age >= k.comm_timeout;
        self.commutating = changed || (self.commutating && !ended);
        self.commutation_age = if changed {
            0.0
        } else {
            (self.commutation_age + 1.0).min(k.comm_timeout)
        };
    }

    /// What a period outside of control leaves behind (section 12).
    pub fn stop(&mut self) {
        self.v_cmd = [0.0; 2];
        self.t_cmd = [0.0; 3];
        self.off_cmd = 0;
        self.v_prev = [0.0; 2];
        self.e_prev = [0.0; 2];
        self.commutating = false;
        self.commutation_age = 0.0;
    }

    /// Shows every word of the variant, in the order of the semantics' list.
    #[inline]
    fn visit(&mut self, parts: Parts, mut show: impl FnMut(&'static str, Slot)) {
        show("mode", Slot::Mode(&mut self.supervisor.mode));
        show("fault", Slot::Fault(&mut self.supervisor.fault));
        show("countdown", Slot::Word(&mut self.supervisor.countdown));
        show("sum_a", Slot::Word(&mut self.supervisor.sum[0]));
        show("sum_b", Slot::Word(&mut self.supervisor.sum[1]));
        show("offset_a", Slot::Word(&mut self.offset[0]));
        show("offset_b", Slot::Word(&mut self.offset[1]));
        show("sector_prev", Slot::Index(&mut self.sector_prev, 6));
        if parts.has(Part::Stall) {
            show("stall_count", Slot::Word(&mut self.supervisor.stall_count));
        }
        if parts.has(Part::Direction) {
            show("direction", Slot::Word(&mut self.timing.direction));
        }
        if parts.has(Part::Rotor) {
            show("age_prev", Slot::Word(&mut self.timing.age_prev));
            show("edges", Slot::Edges(&mut self.timing.edges));
            for (name, interval) in ["t1", "t2", "t3", "t4", "t5", "t6"]
                .into_iter()
                .zip(&mut self.timing.intervals)
            {
                show(name, Slot::Word(interval));
            }
            show("rev", Slot::Word(&mut self.timing.rev));
            show("omega", Slot::Word(&mut self.omega));
        }
        if parts.has(Part::Pair) {
            show("sector_eff_prev", Slot::Index(&mut self.sector_eff_prev, 6));
            show("commutating", Slot::Flag(&mut self.commutating));
            show("commutation_age", Slot::Word(&mut self.commutation_age));
        }
        if parts.has(Part::Estimated) {
            show("i_a_prev", Slot::Word(&mut self.i_prev[0]));
            show("i_b_prev", Slot::Word(&mut self.i_prev[1]));
        }
        if parts.has(Part::VoltageCommand) {
            show("v_a_cmd", Slot::Word(&mut self.v_cmd[0]));
            show("v_b_cmd", Slot::Word(&mut self.v_cmd[1]));
        }
        if parts.has(Part::TerminalCommand) {
            show("t_a_cmd", Slot::Word(&mut self.t_cmd[0]));
            show("t_b_cmd", Slot::Word(&mut self.t_cmd[1]));
            show("t_c_cmd", Slot::Word(&mut self.t_cmd[2]));
            show("off_cmd", Slot::Index(&mut self.off_cmd, 3));
        }
        if parts.has(Part::Estimated) {
            show("v_a_prev", Slot::Word(&mut self.v_prev[0]));
            show("v_b_prev", Slot::Word(&mut self.v_prev[1]));
        }
        if parts.has(Part::EmfMemory) {
            show("e_a_prev", Slot::Word(&mut self.e_prev[0]));
            show("e_b_prev", Slot::Word(&mut self.e_prev[1]));
        }
    }

    /// Writes the words in order.
    #[inline]
    pub fn write(&self, parts: Parts, words: &mut [i32]) {
        let mut places = words.iter_mut();
        // A copy, because the one list of words lends them for writing.
        let mut state = *self;
        state.visit(parts, |_, slot| {
            if let Some(place) = places.next() {
                *place = slot.get();
            }
        });
    }

    /// Reads the words in order; words that are missing leave their part of the state as it is.
    pub fn read(&mut self, parts: Parts, words: &[i32]) {
        let mut words = words.iter();
        self.visit(parts, |_, mut slot| {
            if let Some(word) = words.next() {
                slot.set(*word);
            }
        });
    }

    /// The state in physical units.
    pub fn to_physical(self, k: &Constants) -> PhysicalState {
        let volts = |words: [f64; 2]| words.map(|word| word * k.volt);
        PhysicalState {
            supervisor: self.supervisor,
            timing: self.timing,
            sector_prev: self.sector_prev,
            sector_eff_prev: self.sector_eff_prev,
            commutating: self.commutating,
            commutation_age: self.commutation_age,
            offset: self.offset.map(|word| word / k.count),
            i_prev: self.i_prev.map(|word| word * k.ampere),
            v_cmd: volts(self.v_cmd),
            t_cmd: self.t_cmd.map(|word| word * k.volt),
            off_cmd: self.off_cmd.checked_sub(1),
            v_prev: volts(self.v_prev),
            e_prev: volts(self.e_prev),
        }
    }
}
