//! Options of predictive hysteresis control, and how they are read.

use super::common::{EmfSource, LoopOptions, Surroundings, Traits, read_common, refuse};
use super::off_leg::{OFF_LEG, OffLegModel, read_off_leg};
use super::{Options, TurnsOff};
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, Diagnostic};
use crate::spec::ast::Value;
use crate::spec::health::Drive;
use crate::spec::option_row::{Row, number, word};
use crate::spec::reader::Reader;
use crate::spec::rule;
use crate::spec::units::Dimension as D;
use crate::spec::words::{Word, Words, words};

/// Entries of a listed switching table: 6 sectors, 2 states, 4 comparator outputs.
pub(crate) const GIVEN: usize = 48;

/// Default band over the rated current.
const BAND: f64 = 0.025;

/// Switching table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchingTable {
    /// From the geometry of the vectors.
    Derived,
    /// The paper's row of sector 1, rotated for the other sectors; loses control of the current.
    Printed,
    /// As listed: vector numbers by sector, commutation, H_a, H_b.
    Given([u8; GIVEN]),
}

impl Words for SwitchingTable {
    const CHOICES: &'static [Self] = &[Self::Derived, Self::Printed];
    const WORDS: &'static [Word] = &[
        Word {
            word: "derived",
            meaning: "from the geometry of the vectors",
        },
        Word {
            word: "printed",
            meaning: "the paper's row of sector 1, rotated for the other sectors: loses control of the current, for study only",
        },
    ];
}

words! {
    /// Candidate vectors of the derived table.
    pub enum PhccCandidates {
        "table2" = Table2: "V0 to V6 in commutation, else the sector's pair, its reverse and its zero",
        "three_phase" = ThreePhase: "V0 to V6 always",
    }
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
    /// Whether the prediction models the terminal voltage of a leg that is turned off.
    pub fn floating(&self) -> bool {
        self.common.delay == 1
            && self.candidates == PhccCandidates::Table2
            && self.off_leg == OffLegModel::Physical
    }
}

impl Options for PhccSpec {
    const KIND: &'static str = "phcc";
    const TITLE: &'static str = "predictive hysteresis current control";
    const NOTES: &'static str = "Refused where one vector changes the current by more than the rated current per period. With `delay: 0` there is no\n\
         prediction, and `emf`, `emf_filter` and `off_leg` have no effect.";
    const OWN: &'static [Row<Self>] = &[
        Row::of(
            rule::choice_or_list::<SwitchingTable>("table", "derived")
                .preset("derived")
                .about("Switching table. A list gives it: 48 vector numbers, 8 per sector from S1 to S6: 4 outside commutation, then 4 in commutation, for comparator outputs (alpha, beta) = 00, 01, 10, 11"),
            |options| {
                Some(match options.table {
                    SwitchingTable::Given(numbers) => number(numbers),
                    known => word(known),
                })
            },
        ),
        Row::of(
            rule::quantity("band", &[D::Current], 1e-4, 1e4, "0.5 A")
                .by_default(
                    "2.5 % of `rated_current`",
                    &[("", "narrower than what one vector changes in a period on most motors")],
                )
                .about("Half width of both bands, below the rated current"),
            |options| Some(number(options.band)),
        ),
        Row::of(
            rule::choice::<PhccCandidates>("candidates", "table2")
                .by_default(
                    "`three_phase` with `current_sensing: low_side`, else `table2`",
                    &[
                        ("three_phase", "no leg is off, so that sensors in the low legs see all currents"),
                        ("table2", "a leg is off between commutations, which switches least"),
                    ],
                )
                .about("Candidate vectors of the derived table"),
            |options| Some(word(options.candidates)),
        ),
        Row::of(OFF_LEG, |options| Some(word(options.off_leg))),
    ];

    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self> {
        let table = read_table(reader, errors);
        let candidates = read_candidates(reader, surroundings, table, errors);
        let three_phase = candidates == PhccCandidates::ThreePhase;
        let off_leg = read_off_leg(reader, three_phase, errors);
        let given = reader.plain_quantity(errors, "band");
        let traits = Traits {
            pulses_three_legs: false,
            advance_idle: false,
            uses_emf: true,
        };
        let common = read_common(reader, surroundings, traits, errors)?;
        let floats = !three_phase && off_leg == OffLegModel::Physical && common.delay == 1;
        if common.emf == EmfSource::Held && floats {
            let why = "the EMF of a floating leg cannot be seen, so it cannot be held; choose `off_leg: nominal` or `candidates: three_phase`";
            refuse(reader, "emf", ["off_leg", "physical"], why, errors);
        }
        if common.delay == 0 {
            let why = "without delay nothing is predicted";
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
        Some(Self {
            table: table?,
            band,
            candidates,
            off_leg,
            common,
        })
    }

    fn common(&self) -> &LoopOptions {
        &self.common
    }

    fn common_mut(&mut self) -> &mut LoopOptions {
        &mut self.common
    }

    fn turns_off(&self) -> Option<TurnsOff> {
        match (self.table, self.candidates) {
            (SwitchingTable::Derived, PhccCandidates::ThreePhase) => None,
            (SwitchingTable::Derived, PhccCandidates::Table2) => Some(TurnsOff {
                option: "candidates",
                value: "table2",
                instead: "candidates: three_phase",
            }),
            (SwitchingTable::Printed, _) => Some(TurnsOff {
                option: "table",
                value: "printed",
                instead: "table: derived",
            }),
            (SwitchingTable::Given(_), _) => Some(TurnsOff {
                option: "table",
                value: "a list",
                instead: "table: derived",
            }),
        }
    }

    fn modulates(&self) -> bool {
        false
    }

    /// A vector drives a current out of its band until the next command takes effect.
    fn overshoot(&self, drive: &Drive) -> f64 {
        let answered = 1.0 + f64::from(self.common.delay);
        phase_band(self.band) + drive.stride(answered)
    }

    /// The reference's corner goes by 2/sqrt(3) I along beta, and until it is reached the vector at
    /// 60 degrees to it, V/3 on alpha and V/sqrt(3) on beta, takes the one phase current up by 2/3
    /// I, less what its resistance takes of V/3. The band comes on top, and most of a period's
    /// change: with three quarters of it the library's motors, simulated, reach 94 to 111 % of this.
    fn swing(&self, drive: &Drive) -> f64 {
        let left = 1.0 - 3.0 * drive.resistance * drive.max_current / drive.v_bus;
        drive.max_current * (1.0 + 2.0 / 3.0 * left.max(0.0))
            + phase_band(self.band)
            + 0.75 * drive.stride(1.0)
    }

    /// Refuses a band whose switching reaches the trip level; a band above the rated current is
    /// another error.
    fn refuse_trip(&self, drive: &Drive, rated: f64, parts: [&Part; 2]) -> Option<Diagnostic> {
        let periods = 1 + self.common.delay;
        let adds = [self.band, drive.stride(f64::from(periods))];
        (self.band < rated).then(|| {
            catalogue::hysteresis_reaches_trip(parts[0], parts[1], drive.reach(), adds, periods)
        })
    }
}

/// Greatest error of a phase current within bands of this half width on alpha and beta:
/// b = -alpha/2 + sqrt(3)/2 beta.
fn phase_band(band: f64) -> f64 {
    f64::midpoint(1.0, 3_f64.sqrt()) * band
}

/// The candidates of the derived table; other tables have vectors with off legs.
fn read_candidates(
    reader: &Reader,
    surroundings: &Surroundings,
    table: Option<SwitchingTable>,
    errors: &mut Collector,
) -> PhccCandidates {
    let is_derived = table == Some(SwitchingTable::Derived);
    let by_default = if is_derived && !surroundings.reads_off_legs {
        PhccCandidates::ThreePhase
    } else {
        PhccCandidates::Table2
    };
    let candidates = reader
        .choice(errors, "candidates", &[])
        .unwrap_or(by_default);
    if !is_derived
        && candidates == PhccCandidates::ThreePhase
        && let Some(table) = reader.field("table")
    {
        let why = "they are the candidates of the derived table";
        let table = table.value.to_string();
        refuse(reader, "candidates", ["table", &table], why, errors);
    }
    candidates
}

/// The table; derived by default. None together with an error.
fn read_table(reader: &Reader, errors: &mut Collector) -> Option<SwitchingTable> {
    let Some(field) = reader.field("table") else {
        return Some(SwitchingTable::Derived);
    };
    let Value::Integers(list) = &field.value else {
        return reader.choice(errors, "table", &[]);
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
