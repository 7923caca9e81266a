//! Options of predictive deadbeat current control, and how they are read.

use super::common::{
    self, DEAD_TIME_COMPENSATION, EmfSource, LimitRule, LoopOptions, Reference, Surroundings,
    read_common, read_dead_time_compensation, refuse, refuse_commutation,
};
use super::{Options, TurnsOff};
use crate::diagnostics::Collector;
use crate::diagnostics::catalogue;
use crate::spec::check::reader::Reader;
use crate::spec::options::{Row, if_on, word};
use crate::spec::rule;
use crate::spec::words::words;

words! {
    /// Modulation of the deadbeat voltage.
    pub enum Modulation {
        "three_phase" = ThreePhase: "three duties in every period",
        "pair" = Pair: "three duties in commutation, else the conducting pair only",
    }
}

/// Options of predictive deadbeat current control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdccSpec {
    /// Modulation.
    pub modulation: Modulation,
    /// Saturation rule.
    pub saturation: LimitRule,
    /// Whether an integrator corrects the modelled EMF.
    pub integral: bool,
    /// Whether compare values are compensated for the dead time.
    pub dead_time_compensation: bool,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl Options for PdccSpec {
    const KIND: &'static str = "pdcc";
    const TITLE: &'static str = "predictive deadbeat current control";
    const OWN: &'static [Row<Self>] = &[
        Row::of(
            rule::choice::<Modulation>("modulation", "three_phase")
                .preset("three_phase")
                .about("Modulation of the deadbeat voltage"),
            |options| Some(word(options.modulation)),
        ),
        Row::of(common::saturation("torque_priority"), |options| {
            Some(word(options.saturation))
        }),
        Row::of(DEAD_TIME_COMPENSATION, |options| {
            if_on(options.dead_time_compensation)
        }),
        Row::of(
            rule::choice::<bool>("integral", "on")
                .preset("off")
                .about("Whether a slow integrator corrects the modelled EMF for errors of k_b, angle, R and L; only with `emf: model`"),
            |options| if_on(options.integral),
        ),
    ];

    /// The modulation `table2` is known from the literature, but not available.
    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self> {
        let modulation = reader.choice_or_preset(errors, "modulation", &["table2"]);
        let saturation = reader.choice_or_preset(errors, "saturation", &[]);
        let without_sectors = modulation == Modulation::ThreePhase;
        let dead_time_compensation = read_dead_time_compensation(reader, surroundings, errors);
        if without_sectors {
            refuse_commutation(reader, ["modulation", "three_phase"], errors);
        }
        let common = read_common(reader, surroundings, without_sectors, errors)?;
        if common.emf == EmfSource::Held && modulation == Modulation::Pair {
            let why = "the EMF of a floating leg cannot be seen, so it cannot be held; choose `emf: estimated` or `emf: model`";
            refuse(reader, "emf", ["modulation", "pair"], why, errors);
        }
        if common.reference == Reference::Proportional
            && modulation == Modulation::Pair
            && let (Some(reference), Some(cause)) =
                (reader.field("reference"), reader.field("modulation"))
        {
            errors.push(catalogue::proportional_pair(
                &reference.location,
                &cause.location,
            ));
        }
        Some(Self {
            modulation,
            saturation,
            integral: read_integral(reader, common.emf, errors),
            dead_time_compensation,
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
        (self.modulation == Modulation::Pair).then_some(TurnsOff {
            option: "modulation",
            value: "pair",
            instead: "modulation: three_phase",
        })
    }

    fn modulates(&self) -> bool {
        true
    }
}

/// An integral needs the modelled EMF: an estimate already contains what it would add.
fn read_integral(reader: &Reader, emf: EmfSource, errors: &mut Collector) -> bool {
    let is_on = reader.switch(errors, "integral") == Some(true);
    let other = match emf {
        EmfSource::Estimated => "emf: estimated",
        EmfSource::Held => "emf: held",
        EmfSource::Model => return is_on,
    };
    if is_on && let Some(field) = reader.field("integral") {
        errors.push(catalogue::option_without_effect(
            &field.location,
            "integral",
            "on",
            reader
                .field("emf")
                .map_or(reader.location(), |field| &field.location),
            other,
            "the estimate already contains what the integral adds to `emf: model`",
        ));
    }
    is_on
}
