//! The comparison detects small faults planted in the IR: a score per drive, and the survivors by
//! name.
//!
//! Many survivors are equivalent: padding of tables, limits that cannot act, ties that lead to the
//! same vector. So the score is less than 100 %, and must not fall.

use hexagen_codegen::interface::Watch;
use hexagen_codegen::ir::{Op, Program};
use hexagen_codegen::pipeline::Generated;
use hexagen_tests::faults::{DRIVES, Fault, LEAST_NOTICED, faults, wrong_limits};
use hexagen_tests::interpreter::{compare, compare_all_set_points, compare_record, record_states};
use hexagen_tests::options::{Drive, generate_toml};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fs;

/// Steps of each kind within which a fault must be detected.
const STEPS: u64 = 40_000;

/// Names of the constants that the setters use.
fn constants_of_setters(program: &Program) -> BTreeSet<String> {
    let nodes = program.setters.iter().flat_map(|(_, setter)| &setter.nodes);
    let used = nodes.filter_map(|node| match node.op {
        Op::Constant(id) => Some(program.constants[id.index()].name.clone()),
        _ => None,
    });
    used.collect()
}

/// Names of the undetected faults of a drive; the number of all.
fn plant(drive: &Drive) -> (Vec<String>, usize) {
    let (_, generated) = generate_toml(&drive.toml(None)).expect("the drive generates");
    let program = generated.graph.program();
    let all = record_states(&generated, STEPS, 1).expect("the drive has a model");
    // Most faults appear at once.
    let (few, some) = (all.first(250), all.first(7500));
    let setters = constants_of_setters(program);
    let noticed = |program: &Program| {
        compare_record(&generated, program, &few).is_err()
            || compare(&generated, program, STEPS / 8, 1).is_err()
            || compare_record(&generated, program, &some).is_err()
    };
    assert!(
        !noticed(program),
        "{} differs without a fault",
        drive.name()
    );
    let planted: Vec<Fault> = faults(program).collect();
    let unnoticed = planted
        .par_iter()
        .map(|fault| (fault, fault.name()))
        .filter(|(fault, _)| !noticed(&fault.program))
        .filter(|(fault, _)| {
            let is_of_setters = fault.place.starts_with("set_") || setters.contains(&fault.place);
            !is_of_setters || compare_all_set_points(&generated, &fault.program).is_ok()
        })
        .map(|(_, name)| name)
        .collect();
    (unnoticed, planted.len())
}

#[test]
fn planted_faults_are_detected() {
    let (mut survivors, mut low) = (String::new(), vec![]);
    for (drive, least) in DRIVES.iter().zip(LEAST_NOTICED) {
        let name = drive.name();
        let (unnoticed, planted) = plant(drive);
        let noticed = planted - unnoticed.len();
        println!("{name}: {noticed} of {planted} faults noticed");
        assert!(planted >= 250, "{name}: {planted} faults");
        if 100 * noticed < usize::from(least) * planted {
            low.push(format!(
                "{name}: {noticed} of {planted}, less than {least} %"
            ));
        }
        let lines = unnoticed.iter().map(|fault| format!("{name}: {fault}\n"));
        survivors.extend(lines);
    }
    let file = concat!(env!("CARGO_TARGET_TMPDIR"), "/survivors.txt");
    fs::write(file, survivors).expect("the folder of test outputs");
    println!("survivors: {file}");
    assert!(low.is_empty(), "{low:#?}; survivors: {file}");
}

/// The drive-specific parameters of the supervisor.
#[test]
fn every_wrong_limit_is_detected() {
    let (mut planted, mut unnoticed) = (0, vec![]);
    for drive in DRIVES {
        let (_, sound) = generate_toml(&drive.toml(None)).expect("the drive generates");
        let record = record_states(&sound, STEPS, 1).expect("the drive has a model");
        for (what, limits) in wrong_limits(&sound.interface.limits) {
            planted += 1;
            let mut faulty = sound.clone();
            faulty.interface.limits = limits;
            // Otherwise such a drive does not compile.
            let noticed = !hexagen_lab::limits(&limits).hold(&hexagen_lab::sensors(&limits))
                || compare_record(&faulty, sound.graph.program(), &record).is_err()
                || compare(&faulty, sound.graph.program(), STEPS, 1).is_err();
            if !noticed {
                unnoticed.push(format!("{}: {what}", drive.name()));
            }
        }
    }
    println!("{planted} wrong limits");
    assert!(planted > 15 * DRIVES.len(), "{planted}");
    assert!(unnoticed.is_empty(), "{}", unnoticed.join("\n"));
}

/// A drive whose speed is watched, of edges that a timer counts.
const WATCHED: Drive = Drive {
    kind: "pdcc",
    motor: "hurst-long",
    settings: &[("over_speed", "watched"), ("hall_capture", "timer")],
};

#[test]
fn a_wrong_over_speed_is_detected() {
    let (_, sound) = generate_toml(&WATCHED.toml(None)).expect("the drive generates");
    let record = record_states(&sound, STEPS, 1).expect("the drive has a model");
    let is_noticed = |drive: &Generated, program: &Program| {
        compare_record(drive, program, &record).is_err()
            || compare(drive, program, STEPS, 1).is_err()
    };
    assert!(
        !is_noticed(&sound, sound.graph.program()),
        "without a fault"
    );
    let watch = sound.interface.over_speed.expect("a watch");
    for most in [watch.most - 1, watch.most + 1] {
        let mut faulty = sound.clone();
        faulty.interface.over_speed = Some(Watch { most, ..watch });
        assert!(is_noticed(&faulty, sound.graph.program()), "{most} edges");
    }
    let of_speed = |fault: &Fault| fault.name().contains("over_speed");
    let planted: Vec<Fault> = faults(sound.graph.program()).filter(of_speed).collect();
    assert!(planted.len() > 2, "{} faults", planted.len());
    for fault in planted {
        assert!(is_noticed(&sound, &fault.program), "{}", fault.name());
    }
}
