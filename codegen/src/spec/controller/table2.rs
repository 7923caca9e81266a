//! The modulation `table2`, of the controllers that have it.

use super::common::{self, Reference, refuse};
use crate::diagnostics::{Collector, catalogue};
use crate::spec::reader::Reader;
use crate::spec::rule::{self, Rule};
use crate::spec::words::words;

words! {
    /// Zero vector of the modulation `table2` outside commutations.
    pub enum ZeroVector {
        "all_low" = AllLow: "all legs low",
        "pair_low" = PairLow: "the sector's pair low, the third leg off",
    }
}

/// The modulation's name.
pub(crate) const TABLE2: &str = "table2";

/// The option of its zero vector.
pub(super) const ZERO: Rule = rule::choice::<ZeroVector>("zero", "all_low")
    .preset("all_low")
    .about("Zero vector outside commutations, with `modulation: table2` only");

/// Reads the option `zero`. `modulation`: the one in force.
pub(super) fn read_zero(reader: &Reader, modulation: &str, errors: &mut Collector) -> ZeroVector {
    if modulation != TABLE2 {
        let why = "only `table2` has a zero vector to choose";
        refuse(reader, "zero", ["modulation", modulation], why, errors);
    }
    reader.choice_or_preset(errors, "zero", &[])
}

/// Refuses options without effect on intervals, of which each has whole legs.
pub(super) fn refuse_pulse_options(reader: &Reader, errors: &mut Collector) {
    let setting = ["modulation", TABLE2];
    let whys = [
        (
            common::DEAD_TIME_COMPENSATION.name,
            "it shifts the edges of pulses, and an interval has none of its own",
        ),
        (
            common::COMMON_MODE.name,
            "`zero` says what the zero vector is",
        ),
    ];
    for (option, why) in whys {
        refuse(reader, option, setting, why, errors);
    }
}

/// Refuses what a quasi-square current cannot be, because of the modulation in force, which is that of a pair.
pub(super) fn refuse_turned(
    reader: &Reader,
    reference: Reference,
    modulation: &str,
    errors: &mut Collector,
) {
    if reader.switch(errors, common::FIELD_WEAKENING) == Some(true)
        && reference == Reference::QuasiSquare
    {
        let why = "the pair carries a quasi-square current, which cannot turn against the field";
        let setting = ["modulation", modulation];
        refuse(reader, common::FIELD_WEAKENING, setting, why, errors);
    }
    if reference == Reference::Proportional
        && let (Some(reference), Some(cause)) =
            (reader.field("reference"), reader.field("modulation"))
    {
        errors.push(catalogue::proportional_pair(
            &reference.location,
            modulation,
            &cause.location,
        ));
    }
}
