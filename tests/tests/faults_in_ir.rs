//! The comparison notices every small fault planted in the IR.

use hexagen_codegen::ir::Program;
use hexagen_tests::faults::{Fault, faults};
use hexagen_tests::interpreter::{compare, compare_states};
use hexagen_tests::library::motor;
use hexagen_tests::options::{choice_of, drive_toml, generate_toml};
use rayon::prelude::*;

/// Steps within which a fault must show.
const STEPS: u64 = 100_000;

const DRIVES: &[(&str, &[(&str, &str)])] = &[
    ("trivedi-keshri-660w", &[("saturation", "torque_priority")]),
    (
        "hoverboard-hub",
        &[
            ("modulation", "pair"),
            ("saturation", "nearest"),
            ("emf", "filtered"),
            ("advance", "1.5"),
            ("v_bus", "measured"),
            ("stall_timeout", "100ms"),
            ("start_up", "short"),
        ],
    ),
    (
        "estun-emj-04apb22",
        &[
            ("saturation", "keep_angle"),
            ("emf", "model"),
            ("reference", "proportional"),
            ("hall_capture", "timer"),
            ("adc_inverted", "on"),
            ("start_up", "short"),
        ],
    ),
    (
        "velineon-3500",
        &[
            ("modulation", "pair"),
            ("saturation", "torque_priority"),
            ("delay", "0"),
            ("word", "16"),
            ("discretisation", "euler"),
            ("start_up", "short"),
        ],
    ),
];

#[test]
fn every_planted_fault_is_noticed() {
    let mut planted = 0;
    let mut missed: Vec<String> = vec![];
    for (name, settings) in DRIVES {
        let toml = drive_toml(&motor(name), &choice_of(settings), None);
        let (_, generated) = generate_toml(&toml).expect("the drive generates");
        let program = generated.graph.program();
        let noticed = |program: &Program| {
            compare_states(&generated, program, STEPS, 1).is_err()
                || compare(&generated, program, STEPS, 1).is_err()
        };
        assert!(!noticed(program), "{name} differs without a fault");
        let all: Vec<Fault> = faults(program).collect();
        planted += all.len();
        let mut unnoticed: Vec<String> = all
            .par_iter()
            .filter(|fault| !noticed(&fault.program))
            .map(|fault| format!("{name}: {}: {}", fault.place, fault.what))
            .collect();
        missed.append(&mut unnoticed);
    }
    println!("{planted} faults planted");
    assert!(
        missed.is_empty(),
        "{} of {planted} faults unnoticed:\n{}",
        missed.len(),
        missed.join("\n")
    );
}
