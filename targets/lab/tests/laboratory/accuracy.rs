//! Fixed point against the ideal model over the whole library: errors of single steps from the same
//! state are within their proven bounds, and the bounds meet the accuracy goals.

use hexagen_codegen::emit::datasheet::emit_datasheet;
use hexagen_codegen::ir::{StatedError, stated_errors};
use hexagen_codegen::spec::Reference;
use hexagen_lab::accuracy::{OneStep, at_speeds, differences, one_step};
use hexagen_lab::engine::{MotorSource, PlantOptions, Prepared, library, prepare};
use rayon::prelude::*;

/// Controllers with a modulator: by default, and with words and coefficients alone, without a table
/// of the EMF's shape.
const KINDS: [&str; 4] = [
    "pdcc:reference=proportional",
    "pi-pwm:reference=proportional",
    "pdcc:reference=quasi_square",
    "pi-pwm:reference=quasi_square",
];

/// Least share of steps with equal compare values, percent: they differ where the exact duty is near
/// half a count, and by the misfit of a table, which is up to 0.3 counts.
fn least_equal(drive: &Prepared) -> f64 {
    match drive.spec.controller.common().reference {
        Reference::QuasiSquare => 99.3,
        Reference::Proportional => 70.0,
    }
}

fn drive(motor: &MotorSource, variant: &str) -> Prepared {
    prepare(motor, Some(variant)).unwrap_or_else(|errors| panic!("{}: {errors}", motor.name))
}

fn accuracy(drive: &Prepared) -> OneStep {
    let measured = at_speeds(drive, &PlantOptions::default()).expect("runs");
    one_step(drive, measured.iter().map(|(_, both)| both)).0
}

#[test]
fn steps_are_within_the_proven_bounds_and_compare_values_within_a_count() {
    let mut drives = vec![];
    for motor in library().iter().map(MotorSource::from) {
        for kind in KINDS {
            drives.push((32, drive(&motor, kind)));
            drives.push((16, drive(&motor, &format!("{kind},word=16"))));
        }
    }
    assert_eq!(drives.len(), 16 * 8);
    drives.par_iter().for_each(|(word, drive)| {
        let found = accuracy(drive);
        let named = || format!("{}, {}: {found:?}", drive.motor, drive.variant);
        assert!(found.steps > 4000, "{}", named());
        assert!(found.is_within_bounds(), "{}", named());
        // Coarser words round more ties the other way.
        let equal = if *word == 32 { 99.98 } else { 99.95 };
        assert!(found.decisions_equal_pct > equal, "{}", named());
        if *word == 32 {
            assert!(found.compares_apart_counts <= 1, "{}", named());
            assert!(found.equal_steps_pct >= least_equal(drive), "{}", named());
        }
    });
}

#[test]
fn closed_loops_of_32_bit_words_have_the_figures_of_merit_of_floating_point() {
    let variants = [
        "pdcc:reference=quasi_square",
        "pi-pwm:reference=quasi_square",
        "fcs-mpc",
        "fcs-mpc:candidates=all",
        "phcc",
    ];
    let motors = library().iter().map(MotorSource::from);
    let pairs = motors.flat_map(|motor| variants.map(|variant| (motor.clone(), variant)));
    // Whole vectors are too strong for some motors.
    let drives: Vec<Prepared> = pairs
        .filter_map(|(motor, variant)| prepare(&motor, Some(variant)).ok())
        .collect();
    assert!(drives.len() >= 2 * 16 + 3, "{}", drives.len());
    drives.par_iter().for_each(|drive| {
        let named = || format!("{}, {}", drive.motor, drive.variant);
        let measured = at_speeds(drive, &PlantOptions::default()).expect("runs");
        for (rpm, both) in &measured {
            let [fixed, ideal] = [&both.fixed.figures, &both.ideal.figures];
            let reference = drive.spec.controller.common().reference;
            for figure in differences(reference, fixed, ideal, ideal) {
                assert!(figure.close, "{}, {rpm} rpm: {figure:?}", named());
            }
        }
        let found = one_step(drive, measured.iter().map(|(_, both)| both)).0;
        assert!(found.is_within_bounds(), "{}: {found:?}", named());
        assert!(found.decisions_equal_pct > 99.8, "{}: {found:?}", named());
    });
}

#[test]
fn errors_of_the_papers_motor_are_proven_within_the_goal() {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    for kind in KINDS {
        let drive = drive(&motor, kind);
        // The misfit of the shape's table, times the set-point's voltage and the observed error.
        let [most_volts, most_counts] = match drive.spec.controller.common().reference {
            Reference::QuasiSquare => [1e-5, 0.02],
            Reference::Proportional => [0.01, 1.5],
        };
        let stated = stated_errors(drive.generated.graph.program());
        let bound = |name: &str| {
            let stated = stated.iter().find(|stated| stated.name == name);
            stated.map(StatedError::normal_bound).expect("is stated")
        };
        assert!(
            bound("voltage") <= most_volts,
            "{kind}: {} V",
            bound("voltage")
        );
        assert!(
            bound("duty") <= most_counts,
            "{kind}: {} counts",
            bound("duty")
        );
    }
}

#[test]
fn data_sheets_state_the_accuracy_of_16_bit_words() {
    for motor in library().iter().map(MotorSource::from) {
        for kind in KINDS {
            let drive = drive(&motor, &format!("{kind},word=16"));
            let sheet = emit_datasheet(&drive.generated.graph, &drive.generated.interface);
            for name in ["VOLTAGE_ERROR", "DUTY_ERROR"] {
                let row = format!("\n| `{name}` | ");
                assert!(sheet.contains(&row), "{} {kind}: {name}", motor.name);
            }
        }
    }
}
