//! Options of predictive deadbeat current control, and how they are read.

use super::common::{LimitRule, LoopOptions, Surroundings, read_common, read_saturation};
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
    Some(PdccSpec {
        modulation,
        saturation,
        common: read_common(reader, surroundings, without_sectors, errors)?,
    })
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
