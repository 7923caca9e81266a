//! What Gappa makes of the generator's bounds: true ones are proved, for motors of the library and for random
//! ones, and false ones are refused.

mod certificates;
mod faults;
mod goals;

use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::emit::gappa::emit_gappa;
use hexagen_codegen::ir::stated_errors;
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_host::checker::{Proof, WIDEST, missing_goals, prove};
use hexagen_lab::engine::library;
use hexagen_tests::random_motor::RandomMotor;
use rayon::prelude::*;
use std::env;

/// Variants that together have every block of a step. In a push the first of them are proved for
/// the paper's motor, and the others for a random one each.
const VARIANTS: [&str; 16] = [
    "pdcc",
    "pdcc:reference=quasi_square,emf=model,saturation=nearest",
    "pdcc:emf=model,modulation=pair,saturation=keep_angle,advance=1.5",
    "pdcc:modulation=pair,word=16",
    "pdcc:reference=proportional,emf=observer",
    "pdcc:reference=quasi_square,delay=0,emf_filter=1,saturation=nearest,discretisation=euler",
    "pi-pwm",
    "pi-pwm:reference=quasi_square,feed_forward=off,saturation=keep_angle,word=16",
    "pi-pwm:six_step=on",
    "fcs-mpc",
    "fcs-mpc:candidates=all,off_leg=nominal,word=16",
    "fcs-mpc:candidates=all,modulated=on",
    "phcc",
    "phcc:word=16",
    "phcc:off_leg=nominal,emf=held",
    "pdcc:reference=quasi_square,speed_loop=on",
];

/// A motor's text with an inertia, where it states none: what a speed loop needs.
fn with_inertia(text: &str) -> String {
    if text.contains("\ninertia") {
        text.to_owned()
    } else {
        text.replacen("[motor]\n", "[motor]\ninertia = \"3 kg cm2\"\n", 1)
    }
}

fn generated(toml: &str, variant: &str) -> Result<Generated, Diagnostics> {
    let mut ast = parse_toml(&with_inertia(toml), "motor.toml")?;
    apply_variant(&mut ast, variant)?;
    let (spec, origins) = check(&ast)?;
    generate(&spec, &origins)
}

/// Goals that were proved, or what was not.
fn prove_all(drive: &str, generated: &Generated) -> Result<usize, String> {
    let scripts = emit_gappa(&generated.graph);
    let missing = missing_goals(&generated.graph, &scripts);
    if !missing.is_empty() {
        return Err(format!("{drive}: {}", missing.join("\n")));
    }
    let proofs: Vec<Proof> = scripts
        .par_iter()
        .map(|script| prove(script).map_err(|missing| missing.to_string()))
        .collect::<Result<_, _>>()?;
    let failures = proofs.iter().filter_map(|proof| proof.failure.as_deref());
    let failures: Vec<&str> = failures.collect();
    if failures.is_empty() {
        assert!(proofs.iter().all(|proof| proof.widest <= WIDEST));
        Ok(proofs.iter().map(|proof| proof.proved).sum())
    } else {
        Err(format!("{drive}: {}", failures.join("\n")))
    }
}

/// How many variants are proved for the paper's motor in a push; all of them where
/// `HEXAGEN_RANDOM_MOTORS` is set, as in the nightly run.
const OF_THE_PAPER: usize = 9;

fn random_motors() -> Option<usize> {
    let wanted = env::var("HEXAGEN_RANDOM_MOTORS").ok()?;
    Some(wanted.parse().expect("a number of motors"))
}

#[test]
fn every_variant_of_the_paper_motor_is_proved() {
    let library = library();
    let motor = library
        .iter()
        .find(|motor| motor.name == "trivedi-keshri-660w");
    let motor = motor.expect("the paper's motor");
    let proved = random_motors().map_or(OF_THE_PAPER, |_| VARIANTS.len());
    for variant in &VARIANTS[..proved] {
        let generated =
            generated(motor.text, variant).unwrap_or_else(|errors| panic!("{variant}: {errors}"));
        let goals = prove_all(variant, &generated).unwrap_or_else(|failures| panic!("{failures}"));
        println!("{variant}: {goals} goals");
        assert!(goals > 20, "{variant}: {goals} goals");
    }
}

/// `HEXAGEN_RANDOM_MOTORS` says how many; in a push the first that is not refused, for each variant
/// that is not proved for the paper's motor.
#[test]
fn random_motors_are_proved_or_refused() {
    let wanted = random_motors();
    let (mut proved, mut refused, mut failures) = (0, 0, vec![]);
    let mut try_motor = |seed: usize, variant: &str| {
        let motor = RandomMotor::new(seed as u64).toml();
        match generated(&motor, variant) {
            // A refusal says the number that does not fit.
            Err(errors) => {
                assert!(
                    errors
                        .to_string()
                        .contains(|letter: char| letter.is_ascii_digit())
                );
                refused += 1;
                false
            }
            Ok(generated) => {
                match prove_all(variant, &generated) {
                    Ok(_) => proved += 1,
                    Err(failure) => failures.push(format!("motor {seed}: {failure}\n{motor}")),
                }
                true
            }
        }
    };
    match wanted {
        Some(wanted) => {
            for seed in 0..wanted {
                try_motor(seed, VARIANTS[seed % VARIANTS.len()]);
            }
        }
        None => {
            for variant in &VARIANTS[OF_THE_PAPER..] {
                assert!((0..50).any(|seed| try_motor(seed, variant)), "{variant}");
            }
        }
    }
    println!("{proved} motors proved, {refused} refused");
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    if let Some(wanted) = wanted {
        assert!(
            proved * 3 >= wanted * 2,
            "{proved} of {wanted} motors proved"
        );
    }
}

#[test]
fn the_stated_voltage_error_of_the_paper_motor_is_small() {
    let library = library();
    let motor = library
        .iter()
        .find(|motor| motor.name == "trivedi-keshri-660w");
    let motor = motor.expect("the paper's motor").text;
    let bound = |variant: &str, quantity: &str| {
        let generated =
            generated(motor, variant).unwrap_or_else(|errors| panic!("{variant}: {errors}"));
        let stated = stated_errors(generated.graph.program());
        let found = stated.iter().find(|stated| stated.name == quantity);
        found
            .expect("a quantity of every modulating drive")
            .normal_bound()
    };
    let modelled = "pdcc:reference=quasi_square,emf=model,hall_capture=sampled";
    assert!(bound(modelled, "duty") < 0.02);
    assert!(bound(modelled, "voltage") < 1e-4);
    assert!(bound("pdcc:reference=quasi_square", "duty") < 0.1);
    // The misfit of the shape's table.
    assert!(bound("pdcc", "voltage") < 0.01);
}
