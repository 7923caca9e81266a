//! The paper's own modulator in closed loop on the paper's motor: torque, ripple and switching, as guide and semantics have
//! them.

use hexagen_lab::closed_loop::FiguresOfMerit;
use hexagen_lab::engine::{MotorSource, Prepared, prepare};
use hexagen_tests::library::PAPER_MOTOR;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// The paper's torque, Nm.
const TORQUE: f64 = 3.3;

fn drive(variant: &str) -> Prepared {
    let source = MotorSource::of_library(PAPER_MOTOR).expect("a motor of the library");
    prepare(&source, Some(variant)).unwrap_or_else(|errors| panic!("{variant}\n{errors}"))
}

fn at(drive: &Prepared, rpm: f64, torque: f64) -> FiguresOfMerit {
    let measured = drive.measure_at(rpm * TAU / 60.0, torque).expect("runs");
    assert!(measured.tripped.is_none(), "{rpm} rpm, {torque} Nm");
    measured.figures
}

#[test]
fn torque_is_held_in_all_quadrants() {
    const VARIANTS: [&str; 4] = [
        "pdcc:modulation=table2,saturation=nearest",
        "pdcc:modulation=table2,saturation=nearest,zero=pair_low",
        "pi-pwm:modulation=table2",
        "pi-pwm:modulation=table2,zero=pair_low",
    ];
    VARIANTS.par_iter().for_each(|variant| {
        let drive = drive(variant);
        for (rpm, torque) in [(400.0, 1.0), (1500.0, 1.0), (-400.0, 1.0), (1500.0, -1.0)] {
            let figures = at(&drive, rpm, TORQUE * torque);
            let mean = figures.mean_torque_nm.expect("no trip") / TORQUE / torque;
            let ripple = figures.ripple_pp_pct.expect("no trip");
            // With the pair's zero vector the third leg's current flows on through its diodes.
            let most = if variant.ends_with("pair_low") {
                45.0
            } else {
                30.0
            };
            assert!(
                (0.955..1.035).contains(&mean) && ripple < most,
                "{variant}, {rpm} rpm, {torque}: {mean} of the torque, ripple {ripple} %"
            );
        }
    });
}

#[test]
fn figures_are_those_of_the_guide() {
    let table2 = drive("pdcc:modulation=table2,saturation=nearest");
    let three = drive("pdcc:reference=quasi_square,saturation=nearest");
    let slow = at(&table2, 400.0, TORQUE).mean_torque_nm.expect("no trip");
    assert!((slow / TORQUE - 1.02).abs() < 0.005, "{slow} Nm");
    let fast = |drive: &Prepared| {
        let figures = at(drive, 1500.0, TORQUE);
        [figures.switching_hz, figures.ripple_pp_pct].map(|figure| figure.expect("no trip"))
    };
    let [table2_hz, table2_ripple] = fast(&table2);
    let [three_hz, three_ripple] = fast(&three);
    assert!((table2_hz / 1e3 - 11.7).abs() < 0.1, "{table2_hz} Hz");
    assert!((three_hz / 1e3 - 18.1).abs() < 0.1, "{three_hz} Hz");
    assert!((table2_ripple - 26.0).abs() < 1.0, "{table2_ripple} %");
    assert!((three_ripple - 13.0).abs() < 1.0, "{three_ripple} %");
}
