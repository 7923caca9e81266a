//! Interpreted IR and bit-true model agree for the controllers besides predictive deadbeat control, in all
//! their variants, over the library's motors.

use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_tests::interpreter::{compare, compare_states};
use hexagen_tests::library::{Motor, motors};
use rayon::prelude::*;
use std::collections::BTreeMap;

const STEPS: u64 = 20_000;
/// What every controller takes.
const COMMON: [&str; 12] = [
    "",
    "emf=model",
    "emf_filter=0.6",
    "advance=1.5",
    "reference=proportional",
    "delay=0",
    "delay=0,emf=model",
    "discretisation=euler",
    "word=16",
    "word=16,emf=model",
    "hall_capture=timer,emf=model",
    "emf=model,reference=proportional,delay=0",
];

/// All variants of the controllers under test.
fn variants() -> Vec<String> {
    let fcs = ["table2", "three_phase", "all"]
        .into_iter()
        .flat_map(|set| {
            ["physical", "nominal"].map(|off| format!("fcs-mpc:candidates={set},off_leg={off}"))
        });
    let pi = ["keep_angle", "nearest", "torque_priority"]
        .into_iter()
        .map(|rule| format!("pi-pwm:saturation={rule}"))
        .chain(["pi-pwm:feed_forward=off".to_owned()]);
    fcs.chain(pi)
        .flat_map(|kind| {
            COMMON.map(|rest| match rest {
                "" => kind.clone(),
                rest => format!("{kind},{rest}"),
            })
        })
        .collect()
}

/// What became of one drive.
enum Outcome {
    Equal,
    Refused(Vec<String>),
    Differs(String),
}

fn generated(motor: &Motor, variant: &str) -> Result<Generated, Vec<String>> {
    let codes = |errors: hexagen_codegen::diagnostics::Diagnostics| {
        let codes = errors.into_iter().map(|error| error.code.to_string());
        codes.collect::<Vec<_>>()
    };
    let mut ast = parse_toml(&motor.text, "motor.toml").map_err(codes)?;
    apply_variant(&mut ast, variant).map_err(codes)?;
    let (spec, origins) = check(&ast).map_err(codes)?;
    generate(&spec, &origins).map_err(codes)
}

fn outcome(motor: &Motor, variant: &str, seed: u64) -> Outcome {
    match generated(motor, variant) {
        Err(codes) => Outcome::Refused(codes),
        Ok(generated) => {
            let program = generated.graph.program();
            let compared = compare(&generated, program, STEPS, seed)
                .and_then(|_| compare_states(&generated, program, STEPS / 4, seed));
            match compared {
                Ok(()) => Outcome::Equal,
                Err(what) => Outcome::Differs(format!("{} {variant}\n{what}", motor.name)),
            }
        }
    }
}

#[test]
fn every_variant_of_fcs_mpc_and_pi_pwm_equals_its_model() {
    let motors = motors();
    let variants = variants();
    // Every variant on the paper's motor and on two more, so that every motor meets many.
    let jobs: Vec<(usize, usize)> = (0..variants.len())
        .flat_map(|variant| {
            let others = [variant % motors.len(), (variant * 7 + 3) % motors.len()];
            let paper = motors
                .iter()
                .position(|motor| motor.name == "trivedi-keshri-660w");
            paper
                .into_iter()
                .chain(others)
                .map(move |motor| (motor, variant))
        })
        .collect();
    let outcomes: Vec<Outcome> = jobs
        .par_iter()
        .map(|&(motor, variant)| outcome(&motors[motor], &variants[variant], variant as u64))
        .collect();
    let mut refused = BTreeMap::<String, usize>::new();
    let (mut equal, mut failures) = (0, vec![]);
    for outcome in outcomes {
        match outcome {
            Outcome::Equal => equal += 1,
            Outcome::Refused(codes) => {
                for code in codes {
                    *refused.entry(code).or_default() += 1;
                }
            }
            Outcome::Differs(what) => failures.push(what),
        }
    }
    println!("{equal} drives equal over {STEPS} steps each; refused: {refused:?}");
    assert!(
        failures.is_empty(),
        "{} of {} drives differ, such as\n{}",
        failures.len(),
        jobs.len(),
        failures[..failures.len().min(4)].join("\n")
    );
    assert!(equal > jobs.len() / 2, "{equal} of {}", jobs.len());
}
