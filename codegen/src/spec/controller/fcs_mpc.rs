//! Options of finite-control-set model predictive control, and how they are read.

use super::common::{
    EmfSource, LoopOptions, Surroundings, read_common, refuse, refuse_commutation,
};
use super::off_leg::{OffLegModel, read_off_leg};
use crate::diagnostics::{Collector, at_most, catalogue, engineering};
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
    /// Periods that the cost looks ahead, 1 or 2. With 2 no leg floats, nothing is modulated and nothing weighs.
    pub horizon: u32,
    /// Error of current, ampere, that a leg's change of state weighs as much as; 0: nothing. Not with `modulated`.
    pub switching_weight: f64,
    /// Weight of the square of the error's component along the sector's mean EMF; 0: nothing. Not with `modulated`.
    pub torque_weight: f64,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl FcsMpcSpec {
    /// Whether pair vectors are among the candidates.
    pub fn pairs(&self) -> bool {
        self.candidates != Candidates::ThreePhase
    }

    /// Whether the cost has more than the current's error.
    pub fn weighted(&self) -> bool {
        self.switching_weight > 0.0 || self.torque_weight > 0.0
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
    let horizon = reader.integer(errors, "horizon").unwrap_or(1);
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
        .unwrap_or(if horizon == 2 {
            Candidates::ThreePhase
        } else {
            Candidates::Table2
        });
    let without_sectors = candidates == Candidates::ThreePhase;
    if without_sectors {
        refuse_commutation(reader, ["candidates", "three_phase"], errors);
    }
    let off_leg = read_off_leg(reader, without_sectors, errors);
    let modulated = reader.switch(errors, "modulated").unwrap_or(false);
    let switching_weight = read_switching_weight(reader, surroundings, errors);
    let torque_weight = reader.plain(errors, "torque_weight");
    if modulated {
        for name in ["switching_weight", "torque_weight"] {
            let why = "two vectors share the period by the current's error alone";
            refuse(reader, name, ["modulated", "on"], why, errors);
        }
    }
    if horizon == 2 {
        check_two_steps(reader, candidates, off_leg, errors);
    }
    let options = FcsMpcSpec {
        candidates,
        off_leg,
        modulated,
        horizon,
        switching_weight,
        torque_weight: torque_weight.map_or(0.0, |given| given.si),
        common: read_common(reader, surroundings, without_sectors, errors)?,
    };
    if options.common.emf == EmfSource::Held {
        check_held(reader, &options, errors);
    }
    Some(options)
}

/// A held EMF is known as part of a sum only.
fn check_held(reader: &Reader, options: &FcsMpcSpec, errors: &mut Collector) {
    if options.floating() {
        let why = "where a floating leg sits follows from its EMF; choose `off_leg: nominal` or `candidates: three_phase`";
        refuse(reader, "emf", ["off_leg", "physical"], why, errors);
    }
    let why = "the cost needs the EMF by itself; choose `emf: estimated` or `emf: model`";
    if options.torque_weight > 0.0 {
        refuse(reader, "torque_weight", ["emf", "held"], why, errors);
    }
    if options.horizon == 2 {
        refuse(reader, "horizon", ["emf", "held"], why, errors);
    }
}

/// At most what a vector moves the current by in a period, 2/3 v_bus Ts/L, rounded down: beyond it
/// no vector would follow another.
fn read_switching_weight(
    reader: &Reader,
    surroundings: &Surroundings,
    errors: &mut Collector,
) -> f64 {
    const OPTION: &str = "switching_weight";
    let Some(given) = reader.plain_quantity(errors, OPTION) else {
        return 0.0;
    };
    if let (Some(v_bus), Some(t_s), Some(inductance)) = (
        surroundings.v_bus,
        surroundings.t_s,
        surroundings.inductance,
    ) {
        let stride = at_most(2.0 / 3.0 * v_bus * t_s / inductance);
        if given.si > stride {
            errors.push(catalogue::out_of_limits(
                &given.part.location,
                OPTION,
                &given.part.given,
                "0 A",
                &format!(
                    "{}, what one vector moves the current by in a period",
                    engineering(stride, "A")
                ),
            ));
        }
    }
    given.si
}

/// Two steps are judged where the list of the second one and the voltages of its vectors are known in the first.
fn check_two_steps(
    reader: &Reader,
    candidates: Candidates,
    off_leg: OffLegModel,
    errors: &mut Collector,
) {
    let own = "a sequence of two vectors is judged by the current's error alone";
    for (name, value) in [
        ("modulated", Some("on")),
        ("switching_weight", None),
        ("torque_weight", None),
    ] {
        let is_stated = |given: String| value.is_none_or(|value| given == value);
        if reader
            .field(name)
            .is_some_and(|field| is_stated(field.value.to_string()))
        {
            refuse(reader, name, ["horizon", "2"], own, errors);
        }
    }
    let ahead = "which vectors and off legs the second period has is not known in the first; choose `candidates: three_phase`, \
                 or `all` with `off_leg: nominal`";
    match (candidates, off_leg) {
        (Candidates::Table2, _) => refuse(reader, "candidates", ["horizon", "2"], ahead, errors),
        (Candidates::All, OffLegModel::Physical) => {
            refuse(reader, "horizon", ["off_leg", "physical"], ahead, errors);
        }
        _ => {}
    }
}
