//! State words of the shared step, each only where the variant needs it.

use super::CurrentLoop;
use crate::blocks::set_point::SetPointWords;
use crate::blocks::{CommutationRule, RotorWords, SpeedRegulator, direction_word, sector_word};
use crate::ir::{Interval, Memory};
use crate::spec::{EmfSource, Reference};

/// What a law needs of the step around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Whether a commutation is going on.
    pub commutation: bool,
    /// The real voltage of a leg that it turned off.
    pub off_leg: bool,
    /// The EMF.
    pub emf: EmfUse,
    /// What the modelled EMF lacks, integrated.
    pub integral: bool,
    /// Greatest magnitude of what the law itself adds to the folded words, words of voltage; 0 where it adds nothing.
    pub memory: i64,
}

impl Needs {
    /// Whether the law predicts the current at the end of the period that begins now.
    pub fn predicts(self) -> bool {
        matches!(self.emf, EmfUse::Prediction | EmfUse::Deadbeat)
    }
}

/// What a law uses the EMF for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmfUse {
    /// Nothing.
    None,
    /// It is added to the voltage.
    FeedForward,
    /// It takes part in the prediction of the current at the end of the period that begins now.
    Prediction,
    /// Besides, it is part of the voltage that the law asks for then.
    Deadbeat,
}

/// Numbers of a leg: 1 a, 2 b, 3 c, 0 none.
const LEGS: Interval = Interval { low: 0, high: 3 };

/// State words of the shared step.
pub struct Words<'b> {
    /// Sector of the last sample, where anything follows the edges.
    pub sector_prev: Option<Memory<'b>>,
    /// Direction of rotation, where no rotor words hold it.
    pub direction: Option<Memory<'b>>,
    /// Timing of Hall edges.
    pub rotor: Option<RotorWords<'b>>,
    /// The speed regulator.
    pub speed: Option<SpeedRegulator<'b>>,
    /// Commutation.
    pub pair: Option<CommutationRule<'b>>,
    /// Current of the last sample.
    pub i_prev: Option<[Memory<'b>; 2]>,
    /// Commanded voltage.
    pub v_cmd: Option<[Memory<'b>; 2]>,
    /// Commanded terminals and the leg that is off.
    pub t_cmd: Option<([Memory<'b>; 3], Memory<'b>)>,
    /// Voltage of the period that ended.
    pub v_prev: Option<[Memory<'b>; 2]>,
    /// The leg that was off in the period that ended.
    pub off_prev: Option<Memory<'b>>,
    /// EMF expected of the period that ended.
    pub e_prev: Option<[Memory<'b>; 2]>,
    /// What the modelled EMF lacks.
    pub integral: Option<[Memory<'b>; 2]>,
}

impl<'b> CurrentLoop<'_, 'b> {
    /// Whether the law looks at an EMF of this source.
    fn uses(&self, source: EmfSource) -> bool {
        self.needs.emf != EmfUse::None && self.options.emf == source
    }

    /// Whether anything follows the rotor's angle or speed.
    fn needs_rotor(&self) -> bool {
        self.uses(EmfSource::Model)
            || self.options.advance > 0.0
            || self.options.reference == Reference::Proportional
            || self.options.speed.is_some()
    }

    pub(super) fn declare(&self, set_point: &SetPointWords<'b>) -> Words<'b> {
        let (l, options, needs) = (self.l, self.options, self.needs);
        let estimated = self.uses(EmfSource::Estimated);
        let needs_rotor = self.needs_rotor();
        // What a period shows of its EMF takes part.
        let sees = estimated || needs.integral;
        let e_bound = self.e_bound();
        let e_moves = if estimated {
            self.motion_bound(e_bound)
        } else {
            0
        };
        let volts = Interval::symmetric(l.bus_interval().high);
        let is_delayed = options.delay == 1;
        let needs_command = is_delayed && !needs.off_leg && !self.holds_emf();
        Words {
            sector_prev: (needs_rotor || needs.commutation).then(|| sector_word(l)),
            rotor: needs_rotor.then(|| RotorWords::new(l)),
            direction: (needs.commutation && !needs_rotor).then(|| direction_word(l)),
            speed: options.speed.zip(set_point.speed).map(|(options, words)| {
                SpeedRegulator::new(l, options, words, set_point.gain.value)
            }),
            pair: needs.commutation.then(|| self.commutation_rule()),
            i_prev: sees.then(|| {
                let range = Interval::symmetric(l.current_span());
                let doc = "Current of the last sample, words of current.";
                l.memories(["i_a_prev", "i_b_prev"], range, doc)
            }),
            v_cmd: (needs_command && (needs.predicts() || sees)).then(|| {
                let doc = "Limited voltage of the last step, applied in this period.";
                l.memories(["v_a_cmd", "v_b_cmd"], volts, doc)
            }),
            t_cmd: (is_delayed && needs.off_leg).then(|| self.terminal_words()),
            v_prev: sees.then(|| {
                let doc = "Voltage applied in the last period.";
                l.memories(["v_a_prev", "v_b_prev"], volts, doc)
            }),
            off_prev: (estimated && needs.off_leg).then(|| {
                let doc = "Off leg of the last period: 1 a, 2 b, 3 c, 0 none.";
                l.b.memory("off_prev", 0, LEGS, doc)
            }),
            e_prev: (needs.integral || estimated && options.emf_filter < 1.0).then(|| {
                let range = Interval::symmetric(e_bound + e_moves);
                let doc = "EMF that the last step expected for the period that has ended.";
                l.memories(["e_a_prev", "e_b_prev"], range, doc)
            }),
            integral: needs.integral.then(|| {
                let doc = "Error of the modelled EMF, integrated, words of voltage.";
                l.memories(["integral_a", "integral_b"], volts, doc)
            }),
        }
    }

    fn commutation_rule(&self) -> CommutationRule<'b> {
        let options = self.options;
        let (threshold, timeout) = (options.commutation_threshold, options.commutation_timeout);
        CommutationRule::new(self.l, threshold, timeout, options.advance > 0.0)
    }

    /// Terminals of the last command, and the leg that it turns off.
    fn terminal_words(&self) -> ([Memory<'b>; 3], Memory<'b>) {
        let l = self.l;
        let range = Interval::new(0, l.bus_interval().high);
        let doc = "Terminal voltage of the last step's command; of an off leg 0.";
        let terminals = ["t_a_cmd", "t_b_cmd", "t_c_cmd"];
        let terminals = terminals.map(|name| l.b.memory(name, 0, range, doc));
        let doc = "Leg that the last step's command turns off: 1 a, 2 b, 3 c, 0 none.";
        (terminals, l.b.memory("off_cmd", 0, LEGS, doc))
    }
}
