//! The option `off_leg` of controllers that apply whole vectors.

use super::common::refuse;
use crate::diagnostics::Collector;
use crate::spec::ast::Value;
use crate::spec::reader::Reader;
use crate::spec::rule::{self, Rule};
use crate::spec::words::words;

words! {
    /// Terminal voltage, in the prediction, of a leg that a pair vector turns off.
    pub enum OffLegModel {
        "physical" = Physical: "set by its diodes or its EMF",
        "nominal" = Nominal: "half the bus voltage, as in Table 2",
    }
}

/// The option's rule.
pub(super) const OFF_LEG: Rule = rule::choice::<OffLegModel>("off_leg", "physical")
    .preset("physical")
    .about("Voltage of an off leg in the prediction");

/// Reads the option `off_leg`; physical by default. `three_phase`: all candidates drive all legs.
pub(super) fn read_off_leg(
    reader: &Reader,
    three_phase: bool,
    errors: &mut Collector,
) -> OffLegModel {
    let model = reader.choice_or_preset(errors, "off_leg", &[]);
    if three_phase
        && let Some(field) = reader.field("off_leg")
        && let Value::Word(_) = field.value
    {
        let why = "these candidates turn no leg off";
        refuse(
            reader,
            "off_leg",
            ["candidates", "three_phase"],
            why,
            errors,
        );
    }
    model
}
