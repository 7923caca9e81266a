//! The comparison notices every small fault planted in the IR, but for those that change nothing.

mod equivalent;

use equivalent::EQUIVALENT;
use hexagen_codegen::ir::Program;
use hexagen_tests::faults::{Fault, faults};
use hexagen_tests::interpreter::{compare, compare_cases, record_states};
use hexagen_tests::options::{Drive, generate_toml};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Steps of each kind within which a fault must show.
const STEPS: u64 = 40_000;

/// Together these have every stage of a step of every kind of controller.
const DRIVES: &[Drive] = &[
    Drive {
        kind: "pdcc",
        motor: "trivedi-keshri-660w",
        settings: &[("saturation", "torque_priority")],
    },
    Drive {
        kind: "pdcc",
        motor: "hoverboard-hub",
        settings: &[
            ("modulation", "pair"),
            ("saturation", "nearest"),
            ("emf", "filtered"),
            ("advance", "1.5"),
            ("v_bus", "measured"),
            ("stall_timeout", "100ms"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "pdcc",
        motor: "estun-emj-04apb22",
        settings: &[
            ("saturation", "keep_angle"),
            ("emf", "model"),
            ("reference", "proportional"),
            ("hall_capture", "timer"),
            ("adc_inverted", "on"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "pdcc",
        motor: "teknic-m2310p",
        settings: &[
            ("modulation", "pair"),
            ("saturation", "keep_angle"),
            ("delay", "0"),
            ("word", "16"),
            ("discretisation", "euler"),
            ("start_up", "short"),
        ],
    },
];

/// Names of the unnoticed faults of a drive; the number of all.
fn plant(drive: &Drive) -> (Vec<String>, usize) {
    let (_, generated) = generate_toml(&drive.toml(None)).expect("the drive generates");
    let program = generated.graph.program();
    let cases = record_states(&generated, STEPS, 1).expect("the drive has a model");
    // Most faults show at once.
    let few = &cases[..250];
    let noticed = |program: &Program| {
        compare_cases(&generated, program, few).is_err()
            || compare(&generated, program, STEPS / 10, 1).is_err()
            || compare_cases(&generated, program, &cases).is_err()
            || compare(&generated, program, STEPS, 1).is_err()
    };
    assert!(
        !noticed(program),
        "{} {} differs without a fault",
        drive.kind,
        drive.motor
    );
    let all: Vec<Fault> = faults(program).collect();
    let unnoticed = all
        .par_iter()
        .filter(|fault| !noticed(&fault.program))
        .map(|fault| format!("{}: {}", fault.place, fault.what))
        .collect();
    (unnoticed, all.len())
}

#[test]
fn every_planted_fault_is_noticed() {
    let mut wrong: Vec<String> = vec![];
    for drive in DRIVES {
        let name = &format!("{} {}", drive.kind, drive.motor)[..];
        let mut listed: BTreeMap<String, &str> = BTreeMap::new();
        for row in EQUIVALENT.iter().filter(|row| row.drives.contains(&name)) {
            for (place, what) in row.faults() {
                let fault = format!("{place}: {what}");
                if listed.insert(fault, row.because).is_some() {
                    wrong.push(format!("{name}: {place}: {what}: listed twice"));
                }
            }
        }
        let (unnoticed, planted) = plant(drive);
        println!(
            "{name}: {planted} faults, {} of them equivalent",
            unnoticed.len()
        );
        assert!(planted >= 500, "{name}: {planted} faults");
        for fault in unnoticed {
            if listed.remove(&fault).is_none() {
                wrong.push(format!("{name}: {fault}: unnoticed"));
            }
        }
        for (fault, because) in listed {
            let text = format!("{name}: {fault}: noticed or not planted, against \"{because}\"");
            wrong.push(text);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
