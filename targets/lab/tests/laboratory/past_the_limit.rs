//! At 120 % of rated speed every controller reaches at least nine tenths of the torque of the
//! nearest-point rule with the same options, except one rule, which is listed with its torque.

use hexagen_lab::closed_loop::{RunOptions, mean_torque};
use hexagen_lab::engine::{Model, MotorSource, plant_of, prepare, run_of};
use rayon::prelude::*;
use std::ops::Range;

/// Speed, relative to the rated one, at which every controller of this motor has lost its rated
/// torque, except those with a proportional reference.
const SPEED: f64 = 1.2;

/// Fraction of the nearest-point rule's torque that is no collapse.
const KEPT: f64 = 0.9;

/// The exception, by a part of its variants' names, and its fraction of the nearest-point rule's
/// torque. Scaling a voltage that points across the EMF, as in commutations, leaves too little
/// along the EMF; above the limit, quasi-square references demand commutations all the time.
const SHORT: [&str; 3] = [
    "modulation=three_phase",
    "saturation=keep_angle",
    "reference=quasi_square",
];
const SHORT_REACHES: Range<f64> = 0.70..0.90;

/// Mean torque in newton metres at the demand of rated torque.
fn torque(motor: &MotorSource, variant: &str) -> f64 {
    let drive = prepare(motor, Some(variant)).expect("generates");
    let plant = plant_of(&drive.spec);
    let demand = drive.demand();
    let set_point = drive.set_point(demand);
    let run = RunOptions {
        starts: vec![0.1],
        ..run_of(&drive.spec, SPEED * drive.spec.motor.rated_speed, demand)
    };
    let maker = drive.maker(Model::Fixed, set_point);
    let torque = mean_torque(&plant, &run, &maker).expect("runs");
    torque.unwrap_or_else(|trip| panic!("{variant}: {trip}"))
}

/// Every variant with its nearest-point counterpart.
fn pairs() -> Vec<(String, String)> {
    let mut pairs = Vec::new();
    for kind in [
        "pdcc:modulation=three_phase",
        "pdcc:modulation=pair",
        "pi-pwm:modulation=three_phase",
    ] {
        for emf in ["estimated", "model"] {
            for reference in ["quasi_square", "proportional"] {
                // A pair of legs cannot drive three currents: such a variant is invalid.
                if kind.ends_with("pair") && reference == "proportional" {
                    continue;
                }
                let variant = |saturation: &str| {
                    format!("{kind},saturation={saturation},emf={emf},reference={reference}")
                };
                for saturation in ["keep_angle", "torque_priority"] {
                    pairs.push((variant(saturation), variant("nearest")));
                }
            }
        }
    }
    for kind in ["fcs-mpc", "phcc"] {
        for emf in ["estimated", "model"] {
            pairs.push((
                format!("{kind}:emf={emf}"),
                format!("pdcc:reference=quasi_square,saturation=nearest,emf={emf}"),
            ));
        }
    }
    pairs
}

#[test]
fn no_controller_collapses_past_its_limit() {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    let reached: Vec<(String, f64)> = pairs()
        .into_par_iter()
        .map(|(variant, nearest)| {
            let part = torque(&motor, &variant) / torque(&motor, &nearest);
            (variant, part)
        })
        .collect();
    let mut short = 0;
    for (variant, part) in &reached {
        if SHORT.iter().all(|part| variant.contains(part)) {
            short += 1;
            assert!(SHORT_REACHES.contains(part), "{variant} reaches {part:.3}");
        } else {
            assert!(*part >= KEPT, "{variant} reaches {part:.3}");
        }
    }
    assert_eq!(short, 2 * 2, "{reached:?}");
}
