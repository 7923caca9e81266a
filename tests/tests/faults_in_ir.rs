//! The comparison notices every small fault planted in the IR, but for those that change nothing, and a few
//! that change next to nothing.

use hexagen_codegen::ir::{Op, Program};
use hexagen_tests::faults::{DRIVES, EQUIVALENT, Fault, RARE, faults, listed, wrong_limits};
use hexagen_tests::interpreter::{compare, compare_all_set_points, compare_record, record_states};
use hexagen_tests::options::{Drive, generate_toml};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Steps of each kind within which a fault must show.
const STEPS: u64 = 40_000;

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
        "{} differs without a fault",
        drive.name()
    );
    let planted: Vec<Fault> = faults(program).collect();
    let unnoticed = planted
        .par_iter()
        .map(|fault| (fault, fault.name()))
        .filter(|(fault, name)| !noticed(&fault.program, name))
        .filter(|(fault, _)| {
            let is_of_setters = fault.place.starts_with("set_") || setters.contains(&fault.place);
            !is_of_setters || compare_all_set_points(&generated, &fault.program).is_ok()
        })
        .map(|(_, name)| name)
        .collect();
    (unnoticed, planted.len())
}

#[test]
fn every_planted_fault_is_noticed() {
    let mut wrong: Vec<String> = vec![];
    for drive in DRIVES {
        let name = &drive.name()[..];
        let mut equivalent = listed(EQUIVALENT, name, &mut wrong);
        let mut rare = listed(RARE, name, &mut wrong);
        let (unnoticed, planted) = plant(drive, &equivalent);
        println!(
            "{name}: {planted} faults, {} of them unnoticed",
            unnoticed.len()
        );
        assert!(planted >= 250, "{name}: {planted} faults");
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

/// What differs from drive to drive of the supervisor.
#[test]
fn every_wrong_limit_is_noticed() {
    let (mut planted, mut unnoticed) = (0, vec![]);
    for drive in DRIVES {
        let (_, sound) = generate_toml(&drive.toml(None)).expect("the drive generates");
        let record = record_states(&sound, STEPS, 1).expect("the drive has a model");
        for (what, limits) in wrong_limits(&sound.interface.limits) {
            planted += 1;
            let mut faulty = sound.clone();
            faulty.interface.limits = limits;
            // Where nothing else notices it, no such drive compiles.
            let noticed = !hexagen_lab::limits(&limits).hold()
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
