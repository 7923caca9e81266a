//! The emitted choice of a vector equals the enumerated argmin, ties included, for every integer
//! input: proven over the IR of every kind of drive that the library's motors allow, with any bus
//! voltage and any threshold.
//!
//! A drive with off legs is proven in two parts: the position of each leg, case by case of its
//! current; and the choice for any position. Rounded scores are the same numbers on both sides.

mod enumerated;

use enumerated::{OffLeg, Situation, sixths};
use hexagen_codegen::diagnostics::Code;
use hexagen_codegen::ir::Program;
use hexagen_codegen::pipeline::Generated;
use hexagen_codegen::spec::{Candidates, ControllerSpec, FcsMpcSpec, Spec};
use hexagen_tests::faults::{Fault, faults};
use hexagen_tests::library::motors;
use hexagen_tests::options::{Drive, generate_toml, kind};
use hexagen_tests::proof::linear::Linear;
use hexagen_tests::proof::paths::{Contradiction, Path, for_all_paths};
use hexagen_tests::proof::slice::{Slice, Symbol};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Options without the first value of their axis.
type Settings = &'static [(&'static str, &'static str)];

type Verdict = Result<Result<(), String>, Contradiction>;

const PHASES: [&str; 3] = ["a", "b", "c"];

/// Legs that are low in V0 to V6: 1 a, 2 b, 4 c.
const LOW_LEGS: [usize; 7] = [7, 3, 2, 6, 4, 5, 1];

/// The subject of a proof: a drive's program.
#[derive(Clone, Debug)]
struct Subject {
    program: Program,
    options: FcsMpcSpec,
    /// Shift of the products in scores; 0 without any.
    shift: u32,
}

impl Subject {
    fn new((spec, generated): (Spec, Generated)) -> Self {
        let ControllerSpec::FcsMpc(options) = spec.controller else {
            panic!("no drive that chooses vectors");
        };
        let formats = &generated.interface.formats;
        let bits = |name: &str| {
            let mut formats = formats.iter();
            formats
                .find(|format| format.name == name)
                .map(|format| format.frac_bits)
        };
        let shift = bits("score").map_or(0, |score| 2 * bits("voltage").unwrap_or(0) - score);
        Self {
            program: generated.graph.program().clone(),
            options,
            shift: shift as u32,
        }
    }

    fn has(&self, name: &str) -> bool {
        let mut nodes = self.program.step.nodes.iter();
        nodes.any(|node| node.name == name)
    }

    /// Bus and threshold, a number each or any number; and the integer parts of a fixed bus.
    fn slice(
        &self,
        bus: &Linear,
        threshold: &Linear,
        path: &mut Path,
    ) -> Result<Slice<'_>, Contradiction> {
        let mut slice = Slice::new(&self.program);
        slice.give("v_bus", Symbol::Word(bus.clone()));
        slice.give("i_comm_volts", Symbol::Word(threshold.clone()));
        slice.give("half_bus", Symbol::Word(path.floored(bus, 1)?));
        slice.give("third_of_bus", Symbol::Word(whole_third(bus, path)?));
        Ok(slice)
    }

    /// Part one: positions of off legs.
    fn off_leg(&self, phase: usize, path: &mut Path) -> Verdict {
        let bus = positive("v_bus", path)?;
        let threshold = path.variable("threshold");
        path.assume(&threshold)?;
        let mut slice = self.slice(&bus, &threshold, path)?;
        let mut pair = |names: [&'static str; 2]| {
            let [a, b] = names.map(|name| {
                let word = path.variable(name);
                slice.give(name, Symbol::Word(word.clone()));
                word
            });
            let c = -&(&a + &b);
            [a, b, c]
        };
        let (j, e) = (pair(["j_a", "j_b"]), pair(["e_a", "e_b"]));
        let u = pair(["u_a_unsat", "u_b_unsat"]);
        let held = &(&j[phase] + &e[phase]) - &u[phase];
        let half_e = path.floored(&e[phase], 1)?;
        let mut leg = OffLeg {
            inward: &threshold - &held,
            outward: &held + &threshold,
            lift: &e[phase] + &half_e,
            offset: Linear::default(),
        };
        let half_bus = path.floored(&bus, 1)?;
        let terminal = leg.terminal(&bus, &half_bus, path)?;
        leg.offset = &terminal.times(2) - &bus;
        let x = PHASES[phase];
        let expected = [
            (format!("d_{x}"), Symbol::Word(leg.offset)),
            (format!("lift_{x}"), Symbol::Word(leg.lift)),
            (
                format!("{x}_inward"),
                Symbol::Flag(path.is_negative(&leg.inward)?),
            ),
            (
                format!("{x}_outward"),
                Symbol::Flag(path.is_negative(&leg.outward)?),
            ),
        ];
        for (name, expected) in expected {
            if self.has(&name) {
                let found = slice.named(&name, path)?;
                let same = match (&found, &expected) {
                    (Symbol::Word(found), Symbol::Word(expected)) => {
                        is_same(found, expected, path)?
                    }
                    _ => found == expected,
                };
                if !same {
                    return Ok(Err(format!("{name} is {found:?}, not {expected:?}")));
                }
            }
        }
        Ok(Ok(()))
    }

    /// Part two: the choice, for any positions of off legs. `plane`: the bus, and u of phases a and
    /// b, as numbers.
    fn choice(&self, plane: Option<[i64; 3]>, path: &mut Path) -> Verdict {
        self.compared(plane, path, |subject, situation, slice, path| {
            let vector = situation.vector(path)?;
            // By the legs that are low, if nothing else is required.
            let (name, number) = if subject.has("pattern") {
                ("pattern", LOW_LEGS[vector])
            } else {
                ("vector", vector)
            };
            let expected = Linear::number(number as i64);
            let found = slice.named(name, path)?.word();
            Ok(if found == expected {
                Ok(())
            } else {
                Err(format!(
                    "{:?}: vector {found:?}, not {expected:?}",
                    subject.options.candidates
                ))
            })
        })
    }

    /// Part three: how two vectors share the period, for any pair vector or zero of a pair, and for
    /// the nearest of V0 to V6.
    fn sharing(&self, plane: Option<[i64; 3]>, path: &mut Path) -> Verdict {
        self.compared(plane, path, |subject, situation, slice, path| {
            let vector = if subject.options.pairs() && path.flag("pair")? {
                7 + path.number("pair vector", 9)? as usize
            } else {
                let three_phase = Situation {
                    candidates: Candidates::ThreePhase,
                    off_legs: None,
                    ..situation.clone()
                };
                three_phase.vector(path)?
            };
            slice.give("vector", Symbol::Word(Linear::number(vector as i64)));
            let terminals = situation.shared(vector, path)?;
            for (x, expected) in PHASES.into_iter().zip(terminals) {
                let name = format!("t_{x}_chosen");
                let found = slice.named(&name, path)?.word();
                if !is_same(&found, &expected, path)? {
                    let what = format!("vector {vector}: {name} is {found:?}, not {expected:?}");
                    return Ok(Err(what));
                }
            }
            Ok(Ok(()))
        })
    }

    /// Name of the choice's sector.
    fn sector(&self) -> &'static str {
        let names = ["sector_eff", "sector", "sector_seen"];
        let name = names.into_iter().find(|name| self.has(name));
        name.expect("a sector")
    }

    /// A check of the choice in any situation.
    fn compared(
        &self,
        plane: Option<[i64; 3]>,
        path: &mut Path,
        check: impl Fn(&Self, &Situation, &mut Slice, &mut Path) -> Verdict,
    ) -> Verdict {
        let (bus, u) = match plane {
            None => {
                let bus = positive("v_bus", path)?;
                (bus, ["u_a", "u_b"].map(|name| path.variable(name)))
            }
            Some([bus, a, b]) => (Linear::number(bus), [a, b].map(Linear::number)),
        };
        let mut slice = self.slice(&bus, &Linear::default(), path)?;
        slice.give("u_a_unsat", Symbol::Word(u[0].clone()));
        slice.give("u_b_unsat", Symbol::Word(u[1].clone()));
        let [u_a, u_b] = u;
        let u_c = -&(&u_a + &u_b);
        // Samples without a Hall code are not controlled.
        let sector = 1 + path.number("sector", 6)?;
        slice.give(self.sector(), Symbol::Word(Linear::number(sector)));
        let commutating =
            self.options.candidates == Candidates::Table2 && path.flag("commutating")?;
        slice.give("in_commutation", Symbol::Flag(commutating));
        let off_legs = if self.options.floating() {
            let off_legs = LEG_NAMES.map(|names| off_leg(names, &mut slice, path));
            for leg in &off_legs {
                // With a non-negative threshold no current flows both ways.
                path.assume(&(&leg.inward + &leg.outward))?;
            }
            Some(off_legs)
        } else {
            None
        };
        // Any cost of any change.
        let changes = (self.options.switching_weight > 0.0).then(|| {
            CHANGES.map(|names| {
                names.map(|name| {
                    let cost = path.variable(name);
                    slice.give(name, Symbol::Word(cost.clone()));
                    cost
                })
            })
        });
        let situation = Situation {
            candidates: self.options.candidates,
            sector: sector as usize,
            commutating,
            bus,
            u: [u_a, u_b, u_c],
            off_legs,
            shift: self.shift,
            changes,
        };
        check(self, &situation, &mut slice, path)
    }

    /// Part four: the contribution of the best second vector after a first one.
    fn ahead(&self, first: usize, path: &mut Path) -> Verdict {
        let bus = positive("v_bus", path)?;
        let mut slice = self.slice(&bus, &Linear::default(), path)?;
        let [y_a, y_b, sixth] = ["y_a", "y_b", "v_sixth"].map(|name| {
            let word = path.variable(name);
            slice.give(name, Symbol::Word(word.clone()));
            word
        });
        let y_c = -&(&y_a + &y_b);
        let mut left = [y_a, y_b, y_c];
        for (y, moved) in left.iter_mut().zip(sixths(first)) {
            *y = &*y - &sixth.times(moved);
        }
        let situation = Situation {
            candidates: self.options.candidates,
            sector: 1,
            commutating: false,
            bus,
            u: left,
            off_legs: None,
            shift: self.shift,
            changes: None,
        };
        let (_, expected) = situation.least(path)?;
        let found = slice.named(&format!("ahead_{first}"), path)?.word();
        Ok(if is_same(&found, &expected, path)? {
            Ok(())
        } else {
            Err(format!("ahead_{first} is {found:?}, not {expected:?}"))
        })
    }

    /// Part five: the vector `number` against the best of those before it, for any contribution of
    /// second ones.
    fn next_of_sequence(&self, number: usize, path: &mut Path) -> Verdict {
        let bus = positive("v_bus", path)?;
        let mut slice = self.slice(&bus, &Linear::default(), path)?;
        let [z_a, z_b, first] = ["z_a", "z_b", "v_first"].map(|name| {
            let word = path.variable(name);
            slice.give(name, Symbol::Word(word.clone()));
            word
        });
        let names = SEQUENCES[number];
        let ahead = path.variable(names.ahead);
        slice.give(names.ahead, Symbol::Word(ahead.clone()));
        let before = SEQUENCES[number - 1];
        let (known, least) = if number == 1 {
            let least = path.variable(before.ahead);
            slice.give(before.ahead, Symbol::Word(least.clone()));
            (Linear::default(), least)
        } else {
            let words = [before.best, before.least].map(|name| {
                let word = path.variable(name);
                slice.give(name, Symbol::Word(word.clone()));
                word
            });
            words.into()
        };
        let own = Situation {
            candidates: self.options.candidates,
            sector: 1,
            commutating: false,
            bus: first,
            u: [z_a.clone(), z_b.clone(), -&(&z_a + &z_b)],
            off_legs: None,
            shift: self.shift,
            changes: None,
        };
        let score = &own.by_bus(number) + &ahead;
        let expected = if path.is_negative(&(&score - &least))? {
            [Linear::number(number as i64), score]
        } else {
            [known, least]
        };
        // The best of all is the vector, whose score is not needed.
        let is_last = number + 1 == self.first_vectors();
        let best = if is_last { "vector" } else { names.best };
        for (name, expected) in [best, names.least].into_iter().zip(expected) {
            if !is_last || name == best {
                let found = slice.named(name, path)?.word();
                if !is_same(&found, &expected, path)? {
                    return Ok(Err(format!("{name} is {found:?}, not {expected:?}")));
                }
            }
        }
        Ok(Ok(()))
    }

    /// Possible first vectors of a sequence.
    fn first_vectors(&self) -> usize {
        match self.options.candidates {
            Candidates::All => 13,
            Candidates::Table2 | Candidates::ThreePhase => 7,
        }
    }

    /// The number of paths.
    fn prove(&self) -> Result<usize, String> {
        if self.options.horizon == 2 {
            let mut paths = 0;
            for number in 0..self.first_vectors() {
                paths += for_all_paths(|path| self.ahead(number, path))?;
                if number > 0 {
                    paths += for_all_paths(|path| self.next_of_sequence(number, path))?;
                }
            }
            return Ok(paths);
        }
        let legs = if self.options.floating() { 3 } else { 0 };
        // Between two three-phase vectors the choice itself leaves no trace.
        let mut paths = if self.has("vector") || self.has("pattern") {
            for_all_paths(|path| self.choice(None, path))?
        } else {
            0
        };
        if self.options.modulated {
            paths += for_all_paths(|path| self.sharing(None, path))?;
        }
        for phase in 0..legs {
            paths += for_all_paths(|path| self.off_leg(phase, path))?;
        }
        Ok(paths)
    }

    /// Inputs of the proof as text: drives with the same text have the same proof.
    fn key(&self) -> String {
        let text = self.program.to_string();
        let stages = [
            "nearest_vector:",
            "predict_off_legs:",
            "nearest_pair:",
            "nearest_edge:",
            "divide_pair:",
            "share_period:",
            "best_sequence:",
        ];
        let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
        let is_read = |name: &str| matches!(name, "vector_of_gates" | "zero_vector" | "vector_off");
        let tables = self.program.tables.iter();
        let tables: Vec<_> = tables.filter(|table| is_read(&table.name)).collect();
        let FcsMpcSpec {
            candidates,
            modulated,
            horizon,
            switching_weight,
            ..
        } = self.options;
        let counts_changes = switching_weight > 0.0;
        let mut key = format!("{candidates:?} {modulated} {horizon} {counts_changes} {tables:?}\n");
        // The proof uses the products' shift as a name; its value is checked here.
        let shift = format!(">> {})", self.shift);
        // As upper words they have the rest of a word's bits before them; one or two are shifts of
        // their own, too.
        let room = 32_u32.checked_sub(self.shift).filter(|&room| room > 2);
        let raised = room.map(|room| format!(" << {room}"));
        let mut is_inside = false;
        for line in text.lines() {
            if !line.starts_with("    ") {
                is_inside = stages.contains(&line.trim());
            } else if is_inside {
                let line = line.split("  ;").next().unwrap_or_default();
                let line = line.replace(&shift, ">> score)");
                let line = match &raised {
                    Some(raised) if line.ends_with(raised) => line.replace(raised, " << room"),
                    _ => line,
                };
                for word in line.split(' ').filter(|word| !word.is_empty()) {
                    // Values without name are numbered over the whole step.
                    let parts = word.split_once('%').map(|(before, rest)| {
                        let end = rest.find(|c: char| !c.is_ascii_digit());
                        let (number, after) = rest.split_at(end.unwrap_or(rest.len()));
                        (before, number.to_owned(), after)
                    });
                    let text = match parts {
                        Some((before, number, after)) => {
                            let next = numbers.len();
                            let number = numbers.entry(number).or_insert(next);
                            format!("{before}%{number}{after}")
                        }
                        None => word.to_owned(),
                    };
                    key.push_str(&text);
                    key.push(' ');
                }
                key.push('\n');
            }
        }
        key
    }
}

/// Names of the flags and words of an off leg: inward, outward, lift, offset.
const LEG_NAMES: [[&str; 4]; 3] = [
    ["a_inward", "a_outward", "lift_a", "d_a"],
    ["b_inward", "b_outward", "lift_b", "d_b"],
    ["c_inward", "c_outward", "lift_c", "d_c"],
];

/// Names of the costs of turning legs high, low and off.
const CHANGES: [[&str; 3]; 3] = [
    ["to_high_a", "to_low_a", "to_off_a"],
    ["to_high_b", "to_low_b", "to_off_b"],
    ["to_high_c", "to_low_c", "to_off_c"],
];

/// Names in the choice of a sequence's first vector.
#[derive(Clone, Copy, Debug)]
struct Sequence {
    /// Contribution of the best second vector.
    ahead: &'static str,
    /// The best first vector up to this one.
    best: &'static str,
    /// Its score.
    least: &'static str,
}

const fn sequence(ahead: &'static str, best: &'static str, least: &'static str) -> Sequence {
    Sequence { ahead, best, least }
}

/// By the number of the vector; the first one has no comparison.
const SEQUENCES: [Sequence; 13] = [
    sequence("ahead_0", "best_0", "least_0"),
    sequence("ahead_1", "best_1", "least_1"),
    sequence("ahead_2", "best_2", "least_2"),
    sequence("ahead_3", "best_3", "least_3"),
    sequence("ahead_4", "best_4", "least_4"),
    sequence("ahead_5", "best_5", "least_5"),
    sequence("ahead_6", "best_6", "least_6"),
    sequence("ahead_7", "best_7", "least_7"),
    sequence("ahead_8", "best_8", "least_8"),
    sequence("ahead_9", "best_9", "least_9"),
    sequence("ahead_10", "best_10", "least_10"),
    sequence("ahead_11", "best_11", "least_11"),
    sequence("ahead_12", "best_12", "least_12"),
];

fn is_same(one: &Linear, two: &Linear, path: &mut Path) -> Result<bool, Contradiction> {
    let difference = one - two;
    Ok(!path.is_negative(&difference)? && !path.is_negative(&-&difference)?)
}

fn positive(name: &str, path: &mut Path) -> Result<Linear, Contradiction> {
    let word = path.variable(name);
    path.assume(&(&word - &Linear::number(1)))?;
    Ok(word)
}

/// floor(bus / 3) of a bus that is not negative.
fn whole_third(bus: &Linear, path: &mut Path) -> Result<Linear, Contradiction> {
    if let Some(bus) = bus.as_number() {
        return Ok(Linear::number(bus / 3));
    }
    let third = path.variable("third_of_bus");
    let rest = bus - &third.times(3);
    path.assume(&rest)?;
    path.assume(&(&Linear::number(2) - &rest))?;
    Ok(third)
}

/// Any off leg.
fn off_leg(names: [&'static str; 4], slice: &mut Slice, path: &mut Path) -> OffLeg {
    let [inward, outward, lift, offset] = names.map(|name| path.variable(name));
    let symbols = [
        Symbol::Sign(inward.clone()),
        Symbol::Sign(outward.clone()),
        Symbol::Word(lift.clone()),
        Symbol::Word(offset.clone()),
    ];
    for (name, symbol) in names.into_iter().zip(symbols) {
        slice.give(name, symbol);
    }
    OffLeg {
        inward,
        outward,
        lift,
        offset,
    }
}

/// Every drive of the library's motors that chooses vectors, once per text of its proof.
fn subjects() -> BTreeMap<String, (String, Subject)> {
    const AXES: [(&str, &[&str]); 7] = [
        ("choice", &["one", "two", "fewer_changes", "two_steps"]),
        ("candidates", &["table2", "three_phase", "all"]),
        ("off_leg", &["physical", "nominal"]),
        ("emf", &["estimated", "model"]),
        ("delay", &["1", "0"]),
        ("word", &["32", "16"]),
        ("v_bus", &["fixed", "measured"]),
    ];
    let kind = kind("fcs-mpc");
    let mut settings: Vec<Vec<(&str, &str)>> = vec![vec![]];
    for (axis, values) in AXES {
        let longer = |known: &Vec<(&'static str, &'static str)>| {
            let with = |&value| [&known[..], &[(axis, value)]].concat();
            values.iter().map(with).collect::<Vec<_>>()
        };
        settings = settings.iter().flat_map(longer).collect();
    }
    // Weighted changes leave physical off legs to the two parts that are proven here without
    // weights, and without off legs.
    let is_taken = |settings: &Vec<(&str, &str)>| {
        let has = |setting: &(&str, &str)| settings.contains(setting);
        !has(&("choice", "fewer_changes"))
            || has(&("off_leg", "nominal"))
            || has(&("candidates", "three_phase"))
    };
    settings.retain(is_taken);
    // Those whose vectors reach the whole bus; `low_legs` compares the others with the model.
    let mut motors = motors();
    motors.retain(|motor| !motor.text.starts_with("board = "));
    let drives: Vec<_> = motors
        .iter()
        .flat_map(|motor| settings.iter().map(move |settings| (motor, settings)))
        .collect();
    let found = drives.into_par_iter().filter_map(|(motor, settings)| {
        let choice = kind.choice_of(settings);
        let generated = match generate_toml(&kind.drive_toml(motor, &choice, None)) {
            Ok(generated) => generated,
            Err(errors) => {
                let mut codes = errors.into_iter().map(|error| error.code);
                assert!(codes.all(|code| code != Code::Internal));
                return None;
            }
        };
        let subject = Subject::new(generated);
        let name = format!("{} {}", motor.name, kind.describe(&choice));
        Some((subject.key(), (name, subject)))
    });
    let found: Vec<_> = found.collect();
    println!("{} drives", found.len());
    assert!(found.len() > 200, "{} drives", found.len());
    found.into_iter().rev().collect()
}

#[test]
fn the_rule_finds_the_first_of_the_least_score() {
    let subjects = subjects();
    println!("{} different choices", subjects.len());
    let wrong: Vec<String> = subjects
        .par_iter()
        .filter_map(|(_, (name, subject))| {
            let outcome = subject.prove();
            println!("{name}: {outcome:?}");
            let wrong = outcome.err()?;
            Some(format!("{name}: {wrong}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Drives with faults planted in the choice, the maximum number of tried faults, and the minimum
/// number that change the choice: some are equivalent. Together the drives have every stage.
const PLANTED: [(Settings, usize, usize); 9] = [
    (&[("choice", "two")], 6, 4),
    (
        &[("choice", "two"), ("candidates", "three_phase")],
        usize::MAX,
        100,
    ),
    (&[("off_leg", "nominal")], usize::MAX, 135),
    (
        &[("candidates", "all"), ("off_leg", "nominal")],
        usize::MAX,
        115,
    ),
    (&[], 6, 4),
    (&[("candidates", "all")], 6, 4),
    (
        &[("choice", "fewer_changes"), ("candidates", "three_phase")],
        usize::MAX,
        95,
    ),
    (
        &[("choice", "fewer_changes"), ("off_leg", "nominal")],
        24,
        20,
    ),
    (
        &[("choice", "two_steps"), ("candidates", "three_phase")],
        40,
        35,
    ),
];

/// The drive of [`WRONG_RULES`].
const WRONG_RULES_OF: Settings = &[("off_leg", "nominal")];

/// Wrong rules that a few random inputs would hardly reveal: the order of ties, the edge of the
/// zero vector, a missing vector, and the sign that distinguishes two of them.
const WRONG_RULES: [(&str, &str); 6] = [
    ("nearest_vector: b_is_low", "another comparison"),
    ("nearest_vector: in low_legs", "never"),
    ("nearest_vector: in vector_three", "another comparison"),
    ("vector_of_low_legs[5]", "one more"),
    ("nearest_pair: a_below_b", "another comparison"),
    ("pair_of_order[4]", "one more"),
];

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn a_wrong_rule_is_refuted() {
    for (settings, most, least) in PLANTED {
        let drive = Drive {
            kind: "fcs-mpc",
            motor: "trivedi-keshri-660w",
            settings,
        };
        let subject = Subject::new(generate_toml(&drive.toml(None)).expect("the drive generates"));
        let planted: Vec<_> = faults(&subject.program)
            .filter(|fault| {
                let stage = fault.place.split([':', '[']).next().unwrap_or_default();
                matches!(
                    stage,
                    "nearest_vector"
                        | "predict_off_legs"
                        | "nearest_pair"
                        | "nearest_edge"
                        | "divide_pair"
                        | "share_period"
                        | "best_sequence"
                        | "complete_voltage"
                        | "vector_of_gates"
                        | "vector_of_low_legs"
                        | "pair_of_order"
                        | "zero_vector"
                )
            })
            .collect();
        let stride = planted.len().div_ceil(most);
        let chosen: Vec<_> = planted.iter().step_by(stride).collect();
        let unrefuted: Vec<String> = chosen
            .par_iter()
            .filter(|fault| {
                let faulty = Subject {
                    program: fault.program.clone(),
                    ..subject.clone()
                };
                faulty.prove().is_ok()
            })
            .map(|fault| format!("{}: {}", fault.place, fault.what))
            .collect();
        println!(
            "{settings:?}: {} faults, {} of them unrefuted",
            chosen.len(),
            unrefuted.len()
        );
        let refuted = chosen.len() - unrefuted.len();
        assert!(refuted >= least, "{settings:?}: {}", unrefuted.join("\n"));
        if settings == WRONG_RULES_OF {
            for (place, what) in WRONG_RULES {
                let is_it = |fault: &&&Fault| fault.place == place && fault.what == what;
                assert!(chosen.iter().any(|fault| is_it(&fault)), "{place}: {what}");
                assert!(
                    !unrefuted.contains(&format!("{place}: {what}")),
                    "{place}: {what}"
                );
            }
        }
    }
}

#[test]
fn the_proof_agrees_with_every_point_of_a_small_plane() {
    for settings in [
        &[("candidates", "three_phase")][..],
        &[("off_leg", "nominal")],
        &[("candidates", "all"), ("off_leg", "nominal")],
        &[("choice", "two"), ("candidates", "three_phase")],
        &[("choice", "two"), ("off_leg", "nominal")],
    ] {
        let drive = Drive {
            kind: "fcs-mpc",
            motor: "trivedi-keshri-660w",
            settings,
        };
        let subject = Subject::new(generate_toml(&drive.toml(None)).expect("the drive generates"));
        for bus in [6, 7] {
            let points = (-13..=13).flat_map(|a| (-13..=13).map(move |b| [bus, a, b]));
            for point in points {
                let outcome = for_all_paths(|path| {
                    if subject.options.modulated {
                        subject.sharing(Some(point), path)
                    } else {
                        subject.choice(Some(point), path)
                    }
                });
                assert!(outcome.is_ok(), "{settings:?} {point:?}: {outcome:?}");
            }
        }
    }
}
