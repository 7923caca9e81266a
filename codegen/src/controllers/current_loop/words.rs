//! State words of the shared step, each only where the variant needs it.

use super::CurrentLoop;
use crate::ir::{Interval, StateId};
use crate::lower::set_point::SetPointWords;
use crate::lower::{PairModulation, RotorWords, SpeedState};
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

/// State words of the shared step.
pub struct Words {
    /// Sector of the last sample, where anything follows the edges.
    pub sector_prev: Option<StateId>,
    /// Direction of rotation, where no rotor words hold it.
    pub direction: Option<StateId>,
    /// Timing of Hall edges.
    pub rotor: Option<RotorWords>,
    /// The speed regulator.
    pub speed: Option<SpeedState>,
    /// Commutation.
    pub pair: Option<PairModulation>,
    /// Current of the last sample.
    pub i_prev: Option<[StateId; 2]>,
    /// Commanded voltage.
    pub v_cmd: Option<[StateId; 2]>,
    /// Commanded terminals and the leg that is off.
    pub t_cmd: Option<([StateId; 3], StateId)>,
    /// Voltage of the period that ended.
    pub v_prev: Option<[StateId; 2]>,
    /// The leg that was off in the period that ended.
    pub off_prev: Option<StateId>,
    /// EMF expected of the period that ended.
    pub e_prev: Option<[StateId; 2]>,
    /// What the modelled EMF lacks.
    pub integral: Option<[StateId; 2]>,
}

impl CurrentLoop<'_, '_> {
    pub(super) fn declare(&mut self, set_point: SetPointWords) -> Words {
        let (options, needs) = (*self.options, self.needs);
        let needs_rotor = (needs.emf != EmfUse::None && options.emf == EmfSource::Model)
            || options.advance > 0.0
            || options.reference == Reference::Proportional
            || options.speed.is_some();
        let estimated = needs.emf != EmfUse::None && options.emf == EmfSource::Estimated;
        let holds = self.holds_emf();
        // What a period shows of its EMF takes part.
        let sees = estimated || needs.integral;
        let e_bound = self.e_bound();
        let moves = if estimated {
            self.motion_bound(e_bound)
        } else {
            0
        };
        let e_expected = e_bound + moves;
        let l = &mut *self.lowering;
        let current = Interval::symmetric(l.current_span());
        let bus = l.bus_interval().high;
        let volts = Interval::symmetric(bus);
        let sector_prev = (needs_rotor || needs.commutation).then(|| l.sector_word());
        let rotor = needs_rotor.then(|| l.rotor_words());
        let direction = (needs.commutation && !needs_rotor).then(|| l.direction_word());
        let speed = set_point.speed.map(|words| l.speed_state(words.top));
        let pair_words = needs
            .commutation
            .then(|| l.pair_words(options.commutation_timeout, options.advance > 0.0));
        let i_prev = sees.then(|| {
            ["i_a_prev", "i_b_prev"].map(|name| {
                l.state(
                    name,
                    0,
                    current,
                    "Current of the last sample, words of current.",
                )
            })
        });
        let v_cmd = (options.delay == 1 && !needs.off_leg && !holds && (needs.predicts() || sees))
            .then(|| {
                ["v_a_cmd", "v_b_cmd"].map(|name| {
                    l.state(
                        name,
                        0,
                        volts,
                        "Limited voltage of the last step, applied during this period.",
                    )
                })
            });
        let t_cmd = (options.delay == 1 && needs.off_leg).then(|| {
            let terminals = ["t_a_cmd", "t_b_cmd", "t_c_cmd"].map(|name| {
                l.state(
                    name,
                    0,
                    Interval::new(0, bus),
                    "Terminal voltage of the last step's command; of an off leg 0.",
                )
            });
            (
                terminals,
                l.state(
                    "off_cmd",
                    0,
                    Interval::new(0, 3),
                    "Leg that the last step's command turns off: 1 a, 2 b, 3 c, 0 none.",
                ),
            )
        });
        let v_prev = sees.then(|| {
            ["v_a_prev", "v_b_prev"].map(|name| {
                l.state(
                    name,
                    0,
                    volts,
                    "Voltage applied during the period that just ended.",
                )
            })
        });
        let off_prev = (estimated && needs.off_leg).then(|| {
            l.state(
                "off_prev",
                0,
                Interval::new(0, 3),
                "Leg that was off during the period that just ended: 1 a, 2 b, 3 c, 0 none.",
            )
        });
        let e_prev = (needs.integral || estimated && options.emf_filter < 1.0).then(|| {
            ["e_a_prev", "e_b_prev"].map(|name| {
                l.state(
                    name,
                    0,
                    Interval::symmetric(e_expected),
                    "EMF that the last step expects of the period that it began.",
                )
            })
        });
        let integral = needs.integral.then(|| {
            ["integral_a", "integral_b"].map(|name| {
                let doc = "What the modelled EMF lacks, words of voltage.";
                l.state(name, 0, volts, doc)
            })
        });
        Words {
            sector_prev,
            direction,
            rotor,
            speed,
            pair: pair_words,
            i_prev,
            v_cmd,
            t_cmd,
            v_prev,
            off_prev,
            e_prev,
            integral,
        }
    }
}
