//! The comparison notices every small fault planted in the IR, but for those that change nothing, and a few
//! that change next to nothing.

mod equivalent;
mod unnoticed;

use equivalent::EQUIVALENT;
use hexagen_codegen::ir::{Op, Program};
use hexagen_tests::faults::{Fault, faults};
use hexagen_tests::interpreter::{compare, compare_all_set_points, compare_record, record_states};
use hexagen_tests::options::{Drive, generate_toml};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use unnoticed::{RARE, Unnoticed};

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
            ("emf", "unfiltered"),
            ("delay", "0"),
            ("word", "16"),
            ("discretisation", "euler"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "trivedi-keshri-660w",
        settings: &[("start_up", "short")],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "hoverboard-hub",
        settings: &[
            ("candidates", "all"),
            ("emf", "model"),
            ("v_bus", "measured"),
            ("hall_capture", "timer"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "estun-emj-04apb22",
        settings: &[
            ("candidates", "all"),
            ("off_leg", "nominal"),
            ("delay", "0"),
            ("word", "16"),
            ("discretisation", "euler"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "teknic-m2310p",
        settings: &[
            ("off_leg", "nominal"),
            ("adc_inverted", "on"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "phcc",
        motor: "trivedi-keshri-660w",
        settings: &[("start_up", "short")],
    },
    Drive {
        kind: "phcc",
        motor: "estun-emj-04apb22",
        settings: &[
            ("table", "given"),
            ("band", "narrow"),
            ("delay", "0"),
            ("word", "16"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "pi-pwm",
        motor: "teknic-m2310p",
        settings: &[("saturation", "nearest"), ("start_up", "short")],
    },
    Drive {
        kind: "pi-pwm",
        motor: "anaheim-bly172s",
        settings: &[
            ("saturation", "keep_angle"),
            ("feed_forward", "off"),
            ("tuning", "slow"),
            ("word", "16"),
            ("v_bus", "measured"),
            ("start_up", "short"),
        ],
    },
];

/// Names of the constants that the setters use.
fn constants_of_setters(program: &Program) -> BTreeSet<String> {
    let nodes = program.setters.iter().flat_map(|setter| &setter.nodes);
    let used = nodes.filter_map(|node| match node.op {
        Op::Constant(id) => Some(program.constants[id.index()].name.clone()),
        _ => None,
    });
    used.collect()
}

/// Names of the unnoticed faults of a drive; the number of all.
fn plant(drive: &Drive, listed: &BTreeMap<String, &str>) -> (Vec<String>, usize) {
    let (_, generated) = generate_toml(&drive.toml(None)).expect("the drive generates");
    let program = generated.graph.program();
    let all = record_states(&generated, STEPS, 1).expect("the drive has a model");
    // Most faults show at once; of those that are known not to, a sample is enough.
    let (few, some) = (all.first(250), all.first(2500));
    let setters = constants_of_setters(program);
    let noticed = |program: &Program, name: &str| {
        compare_record(&generated, program, &few).is_err()
            || compare(&generated, program, STEPS / 10, 1).is_err()
            || compare_record(&generated, program, &some).is_err()
            || !listed.contains_key(name)
                && (compare_record(&generated, program, &all).is_err()
                    || compare(&generated, program, STEPS, 1).is_err())
    };
    assert!(
        !noticed(program, ""),
        "{} {} differs without a fault",
        drive.kind,
        drive.motor
    );
    let planted: Vec<Fault> = faults(program).collect();
    let unnoticed = planted
        .par_iter()
        .map(|fault| (fault, format!("{}: {}", fault.place, fault.what)))
        .filter(|(fault, name)| !noticed(&fault.program, name))
        .filter(|(fault, _)| {
            let is_of_setters = fault.place.starts_with("set_") || setters.contains(&fault.place);
            !is_of_setters || compare_all_set_points(&generated, &fault.program).is_ok()
        })
        .map(|(_, name)| name)
        .collect();
    (unnoticed, planted.len())
}

/// The listed faults of a drive, with the reasons; `wrong` gets those that are listed twice.
fn listed<'r>(
    rows: &'r [Unnoticed],
    drive: &str,
    wrong: &mut Vec<String>,
) -> BTreeMap<String, &'r str> {
    let mut listed = BTreeMap::new();
    for row in rows.iter().filter(|row| row.drives.contains(&drive)) {
        for (place, what) in row.faults() {
            let fault = format!("{place}: {what}");
            if listed.insert(fault, row.because).is_some() {
                wrong.push(format!("{drive}: {place}: {what}: listed twice"));
            }
        }
    }
    listed
}

#[test]
fn every_planted_fault_is_noticed() {
    let mut wrong: Vec<String> = vec![];
    for drive in DRIVES {
        let name = &format!("{} {}", drive.kind, drive.motor)[..];
        let mut equivalent = listed(EQUIVALENT, name, &mut wrong);
        let mut rare = listed(RARE, name, &mut wrong);
        let (unnoticed, planted) = plant(drive, &equivalent);
        println!(
            "{name}: {planted} faults, {} of them unnoticed",
            unnoticed.len()
        );
        assert!(planted >= 300, "{name}: {planted} faults");
        for fault in unnoticed {
            // A rare fault may be noticed, or not.
            if equivalent.remove(&fault).is_none() && rare.remove(&fault).is_none() {
                wrong.push(format!("{name}: {fault}: unnoticed"));
            }
        }
        for (fault, because) in equivalent {
            let text = format!("{name}: {fault}: noticed or not planted, against \"{because}\"");
            wrong.push(text);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
