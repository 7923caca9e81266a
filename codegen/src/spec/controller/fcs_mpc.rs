//! Options of finite-control-set model predictive control, and how they are read.

use super::Options;
use super::common::{
    EmfSource, LoopOptions, Surroundings, read_common, refuse, refuse_commutation,
};
use super::off_leg::{OFF_LEG, OffLegModel, read_off_leg};
use crate::diagnostics::{Collector, at_most, catalogue, engineering};
use crate::spec::check::reader::Reader;
use crate::spec::health::Drive;
use crate::spec::options::{Row, if_any, number, word};
use crate::spec::rule;
use crate::spec::units::Dimension as D;
use crate::spec::words::words;

words! {
    /// The vectors among which the controller chooses.
    pub enum Candidates {
        "table2" = Table2: "Table 2's: V0 to V6 in commutation, else V0 and V12 to V61",
        "three_phase" = ThreePhase: "V0 to V6 always",
        "all" = All: "V0 to V6 and V12 to V61 always",
    }
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

impl Options for FcsMpcSpec {
    const KIND: &'static str = "fcs-mpc";
    const TITLE: &'static str = "finite-control-set model predictive control";
    const NOTES: &'static str = "Refused where one vector moves the current by more than the rated current in a period, unless modulated.";
    const OWN: &'static [Row<Self>] = &[
        Row::of(
            rule::choice::<Candidates>("candidates", "table2")
                .by_default("`table2`; with `horizon: 2` `three_phase`")
                .about("The vectors among which the controller chooses"),
            |options| Some(word(options.candidates)),
        ),
        Row::of(OFF_LEG, |options| Some(word(options.off_leg))),
        Row::of(
            rule::choice::<bool>("modulated", "off")
                .preset("off")
                .about("Whether the vector shares its period with the best other one, each for the time of the least predicted error. Three compare values and one state per leg allow what differs in one direction: V0 and any of V1 to V6, two neighbours of these, a pair vector and its own zero"),
            |options| Some(word(options.modulated)),
        ),
        Row::of(
            rule::integer("horizon", 1, 2, "2")
                .preset("1")
                .about("Periods that the cost looks ahead: of all sequences of two vectors (49 of `three_phase`, 169 of `all` with `off_leg: nominal`) the best one's first vector is applied; with neither `modulated: on` nor weights"),
            |options| (options.horizon > 1).then(|| number(options.horizon)),
        ),
        Row::of(
            rule::quantity("switching_weight", &[D::Current], 1e-4, 1e4, "0.5 A")
                .by_default("none")
                .about("Error of current that a leg's change of state weighs as much as in the cost: fewer changes for more ripple; below what one vector moves the current by in a period; not with `modulated: on`"),
            |options| if_any(options.switching_weight),
        ),
        Row::of(
            rule::plain("torque_weight", 1e-3, 100.0, "2")
                .by_default("none")
                .about("Weight of the square of the error's component along the sector's mean EMF, which makes torque: torque comes before the shape of the currents; not with `modulated: on`"),
            |options| if_any(options.torque_weight),
        ),
    ];

    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self> {
        let horizon = reader.integer_or_preset(errors, "horizon");
        let candidates = reader
            .choice(errors, "candidates", &[])
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
        let modulated = reader.choice_or_preset(errors, "modulated", &[]);
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
        let options = Self {
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

    fn common(&self) -> &LoopOptions {
        &self.common
    }

    fn common_mut(&mut self) -> &mut LoopOptions {
        &mut self.common
    }

    fn modulates(&self) -> bool {
        self.modulated
    }

    /// Whole vectors miss by one vector's change, and by the error that a change of state may weigh as much as.
    fn overshoot(&self, drive: &Drive) -> f64 {
        if self.modulated {
            0.0
        } else {
            drive.stride(1.0) + self.switching_weight
        }
    }
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
