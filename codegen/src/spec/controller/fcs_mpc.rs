//! Options of finite-control-set model predictive control, and how they are read.

use super::common::{
    EmfSource, LoopOptions, Surroundings, Traits, read_common, refuse, refuse_commutation,
};
use super::off_leg::{OFF_LEG, OffLegModel, read_off_leg};
use super::{Options, TurnsOff};
use crate::diagnostics::{Collector, at_most, catalogue, engineering};
use crate::spec::health::Drive;
use crate::spec::option_row::{Row, if_any, number, word};
use crate::spec::reader::Reader;
use crate::spec::rule;
use crate::spec::units::Dimension as D;
use crate::spec::words::{Words, words};

words! {
    /// Candidate vectors.
    pub enum Candidates {
        "table2" = Table2: "as in Table 2: V0 to V6 in commutation, else V0 and V12 to V61",
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
    /// Prediction horizon, 1 or 2 periods. With 2 no leg floats, and there is no modulation and no
    /// weight.
    pub horizon: u32,
    /// Cost of a leg's change of state, as a current error, ampere; 0: none. Not with `modulated`.
    pub switching_weight: f64,
    /// Weight of the squared error along the sector's mean EMF; 0: none. Not with `modulated`.
    pub torque_weight: f64,
    /// Options that all controllers share.
    pub common: LoopOptions,
}

impl FcsMpcSpec {
    /// Whether pair vectors are among the candidates.
    pub fn pairs(&self) -> bool {
        self.candidates != Candidates::ThreePhase
    }

    /// Whether the cost has weights beside the current error.
    pub fn weighted(&self) -> bool {
        self.switching_weight > 0.0 || self.torque_weight > 0.0
    }

    /// Whether the prediction models the terminal voltage of a leg that is turned off.
    pub fn floating(&self) -> bool {
        self.pairs() && self.off_leg == OffLegModel::Physical
    }
}

impl Options for FcsMpcSpec {
    const KIND: &'static str = "fcs-mpc";
    const TITLE: &'static str = "finite-control-set model predictive control";
    const NOTES: &'static str = "Refused where one vector changes the current by more than the rated current per period, unless modulated.";
    const OWN: &'static [Row<Self>] = &[
        Row::of(
            rule::choice::<Candidates>("candidates", "table2")
                .by_default(
                    "`three_phase` with `horizon: 2` or `current_sensing: low_side`, else `table2`",
                    &[
                        ("three_phase", "no leg is off, so that all currents are seen and sequences stay few"),
                        ("table2", "a leg is off between commutations, which switches least"),
                    ],
                )
                .about("Candidate vectors"),
            |options| Some(word(options.candidates)),
        ),
        Row::of(OFF_LEG, |options| Some(word(options.off_leg))),
        Row::of(
            rule::choice::<bool>("modulated", "off")
                .preset("off")
                .about("Whether two vectors share a period, with the duty of the least predicted error. Possible pairs, by three compare values and one state per leg: V0 and any of V1 to V6, two neighbours of these, a pair vector and its own zero"),
            |options| Some(word(options.modulated)),
        ),
        Row::of(
            rule::integer("horizon", 1, 2, "2")
                .preset("1")
                .about("Prediction horizon, periods. With 2 all sequences of two vectors are compared (49 of `three_phase`, 169 of `all` with `off_leg: nominal`) and the first vector of the best one is applied; not with `modulated: on` or weights"),
            |options| (options.horizon > 1).then(|| number(options.horizon)),
        ),
        Row::of(
            rule::quantity("switching_weight", &[D::Current], 1e-4, 1e4, "0.5 A")
                .off("changes of state cost nothing")
                .about("Cost of one leg's change of state, as a current error: fewer changes, more ripple; below the change of current by one vector per period; not with `modulated: on`"),
            |options| if_any(options.switching_weight),
        ),
        Row::of(
            rule::plain("torque_weight", 1e-3, 100.0, "2")
                .off("errors of both axes weigh the same")
                .about("Weight of the squared torque-producing error, along the sector's mean EMF: torque accuracy before the currents' shape; not with `modulated: on`"),
            |options| if_any(options.torque_weight),
        ),
    ];

    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self> {
        let horizon = reader.integer_or_preset(errors, "horizon");
        let candidates = reader.choice(errors, "candidates", &[]).unwrap_or(
            if horizon == 2 || !surroundings.reads_off_legs {
                Candidates::ThreePhase
            } else {
                Candidates::Table2
            },
        );
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
                let why = "the duty of two vectors minimises the current error alone";
                refuse(reader, name, ["modulated", "on"], why, errors);
            }
        }
        if horizon == 2 {
            check_two_steps(reader, candidates, off_leg, errors);
        }
        let traits = Traits {
            pulses_three_legs: false,
            advance_idle: without_sectors,
            uses_emf: true,
        };
        let options = Self {
            candidates,
            off_leg,
            modulated,
            horizon,
            switching_weight,
            torque_weight: torque_weight.map_or(0.0, |given| given.si),
            common: read_common(reader, surroundings, traits, errors)?,
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

    fn turns_off(&self) -> Option<TurnsOff> {
        self.pairs().then_some(TurnsOff {
            option: "candidates",
            value: self.candidates.word(),
            instead: "candidates: three_phase",
        })
    }

    fn modulates(&self) -> bool {
        self.modulated
    }

    /// Whole vectors miss by one vector's change, plus the cost of a change of state.
    fn overshoot(&self, drive: &Drive) -> f64 {
        if self.modulated {
            0.0
        } else {
            drive.stride(1.0) + self.switching_weight
        }
    }
}

/// Refuses `emf: held` where the EMF is needed by itself: a held one is known only in a sum.
fn check_held(reader: &Reader, options: &FcsMpcSpec, errors: &mut Collector) {
    if options.floating() {
        let why = "the voltage of a floating leg follows from its EMF, which a held one does not give; choose `off_leg: nominal` or `candidates: three_phase`";
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

/// At most the change of current by one vector per period, 2/3 v_bus Ts/L, rounded down: above it
/// the controller would never change the vector.
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
                    "{}, the change of current by one vector per period",
                    engineering(stride, "A")
                ),
            ));
        }
    }
    given.si
}

/// Checks the options of a horizon of 2, which needs the candidates of the second period and their
/// voltages in the first.
fn check_two_steps(
    reader: &Reader,
    candidates: Candidates,
    off_leg: OffLegModel,
    errors: &mut Collector,
) {
    let own = "sequences of two vectors are compared by the current error alone";
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
    let ahead = "the vectors and off legs of the second period are not known in the first; choose `candidates: three_phase`, \
                 or `all` with `off_leg: nominal`";
    match (candidates, off_leg) {
        (Candidates::Table2, _) => refuse(reader, "candidates", ["horizon", "2"], ahead, errors),
        (Candidates::All, OffLegModel::Physical) => {
            refuse(reader, "horizon", ["off_leg", "physical"], ahead, errors);
        }
        _ => {}
    }
}
