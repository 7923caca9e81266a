//! Options of predictive deadbeat current control, and how they are read.

use super::common::{
    self, CommonMode, DEAD_TIME_COMPENSATION, EmfSource, LimitRule, LoopOptions,
    ROUNDING_PREDICTION, Reference, Surroundings, Traits, compensates_by_default, read_common,
    read_common_mode, read_dead_time_compensation, read_rounding_prediction, refuse,
    refuse_commutation,
};
use super::table2::{ZERO, ZeroVector, read_zero, refuse_pulse_options, refuse_turned};
use super::{Options, TurnsOff};
use crate::diagnostics::Collector;
use crate::spec::option_row::{Row, if_on, word};
use crate::spec::reader::Reader;
use crate::spec::rule;
use crate::spec::words::{Words as _, words};

words! {
    /// Modulation of the deadbeat voltage.
    pub enum Modulation {
        "three_phase" = ThreePhase: "three duties in every period",
        "pair" = Pair: "three duties in commutation, else the conducting pair only",
        "table2" = Table2: "the paper's: two neighbouring vectors and a zero vector, three-phase ones in commutation, else pair vectors; a command of three intervals, for boards that turn legs on and off within a period",
    }
}

/// Options of predictive deadbeat current control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdccSpec {
    /// Modulation.
    pub modulation: Modulation,
    /// Zero vector outside commutations; of effect with [`Modulation::Table2`] only.
    pub zero: ZeroVector,
    /// Saturation rule.
    pub saturation: LimitRule,
    /// Whether compare values are compensated for the dead time.
    pub dead_time_compensation: bool,
    /// Whether the prediction knows the rounding of compare values.
    pub rounding_prediction: bool,
    /// Where the pulses of three legs lie; of effect with [`Modulation::ThreePhase`] only.
    pub common_mode: CommonMode,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl Options for PdccSpec {
    const KIND: &'static str = "pdcc";
    const TITLE: &'static str = "predictive deadbeat current control";
    const SHARED: &'static [&'static [Row<LoopOptions>]] =
        &[common::LOOP, common::LIMITED, common::COMMUTATION];
    const OWN: &'static [Row<Self>] = &[
        Row::of(
            rule::choice::<Modulation>("modulation", "three_phase")
                .preset("three_phase")
                .about("Modulation of the deadbeat voltage"),
            |options| Some(word(options.modulation)),
        ),
        Row::of(ZERO, |options| {
            (options.modulation == Modulation::Table2).then(|| word(options.zero))
        }),
        Row::of(
            common::saturation().by_default(
                "`nearest` with `reference: proportional`, `torque_priority` with `quasi_square`",
                &[
                    (
                        "nearest",
                        "as fast as the others with a proportional current, with least ripple",
                    ),
                    (
                        "torque_priority",
                        "highest speed limit with a quasi-square current",
                    ),
                ],
            ),
            |options| Some(word(options.saturation)),
        ),
        Row::of(DEAD_TIME_COMPENSATION, |options| {
            if_on(options.dead_time_compensation)
        }),
        Row::of(ROUNDING_PREDICTION, |options| {
            if_on(options.rounding_prediction)
        }),
        Row::of(common::COMMON_MODE, |options| {
            common::common_mode_line(options.common_mode)
        }),
    ];

    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self> {
        let modulation: Modulation = reader.choice_or_preset(errors, "modulation", &[]);
        let without_sectors = modulation == Modulation::ThreePhase;
        let compensation = read_dead_time_compensation(reader, surroundings, errors);
        if without_sectors {
            refuse_commutation(reader, ["modulation", "three_phase"], errors);
        }
        let why = "outside commutation one leg of the pair is low throughout and the third is off";
        let pair = (modulation == Modulation::Pair).then_some((["modulation", "pair"], why));
        let zero = read_zero(reader, modulation.word(), errors);
        if modulation == Modulation::Table2 {
            refuse_pulse_options(reader, errors);
        }
        let common_mode = read_common_mode(reader, surroundings, pair, errors);
        let traits = Traits {
            pulses_three_legs: without_sectors,
            advance_idle: without_sectors,
            uses_emf: true,
        };
        let saturation = reader.choice(errors, "saturation", &[]);
        let common = read_common(reader, surroundings, traits, errors)?;
        let saturation = saturation.unwrap_or_else(|| saturation_with(common.reference));
        if common.emf == EmfSource::Held && modulation == Modulation::Pair {
            let why = "the EMF of a floating leg cannot be seen, so it cannot be held; choose `emf: estimated`, `emf: model` or `emf: observer`";
            refuse(reader, "emf", ["modulation", "pair"], why, errors);
        }
        let pulses = (modulation.word(), without_sectors, common.delay);
        let rounding_prediction = read_rounding_prediction(reader, surroundings, pulses, errors);
        if !without_sectors {
            refuse_turned(reader, common.reference, modulation.word(), errors);
        }
        Some(Self {
            modulation,
            zero,
            saturation,
            dead_time_compensation: compensation
                .unwrap_or_else(|| compensates_by_default(surroundings, traits, &common)),
            rounding_prediction,
            common_mode,
            common,
        })
    }

    fn common(&self) -> &LoopOptions {
        &self.common
    }

    fn common_mut(&mut self) -> &mut LoopOptions {
        &mut self.common
    }

    fn turns_off(&self) -> Option<TurnsOff> {
        (self.modulation != Modulation::ThreePhase).then_some(TurnsOff {
            option: "modulation",
            value: self.modulation.word(),
            instead: "modulation: three_phase",
        })
    }

    fn common_mode(&self) -> Option<CommonMode> {
        (self.modulation == Modulation::ThreePhase).then_some(self.common_mode)
    }

    fn has_intervals(&self) -> bool {
        self.modulation == Modulation::Table2
    }

    fn modulates(&self) -> bool {
        true
    }
}

/// Torque priority holds the torque of a quasi-square current up to higher speeds. A proportional
/// current reaches as far with the nearest voltage, and ripples less where the bus ends the torque.
fn saturation_with(reference: Reference) -> LimitRule {
    match reference {
        Reference::Proportional => LimitRule::Nearest,
        Reference::QuasiSquare => LimitRule::TorquePriority,
    }
}
