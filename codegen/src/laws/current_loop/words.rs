//! State words of the shared step, each only if the variant needs it.

use super::CurrentLoop;
use super::residual::ResidualWatch;
use crate::blocks::set_point::SetPointWords;
use crate::blocks::{
    AngleWords, BusCurrentLimit, BusFade, CommutationRule, FieldWeakening, RotorWords, SlewLimit,
    SpeedRegulator, TorqueLearning, direction_word, sector_word,
};
use crate::ir::{Interval, Memory};
use crate::spec::{EmfSource, Reference};

/// Needs of a law from the shared step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Commutation state.
    pub commutation: bool,
    /// Real terminal voltage of an off leg.
    pub off_leg: bool,
    /// The EMF.
    pub emf: EmfUse,
    /// Greatest magnitude of the law's own contribution to the folded words, words of voltage.
    pub memory: i64,
    /// Whether voltages are remembered as compare values make them, up to a count beyond the bus.
    pub rounding: bool,
}

impl Needs {
    /// Whether the law predicts the current at the end of the period that begins now.
    pub fn predicts(self) -> bool {
        matches!(self.emf, EmfUse::Prediction | EmfUse::Deadbeat)
    }
}

/// Use of the EMF in a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmfUse {
    /// Nothing.
    None,
    /// Added to the voltage.
    FeedForward,
    /// Prediction of the current at the end of the present period.
    Prediction,
    /// Prediction, and the deadbeat voltage of the target period.
    Deadbeat,
}

/// Numbers of a leg: 1 a, 2 b, 3 c, 0 none.
const LEGS: Interval = Interval { low: 0, high: 3 };

/// State words of the shared step.
pub struct Words<'b> {
    /// Sector of the last sample; if its changes are used.
    pub sector_prev: Option<Memory<'b>>,
    /// Direction of rotation; where neither edges nor angles tell the speed.
    pub direction: Option<Memory<'b>>,
    /// Timing of Hall edges.
    pub rotor: Option<RotorWords<'b>>,
    /// Speed from a sensor's angles.
    pub angle: Option<AngleWords<'b>>,
    /// The speed regulator.
    pub speed: Option<SpeedRegulator<'b>>,
    /// Fade of the set-point with the bus voltage.
    pub fade: Option<BusFade>,
    /// Slew rate of the set-point.
    pub slew: Option<SlewLimit<'b>>,
    /// Limits of the bus current.
    pub bus_current: Option<BusCurrentLimit<'b>>,
    /// Commutation.
    pub pair: Option<CommutationRule<'b>>,
    /// Current of the last sample.
    pub i_prev: Option<[Memory<'b>; 2]>,
    /// Commanded voltage.
    pub v_cmd: Option<[Memory<'b>; 2]>,
    /// Commanded terminals and the leg that is off.
    pub t_cmd: Option<([Memory<'b>; 3], Memory<'b>)>,
    /// Voltage of the last period.
    pub v_prev: Option<[Memory<'b>; 2]>,
    /// Off leg of the last period.
    pub off_prev: Option<Memory<'b>>,
    /// EMF expected for the last period; of an estimate.
    pub e_prev: Option<[Memory<'b>; 2]>,
    /// The EMF observer.
    pub observer: Option<ObserverWords<'b>>,
    /// Field weakening.
    pub weakening: Option<FieldWeakening<'b>>,
    /// Residual watch.
    pub residual: Option<ResidualWatch<'b>>,
    /// Learning of the torque constant.
    pub torque: Option<TorqueLearning<'b>>,
}

/// Memory of the EMF observer.
#[derive(Clone, Copy, Debug)]
pub struct ObserverWords<'b> {
    /// EMF expected of the period that begins now; for commands that may turn a leg off.
    pub e_next: Option<[Memory<'b>; 2]>,
    /// Net voltage of the last period.
    pub net_prev: [Memory<'b>; 2],
    /// Net voltage of the period that begins now; for commands that drive every leg.
    pub net_next: Option<[Memory<'b>; 2]>,
    /// Error of the modelled EMF, q and d.
    pub emf_error: [Memory<'b>; 2],
}

impl<'b> CurrentLoop<'_, 'b> {
    /// Whether the law uses an EMF of this source.
    fn uses(&self, source: EmfSource) -> bool {
        self.needs.emf != EmfUse::None && self.options.emf == source
    }

    /// Whether the law uses the rotor's angle.
    pub(super) fn uses_angle(&self) -> bool {
        self.needs.emf != EmfUse::None && self.options.emf.is_modelled()
            || self.options.advance > 0.0
            || self.options.reference == Reference::Proportional
    }

    /// Whether the drive uses the rotor's angle or speed.
    fn needs_rotor(&self) -> bool {
        self.uses_angle()
            || self.options.speed.is_some()
            || self.l.spec.inverter.over_speed.is_some()
    }

    /// Greatest magnitude of a remembered voltage, words.
    pub(super) fn volts_bound(&self) -> i64 {
        let count = i64::from(self.needs.rounding) << self.l.scale.voltage_bits;
        self.l.bus_interval().high + count
    }

    /// Whether the law observes the error of the modelled EMF.
    pub(super) fn observes(&self) -> bool {
        self.uses(EmfSource::Observer)
    }

    pub(super) fn declare(&self, set_point: &SetPointWords<'b>) -> Words<'b> {
        let (l, options, needs) = (self.l, self.options, self.needs);
        let (estimated, observes) = (self.uses(EmfSource::Estimated), self.observes());
        let needs_rotor = self.needs_rotor();
        let sensor = l.spec.angle_sensor();
        let needs_edges = needs_rotor && sensor.is_none();
        let angle = sensor.filter(|_| needs_rotor);
        let fade = BusFade::new(l, set_point);
        let needs_direction = needs.commutation || fade.is_some();
        // The EMF of the last period is computed.
        let sees = estimated || observes;
        let e_bound = self.e_bound();
        let e_moves = if estimated {
            self.motion_bound(e_bound)
        } else {
            0
        };
        let volts = Interval::symmetric(self.volts_bound());
        let is_delayed = options.delay == 1;
        let needs_command = is_delayed && !needs.off_leg && !self.holds_emf() && !observes;
        Words {
            sector_prev: (needs_edges || needs_direction).then(|| sector_word(l)),
            rotor: needs_edges.then(|| RotorWords::new(l)),
            angle: angle.map(|sensor| AngleWords::new(l, sensor)),
            direction: (needs_direction && !needs_rotor).then(|| direction_word(l)),
            speed: self.speed_regulator(set_point),
            fade,
            slew: options
                .slew_rate
                .map(|rate| SlewLimit::new(l, rate, set_point)),
            bus_current: BusCurrentLimit::new(l, options.delay, set_point),
            pair: needs.commutation.then(|| self.commutation_rule()),
            i_prev: sees.then(|| self.current_words()),
            v_cmd: (needs_command && (needs.predicts() || sees)).then(|| {
                let doc = "Voltage that the last step commanded, applied in this period.";
                l.memories(["v_a_cmd", "v_b_cmd"], volts, doc)
            }),
            t_cmd: (is_delayed && needs.off_leg).then(|| self.terminal_words()),
            v_prev: estimated.then(|| {
                let doc = "Voltage applied in the last period.";
                l.memories(["v_a_prev", "v_b_prev"], volts, doc)
            }),
            off_prev: (estimated && needs.off_leg).then(|| self.off_leg_word()),
            e_prev: (estimated && options.emf_filter < 1.0).then(|| {
                let range = Interval::symmetric(e_bound + e_moves);
                let doc = "EMF that the last step expected for the last period.";
                l.memories(["e_a_prev", "e_b_prev"], range, doc)
            }),
            observer: observes.then(|| self.observer_words(e_bound)),
            weakening: (options.field_weakening).then(|| FieldWeakening::new(l, set_point)),
            residual: (options.residual_periods)
                .map(|periods| ResidualWatch::new(l, periods, set_point)),
            torque: (options.learning.torque).then(|| TorqueLearning::new(l, set_point)),
        }
    }

    fn speed_regulator(&self, set_point: &SetPointWords<'b>) -> Option<SpeedRegulator<'b>> {
        let (options, words) = (self.options.speed?, set_point.speed?);
        Some(SpeedRegulator::new(self.l, options, words, set_point))
    }

    fn observer_words(&self, e_bound: i64) -> ObserverWords<'b> {
        let (l, has_off_leg) = (self.l, self.needs.off_leg);
        let is_delayed = self.options.delay == 1;
        let nets = Interval::symmetric(self.volts_bound() + e_bound);
        ObserverWords {
            e_next: (is_delayed && has_off_leg).then(|| {
                let range = Interval::symmetric(e_bound);
                let doc = "EMF that the last step expected for the period that begins now.";
                l.memories(["e_a_next", "e_b_next"], range, doc)
            }),
            net_prev: {
                let doc = "Net voltage of the last period: the one applied less the EMF that was expected.";
                l.memories(["net_a_prev", "net_b_prev"], nets, doc)
            },
            net_next: (is_delayed && !has_off_leg).then(|| {
                let doc = "Net voltage of the period that begins now: the last step's voltage less the EMF that it expected.";
                l.memories(["net_a_next", "net_b_next"], nets, doc)
            }),
            emf_error: self.emf_error_words(),
        }
    }

    fn commutation_rule(&self) -> CommutationRule<'b> {
        let options = self.options;
        let (threshold, timeout) = (options.commutation_threshold, options.commutation_timeout);
        CommutationRule::new(self.l, threshold, timeout, options.advance > 0.0)
    }

    /// Currents of the last sample.
    fn current_words(&self) -> [Memory<'b>; 2] {
        let range = Interval::symmetric(self.l.current_span());
        let doc = "Current of the last sample, words of current.";
        self.l.memories(["i_a_prev", "i_b_prev"], range, doc)
    }

    fn off_leg_word(&self) -> Memory<'b> {
        let doc = "Off leg of the last period: 1 a, 2 b, 3 c, 0 none.";
        self.l.b.memory("off_prev", 0, LEGS, doc)
    }

    /// Error of the modelled EMF, q and d.
    fn emf_error_words(&self) -> [Memory<'b>; 2] {
        let limit = self.emf_error_limit();
        let range = Interval::new(-limit, limit - 1);
        let doc = "Error of the modelled EMF in the rotor frame: q along the proportional current, d across \
            it over sqrt(3); words of voltage.";
        self.l.memories(["e_error_q", "e_error_d"], range, doc)
    }

    /// Terminal voltages and off leg of the last command.
    fn terminal_words(&self) -> ([Memory<'b>; 3], Memory<'b>) {
        let l = self.l;
        let range = Interval::new(0, l.bus_interval().high);
        let doc = "Terminal voltage of the last step's command; 0 of an off leg.";
        let terminals = ["t_a_cmd", "t_b_cmd", "t_c_cmd"];
        let terminals = terminals.map(|name| l.b.memory(name, 0, range, doc));
        let doc = "Off leg of the last step's command: 1 a, 2 b, 3 c, 0 none.";
        (terminals, l.b.memory("off_cmd", 0, LEGS, doc))
    }
}
