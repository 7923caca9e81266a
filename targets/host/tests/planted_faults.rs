//! 300 faults planted over controllers and motors, and who notices each: the interval verifier, Gappa, or the comparison
//! with the bit-true model. `cargo xtask faults` prints the list; a push plants two of each drive's 25. Who survives all three
//! changes nothing, or next to nothing: their share must stay small.

use hexagen_codegen::emit::gappa::{Script, emit_gappa};
use hexagen_codegen::ir::{Program, VerifiedGraph, verify};
use hexagen_codegen::pipeline::Generated;
use hexagen_host::checker::is_proved;
use hexagen_tests::cases::Record;
use hexagen_tests::faults::{DRIVES, Fault, faults};
use hexagen_tests::interpreter::{compare, compare_all_set_points, compare_record, record_states};
use hexagen_tests::options::{Drive, generate_toml};
use rayon::prelude::*;
use std::collections::HashMap;
use std::env;

/// Faults of each drive; with `HEXAGEN_ALL_FAULTS` in the environment, and in a push.
const PLANTED: usize = 25;
const IN_A_PUSH: usize = 2;

/// Percent of them that somebody notices at the least.
const LEAST_NOTICED: usize = 85;

/// Steps of each kind within which the comparison must notice a fault.
const STEPS: u64 = 40_000;

/// A drive without fault, and what its faults are held against.
struct Sound {
    generated: Generated,
    scripts: HashMap<String, Script>,
    states: Record,
}

/// Who notices a fault.
struct Noticed {
    by_intervals: bool,
    by_gappa: bool,
    by_comparison: bool,
}

impl Sound {
    fn of(drive: &Drive) -> Self {
        let (_, generated) = generate_toml(&drive.toml(None)).expect("the drive generates");
        let scripts = emit_gappa(&generated.graph).into_iter();
        Self {
            scripts: scripts
                .map(|script| (script.name.clone(), script))
                .collect(),
            states: record_states(&generated, STEPS, 1).expect("the drive has a model"),
            generated,
        }
    }

    fn program(&self) -> &Program {
        self.generated.graph.program()
    }

    /// Whether the comparison with the bit-true model notices a program.
    fn differs(&self, program: &Program) -> bool {
        let few = self.states.first(250);
        compare_record(&self.generated, program, &few).is_err()
            || compare(&self.generated, program, STEPS / 10, 1).is_err()
            || compare_record(&self.generated, program, &self.states).is_err()
            || compare(&self.generated, program, STEPS, 1).is_err()
            || compare_all_set_points(&self.generated, program).is_err()
    }

    /// Whether Gappa refuses a bound of the sound program for a script of the faulty one.
    fn is_refused(&self, faulty: &VerifiedGraph) -> bool {
        emit_gappa(faulty).into_iter().any(|mut script| {
            // A script of a case that the sound program has not: other fault, other noticer.
            let Some(sound) = self.scripts.get(&script.name) else {
                return false;
            };
            let bounds: HashMap<&str, _> = sound
                .goals
                .iter()
                .map(|goal| (goal.expression.as_str(), (goal.low, goal.high)))
                .collect();
            for goal in &mut script.goals {
                if let Some(&(low, high)) = bounds.get(goal.expression.as_str()) {
                    (goal.low, goal.high) = (low, high);
                }
            }
            script != *sound && !is_proved(&script.to_string()).expect("Gappa runs")
        })
    }

    fn noticed(&self, fault: &Fault) -> Noticed {
        let verified = fault
            .planted_in(self.program())
            .map_err(drop)
            .and_then(|faulty| verify(faulty).map_err(drop));
        Noticed {
            by_intervals: verified.is_err(),
            by_gappa: verified.is_ok_and(|faulty| self.is_refused(&faulty)),
            by_comparison: self.differs(&fault.program),
        }
    }
}

#[test]
fn faults_are_noticed_by_somebody() {
    let planted = match env::var_os("HEXAGEN_ALL_FAULTS") {
        Some(_) => PLANTED,
        None => IN_A_PUSH,
    };
    let mut survivors = vec![];
    let mut noticed = [0; 3];
    for drive in DRIVES {
        let name = &drive.name()[..];
        let sound = Sound::of(drive);
        let all: Vec<Fault> = faults(sound.program()).collect();
        // The middle of each of equal parts.
        let chosen = (0..planted).map(|k| &all[(2 * k + 1) * all.len() / (2 * planted)]);
        let found: Vec<(String, Noticed)> = chosen
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|fault| (fault.name(), sound.noticed(fault)))
            .collect();
        println!("{name}");
        for (fault, by) in found {
            println!("  {fault}: {}", by.text());
            let by = [by.by_intervals, by.by_gappa, by.by_comparison];
            for (count, by) in noticed.iter_mut().zip(by) {
                *count += usize::from(by);
            }
            if by == [false; 3] {
                survivors.push(format!("{name}: {fault}"));
            }
        }
    }
    let [intervals, gappa, comparison] = noticed;
    let all = planted * DRIVES.len();
    println!(
        "{all} faults: {comparison} noticed by C == B, {intervals} by the interval verifier, {gappa} of the rest by Gappa; {} survivors",
        survivors.len()
    );
    let share = 100 * (all - survivors.len()) / all;
    assert!(
        share >= LEAST_NOTICED,
        "{share} %:\n{}",
        survivors.join("\n")
    );
    // Each of them can notice something.
    assert!(noticed.iter().all(|&count| count > 0), "{noticed:?}");
}

impl Noticed {
    fn text(&self) -> String {
        let by = [
            (self.by_comparison, "C == B"),
            (self.by_intervals, "interval verifier"),
            (self.by_gappa, "Gappa"),
        ];
        let by: Vec<&str> = by.into_iter().filter(|by| by.0).map(|by| by.1).collect();
        if by.is_empty() {
            "survives".to_owned()
        } else {
            by.join(", ")
        }
    }
}
