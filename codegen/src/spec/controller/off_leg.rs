//! The option `off_leg`, of controllers that apply whole vectors.

use crate::diagnostics::{Collector, catalogue};
use crate::spec::check::reader::Reader;

/// Where the prediction takes the terminal of a leg to be that a pair vector turns off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffLegModel {
    /// Where its diodes or its EMF put it.
    Physical,
    /// Midway, as Table 2's vectors have it.
    Nominal,
}

/// Reads the option `off_leg`; physical by default. `three_phase` says that all candidates drive all legs.
pub(super) fn read_off_leg(
    reader: &Reader,
    three_phase: bool,
    errors: &mut Collector,
) -> OffLegModel {
    let given = reader.word(
        errors,
        "off_leg",
        &[
            ("physical", OffLegModel::Physical),
            ("nominal", OffLegModel::Nominal),
        ],
    );
    if three_phase && let (Some(_), Some(field)) = (given, reader.field("off_leg")) {
        errors.push(catalogue::option_without_effect(
            &field.location,
            "off_leg",
            &field.value.to_string(),
            reader
                .field("candidates")
                .map_or(reader.location(), |field| &field.location),
            "candidates: three_phase",
            "these vectors turn no leg off",
        ));
    }
    given.unwrap_or(OffLegModel::Physical)
}
