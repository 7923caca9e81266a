//! Options of finite-control-set model predictive control, and how they are read.

use super::common::{LoopOptions, Surroundings, read_common};
use super::off_leg::{OffLegModel, read_off_leg};
use crate::diagnostics::Collector;
use crate::spec::check::reader::Reader;

/// The vectors among which the controller chooses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Candidates {
    /// Table 2's: V0 to V6 in commutation, else V0 and V12 to V61.
    Table2,
    /// V0 to V6 always.
    ThreePhase,
    /// V0 to V6 and V12 to V61 always.
    All,
}

/// Options of finite-control-set model predictive control.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FcsMpcSpec {
    /// Candidate set.
    pub candidates: Candidates,
    /// Model of an off leg; of no effect with [`Candidates::ThreePhase`].
    pub off_leg: OffLegModel,
    /// Whether a second vector shares the period with the chosen one.
    pub modulated: bool,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl FcsMpcSpec {
    /// Whether pair vectors are among the candidates.
    pub fn pairs(&self) -> bool {
        self.candidates != Candidates::ThreePhase
    }

    /// Whether a command may turn a leg off whose real voltage the prediction follows.
    pub fn floating(&self) -> bool {
        self.pairs() && self.off_leg == OffLegModel::Physical
    }
}

/// Reads and checks the options. None only together with an error.
pub(crate) fn check_options(
    reader: &Reader,
    surroundings: &Surroundings,
    errors: &mut Collector,
) -> Option<FcsMpcSpec> {
    let candidates = reader
        .word(
            errors,
            "candidates",
            &[
                ("table2", Candidates::Table2),
                ("three_phase", Candidates::ThreePhase),
                ("all", Candidates::All),
            ],
        )
        .unwrap_or(Candidates::Table2);
    let without_sectors = candidates == Candidates::ThreePhase;
    let off_leg = read_off_leg(reader, without_sectors, errors);
    let modulated = reader.switch(errors, "modulated");
    Some(FcsMpcSpec {
        candidates,
        off_leg,
        modulated: modulated.unwrap_or(false),
        common: read_common(reader, surroundings, without_sectors, errors)?,
    })
}
