//! Options of predictive hysteresis control, and how they are read.

use super::common::{EmfSource, LoopOptions, Surroundings, read_common, refuse};
use super::off_leg::{OffLegModel, read_off_leg};
use crate::diagnostics::Collector;
use crate::diagnostics::catalogue;
use crate::spec::ast::Value;
use crate::spec::check::reader::Reader;

/// Entries of a switching table that the specification gives: 6 sectors, 2 states, 4 wishes.
pub(crate) const GIVEN: usize = 48;

/// Share of the rated current that the band has by default.
const BAND: f64 = 0.025;

/// Where the switching table comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchingTable {
    /// From the geometry of the vectors.
    Derived,
    /// The row that the paper prints, turned through the sectors; it loses the current.
    Printed,
    /// As the specification lists it: vector numbers by sector, commutation, H_a, H_b.
    Given([u8; GIVEN]),
}

/// The vectors among which the derived table chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PhccCandidates {
    /// V0 to V6 in commutation, else the sector's pair, its reverse and its zero.
    Table2,
    /// V0 to V6 always.
    ThreePhase,
}

/// Options of predictive hysteresis control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhccSpec {
    /// Switching table.
    pub table: SwitchingTable,
    /// Half width of the bands, ampere.
    pub band: f64,
    /// Vectors of the derived table.
    pub candidates: PhccCandidates,
    /// Model of an off leg; of no effect with [`PhccCandidates::ThreePhase`].
    pub off_leg: OffLegModel,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl PhccSpec {
    /// Whether a command may turn a leg off whose real voltage the prediction follows.
    pub fn floating(&self) -> bool {
        self.common.delay == 1
            && self.candidates == PhccCandidates::Table2
            && self.off_leg == OffLegModel::Physical
    }
}

/// Reads and checks the options. None only together with an error.
pub(crate) fn check_options(
    reader: &Reader,
    surroundings: &Surroundings,
    errors: &mut Collector,
) -> Option<PhccSpec> {
    let table = read_table(reader, errors);
    let candidates = reader
        .word(
            errors,
            "candidates",
            &[
                ("table2", PhccCandidates::Table2),
                ("three_phase", PhccCandidates::ThreePhase),
            ],
        )
        .unwrap_or(PhccCandidates::Table2);
    if table != Some(SwitchingTable::Derived)
        && candidates == PhccCandidates::ThreePhase
        && let (Some(field), Some(cause)) = (reader.field("candidates"), reader.field("table"))
    {
        errors.push(catalogue::option_without_effect(
            &field.location,
            "candidates",
            "three_phase",
            &cause.location,
            "a table that is not derived",
            "it says among which vectors the derivation chooses",
        ));
    }
    let three_phase = candidates == PhccCandidates::ThreePhase;
    let off_leg = read_off_leg(reader, three_phase, errors);
    let given = reader.plain_quantity(errors, "band");
    let common = read_common(reader, surroundings, false, errors)?;
    let floats = !three_phase && off_leg == OffLegModel::Physical && common.delay == 1;
    if common.emf == EmfSource::Held && floats {
        let why = "a leg that floats shows nothing of its EMF, so none can be held; choose `off_leg: nominal` or `candidates: three_phase`";
        refuse(reader, "emf", ["off_leg", "physical"], why, errors);
    }
    if common.delay == 0 {
        let why = "without delay the present current is compared, and nothing is predicted";
        for name in ["emf", "emf_filter", "off_leg"] {
            refuse(reader, name, ["delay", "0"], why, errors);
        }
    }
    let (rated, rated_part) = surroundings.rated_current.as_ref()?;
    let band = given.as_ref().map_or(BAND * rated, |given| given.si);
    if let Some(given) = &given
        && band >= *rated
    {
        errors.push(catalogue::band_above_rated(&given.part, rated_part));
    }
    Some(PhccSpec {
        table: table?,
        band,
        candidates,
        off_leg,
        common,
    })
}

/// The table; derived by default. None together with an error.
fn read_table(reader: &Reader, errors: &mut Collector) -> Option<SwitchingTable> {
    let Some(field) = reader.field("table") else {
        return Some(SwitchingTable::Derived);
    };
    let Value::Integers(list) = &field.value else {
        return reader.word(
            errors,
            "table",
            &[
                ("derived", SwitchingTable::Derived),
                ("printed", SwitchingTable::Printed),
            ],
        );
    };
    let numbers: Vec<u8> = list
        .iter()
        .filter_map(|&number| u8::try_from(number).ok().filter(|&number| number < 16))
        .collect();
    match <[u8; GIVEN]>::try_from(numbers) {
        Ok(numbers) if list.len() == GIVEN => Some(SwitchingTable::Given(numbers)),
        _ => {
            let wrong = list.iter().position(|number| !(0..16).contains(number));
            errors.push(catalogue::switching_table(
                &field.location,
                list.len(),
                wrong.map(|index| (index + 1, list[index])),
            ));
            None
        }
    }
}
