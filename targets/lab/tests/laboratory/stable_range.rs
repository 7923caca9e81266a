//! The stable range of L and R in types and data sheets, against simulation: loops are stable
//! inside and oscillate outside, by the criterion of the robustness sheet.

use hexagen_codegen::laws::{StableRange, stable_range};
use hexagen_lab::engine::{MotorSource, prepare};
use hexagen_lab::robustness::Outcome;
use hexagen_lab::stability::{run_off, sides};
use rayon::prelude::*;

/// Motors of different size, with Ts/L from 0.08 to 0.25 A/V and R Ts/L from 0.03 to 0.09.
const MOTORS: [&str; 4] = [
    "trivedi-keshri-660w",
    "anaheim-bly172s",
    "hurst-long",
    "teknic-m2310p",
];

/// Loops with an estimated EMF, and one without.
const LOOPS: [&str; 7] = [
    "pdcc",
    "pdcc:saturation=nearest,modulation=pair",
    "pdcc:reference=quasi_square,emf_filter=0.5",
    "pdcc:reference=quasi_square,emf_filter=1",
    "pi-pwm",
    "pi-pwm:reference=quasi_square,bandwidth=2kHz",
    "pi-pwm:reference=quasi_square,feed_forward=off",
];

/// Runs one loop on both sides of its edges; returns the number of runs.
fn check_loop(motor: &str, variant: &str) -> usize {
    let source = MotorSource::of_library(motor).expect("is in the library");
    let drive = prepare(&source, Some(variant)).expect("generates");
    let StableRange {
        inductance,
        resistance,
    } = stable_range(&drive.spec).expect("a linear loop");
    let check = |[r, l]: [f64; 2], is_stable: bool| {
        let found = run_off(&drive, r, l).expect("runs");
        let calm = found.outcome == Outcome::Runs;
        assert_eq!(
            calm, is_stable,
            "{motor}, {variant}, R x {r:.3}, L x {l:.3}: {found:?}"
        );
    };
    check([1.0, 1.0], true);
    let edges = sides(inductance);
    for &[inside, outside] in &edges {
        check([1.0, inside], true);
        check([1.0, outside], false);
    }
    // Far above twice the nominal resistance the bus cannot drive the current.
    for factor in [0.3, 0.7, 1.3, 2.0] {
        let is_stable = (resistance.0..=resistance.1).contains(&factor);
        check([factor, 1.0], is_stable);
    }
    edges.len()
}

#[test]
fn loops_are_stable_inside_and_oscillate_outside_of_their_stable_range() {
    let edges: usize = MOTORS
        .into_par_iter()
        .flat_map(|motor| LOOPS.into_par_iter().map(move |variant| (motor, variant)))
        .map(|(motor, variant)| check_loop(motor, variant))
        .sum();
    // Estimated deadbeat has two edges, PI its lower one.
    assert!(edges >= MOTORS.len() * (4 * 2 + 2), "{edges} edges");
}
