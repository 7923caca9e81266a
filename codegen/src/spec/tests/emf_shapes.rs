//! EMF shapes as data: what is taken, and what is told of data that cannot be.

use crate::spec::{EmfShape, Harmonics, check, parse_toml};
use std::f64::consts::TAU;

/// Peak of a phase's EMF over mechanical speed of the 660 W motor, V s/rad.
const PHASE: f64 = 0.0824;
/// 1000 rpm.
const OMEGA: f64 = 1000.0 * TAU / 60.0;

/// The shape of the 660 W motor with other lines in place of its own shape, or what is told.
fn shape(lines: &str) -> Result<(EmfShape, String), String> {
    let motor = include_str!("../../example.toml");
    let text = motor.replace("emf_shape = \"trapezoidal\"\n", &format!("{lines}\n"));
    parse_toml(&text, "m.toml")
        .and_then(|ast| check(&ast))
        .map(|(spec, _)| (spec.motor.emf_shape, spec.to_toml()))
        .map_err(|told| told.to_string())
}

/// Samples of a voltage over a number of turns.
fn samples(turns: f64, of: impl Fn(f64) -> f64) -> String {
    let angles = (0..120).map(|step| turns * TAU * f64::from(step) / 120.0);
    let values: Vec<String> = angles.map(|theta| format!("{:.4}", of(theta))).collect();
    format!(
        "emf_shape = \"samples\"\nemf_samples = [{}]",
        values.join(", ")
    )
}

fn series() -> Harmonics {
    Harmonics::of([(5, 0.06, 0.5), (7, -0.03, 0.0)])
}

/// Between two terminals, begun somewhere; of the speed and the EMF constant of the test.
fn line(theta: f64) -> f64 {
    let volts = 0.1648 * OMEGA / series().line_peak();
    volts * (series().at(theta + 1.0) - series().at(theta + 1.0 - TAU / 3.0))
}

#[test]
fn harmonics_and_a_trace_of_them_are_one_shape() {
    let lines = "emf_shape = \"harmonics\"\nemf_orders = [7, 5]\nemf_amplitudes = [\"-3 %\", \"6 %\"]\n\
                 emf_phases = [\"0 deg\", \"28.64788975654116 deg\"]";
    let (stated, text) = shape(lines).expect("is right");
    let EmfShape::Harmonics(found) = stated else {
        panic!("{stated:?}");
    };
    assert!(
        text.contains("emf_shape = \"harmonics\"\nemf_sines = ["),
        "{text}"
    );
    let speed = "emf_samples_speed = \"1000 rpm\"";
    let (traced, _) = shape(&format!("{}\n{speed}", samples(1.0, line))).expect("is right");
    for theta in [0.0, 0.5, 1.0, 2.0, 4.0] {
        let value = series().at(theta);
        assert!((found.at(theta) - value).abs() < 1e-9, "{theta}");
        assert!((traced.at(theta) - value).abs() < 1e-4, "{theta}");
    }
}

#[test]
fn the_constant_is_that_between_terminals_whatever_the_shape() {
    let text = shape(&samples(1.0, line)).expect("is right").1;
    let constant = text
        .lines()
        .find_map(|text| text.strip_prefix("emf_constant = "));
    let constant: f64 = constant
        .and_then(|text| text.parse().ok())
        .expect("a number");
    let expected = 2.0 * PHASE / series().line_peak();
    assert!(
        (constant / expected - 1.0).abs() < 1e-3,
        "{constant} {expected}"
    );
}

#[test]
fn a_constant_of_a_phase_is_refused_beside_a_trace() {
    for constant in ["0.0824 V/(rad/s) phase peak", "20.6 mWb"] {
        let lines = samples(1.0, line);
        let motor = include_str!("../../example.toml");
        let motor = motor.replace("0.1648 V/(rad/s) line_to_line peak", constant);
        let text = motor.replace("emf_shape = \"trapezoidal\"\n", &format!("{lines}\n"));
        let told = parse_toml(&text, "m.toml").and_then(|ast| check(&ast));
        let told = told.expect_err(constant).to_string();
        assert!(told.contains("[HX0206]"), "{told}");
        assert!(
            told.contains("give the constant with `line_to_line`"),
            "{told}"
        );
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}

#[test]
fn traces_that_cannot_be_are_told_with_a_remedy() {
    let phase = Harmonics::of([(3, 0.18, 0.0)]);
    let slow = format!("{}\nemf_samples_speed = \"1200 rpm\"", samples(1.0, line));
    for (lines, told) in [
        (samples(0.9, line), "give one whole electrical period"),
        (samples(2.0, line), "give the voltage between two terminals"),
        (
            samples(1.0, |theta| line(theta) + 3.0),
            "offset and even harmonics are",
        ),
        (
            samples(1.0, |theta| phase.at(theta)),
            "not of one to the star point",
        ),
        (samples(1.0, |_| 0.0), "no fundamental in them"),
        (slow, "at 1200 rpm the samples peak at 17.2"),
    ] {
        let error = shape(&lines).expect_err(told);
        assert!(error.contains("[HX0214]"), "{error}");
        assert!(error.contains(told), "{error}");
    }
}
