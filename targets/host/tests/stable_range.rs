//! The stable range of L and R that types and data sheets state, against simulation: loops stay calm inside of it
//! and oscillate outside, by the rule of the robustness sheet.

use hexagen_codegen::controllers::{StableRange, stable_range};
use hexagen_host::closed_loop::{RunOptions, Swing, measure};
use hexagen_host::engine::{Model, MotorSource, Prepared, plant_of, prepare, run_of};
use hexagen_host::report::{Measured, Outcome};
use rayon::prelude::*;

/// Motors of different size, with Ts/L from 0.08 to 0.25 A/V and R Ts/L from 0.03 to 0.09.
const MOTORS: [&str; 4] = [
    "trivedi-keshri-660w",
    "anaheim-bly172s",
    "hurst-long",
    "teknic-m2310p",
];

/// Loops whose EMF is estimated, and one that does without.
const LOOPS: [&str; 7] = [
    "pdcc",
    "pdcc:saturation=nearest,modulation=pair",
    "pdcc:emf_filter=0.5",
    "pdcc:emf_filter=1",
    "pi-pwm",
    "pi-pwm:bandwidth=2kHz",
    "pi-pwm:feed_forward=off",
];

/// Edges that are run. Farther away there are no motors, and a loop with many times the inductance leaves its range
/// by slow growth, which is not what the rule looks for; the search for the range itself ends at 0.1 and 10.
const EDGES: (f64, f64) = (0.2, 4.0);

/// How far inside or outside of an edge a loop is run, in parts of the edge.
const DISTANCE: f64 = 0.07;

/// Speed in parts of the rated one: so low that a loop near its edge calms down between commutations.
const SPEED: f64 = 0.1;

/// How the drive runs at rated torque on a motor with other L and R.
fn outcome(drive: &Prepared, resistance: f64, inductance: f64) -> (Outcome, Swing) {
    let nominal = plant_of(&drive.spec);
    let torque = drive.demand();
    let set_point = drive.set_point(torque);
    let run = RunOptions {
        starts: vec![0.1],
        ..run_of(&drive.spec, SPEED * drive.spec.motor.rated_speed, torque)
    };
    let v_bus = nominal.v_bus;
    let plant = nominal.scaled(resistance, inductance, 1.0);
    let measured = measure(&plant, &run, drive.maker(Model::Fixed, set_point)).expect("runs");
    let swing = Swing::of(&measured.traces[0].periods, run.current, v_bus);
    let measured = Measured {
        engine: drive.engine_kind(),
        modulates: true,
        expected_torque: torque,
        merits: measured.merits,
        swing,
        tripped: measured.tripped,
    };
    (measured.judged(&measured).outcome, swing)
}

/// Runs one loop on both sides of its edges; how many edges there are within [`EDGES`].
fn check_loop(motor: &str, variant: &str) -> usize {
    let source = MotorSource::of_library(motor).expect("is in the library");
    let drive = prepare(&source, Some(variant)).expect("generates");
    let StableRange {
        inductance,
        resistance,
    } = stable_range(&drive.spec).expect("a linear loop");
    let check = |[r, l]: [f64; 2], is_stable: bool| {
        let found = outcome(&drive, r, l);
        let calm = found.0 == Outcome::Runs;
        assert_eq!(
            calm, is_stable,
            "{motor}, {variant}, R x {r:.3}, L x {l:.3}: {found:?}"
        );
    };
    check([1.0, 1.0], true);
    let sides = [
        (inductance.0, 1.0 + DISTANCE),
        (inductance.1, 1.0 - DISTANCE),
    ];
    let edges = sides
        .into_iter()
        .filter(|(edge, _)| (EDGES.0..EDGES.1).contains(edge));
    let count = edges.clone().count();
    for (edge, inward) in edges {
        check([1.0, edge * inward], true);
        check([1.0, edge / inward], false);
    }
    // Far beyond twice the stated resistance the bus cannot drive the current.
    for factor in [0.3, 0.7, 1.3, 2.0] {
        let is_stable = (resistance.0..=resistance.1).contains(&factor);
        check([factor, 1.0], is_stable);
    }
    count
}

#[test]
fn loops_are_calm_inside_and_oscillate_outside_of_their_stable_range() {
    let edges: usize = MOTORS
        .into_par_iter()
        .flat_map(|motor| LOOPS.into_par_iter().map(move |variant| (motor, variant)))
        .map(|(motor, variant)| check_loop(motor, variant))
        .sum();
    // Estimated deadbeat has two edges, PI its lower one.
    assert!(edges >= MOTORS.len() * (4 * 2 + 2), "{edges} edges");
}
