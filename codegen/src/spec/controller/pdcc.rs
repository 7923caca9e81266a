//! Options of predictive deadbeat current control, and how they are read.

use super::common::{
    EmfSource, LimitRule, LoopOptions, Reference, Surroundings, read_common,
    read_dead_time_compensation, read_saturation, refuse, refuse_commutation,
};
use crate::diagnostics::Collector;
use crate::diagnostics::catalogue;
use crate::spec::check::reader::Reader;

/// How the deadbeat voltage becomes leg commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modulation {
    /// Three duties in every period.
    ThreePhase,
    /// Three duties in commutation, else only the conducting pair is pulsed.
    Pair,
}

/// Options of predictive deadbeat current control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdccSpec {
    /// Modulation.
    pub modulation: Modulation,
    /// Saturation rule.
    pub saturation: LimitRule,
    /// Whether what the modelled EMF lacks is integrated.
    pub integral: bool,
    /// Whether compare values are shifted against the dead time.
    pub dead_time_compensation: bool,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

/// Reads and checks the options. None only together with an error.
pub(crate) fn check_options(
    reader: &Reader,
    surroundings: &Surroundings,
    errors: &mut Collector,
) -> Option<PdccSpec> {
    let modulation = read_modulation(reader, errors).unwrap_or(Modulation::ThreePhase);
    let saturation = read_saturation(reader, errors).unwrap_or(LimitRule::TorquePriority);
    let without_sectors = modulation == Modulation::ThreePhase;
    let dead_time_compensation = read_dead_time_compensation(reader, surroundings, errors);
    if without_sectors {
        refuse_commutation(reader, ["modulation", "three_phase"], errors);
    }
    let common = read_common(reader, surroundings, without_sectors, errors)?;
    if common.emf == EmfSource::Held && modulation == Modulation::Pair {
        let why = "a leg that floats shows nothing of its EMF, so none can be held; choose `emf: estimated` or `emf: model`";
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
    Some(PdccSpec {
        modulation,
        saturation,
        integral: read_integral(reader, common.emf, errors),
        dead_time_compensation,
        common,
    })
}

/// An integral needs the modelled EMF: an estimate finds by itself what it would.
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
            "the estimate finds by itself what the integral adds to `emf: model`",
        ));
    }
    is_on
}

/// `table2` is a modulation of this controller in the literature, but not in this version.
fn read_modulation(reader: &Reader, errors: &mut Collector) -> Option<Modulation> {
    const AVAILABLE: [&str; 2] = ["three_phase", "pair"];
    let choices = [
        ("three_phase", Some(Modulation::ThreePhase)),
        ("pair", Some(Modulation::Pair)),
        ("table2", None),
    ];
    let choice = reader.word(errors, "modulation", &choices)?;
    if choice.is_none()
        && let Some(field) = reader.field("modulation")
    {
        errors.push(catalogue::option_unavailable(
            &field.location,
            "modulation",
            "table2",
            &AVAILABLE,
        ));
    }
    choice
}
