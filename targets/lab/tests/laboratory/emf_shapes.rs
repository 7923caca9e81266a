//! EMF shapes as data: with the true shape stated the torque is smooth, with another one it is not.

use hexagen_codegen::spec::{EmfShape, Harmonics};
use hexagen_lab::closed_loop::{RunOptions, measure};
use hexagen_lab::engine::{Model, MotorSource, PlantOptions, Prepared, prepare};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Shapes between trapezoid and sine: harmonics, and rounded tops. Two of them are skewed: the halves of a
/// half wave differ.
fn shapes() -> Vec<(&'static str, String)> {
    let harmonics = |orders: &str, amplitudes: &str, phases: &str| {
        format!(
            "emf_shape = \"harmonics\"\nemf_orders = {orders}\nemf_amplitudes = {amplitudes}\nemf_phases = {phases}"
        )
    };
    let rounded = |sharpness: f64| {
        let phase = move |theta: f64| (sharpness * theta.sin()).tanh() / sharpness.tanh();
        let values = (0..180).map(|step| {
            let theta = TAU * f64::from(step) / 180.0 + 0.3;
            format!("{:.4}", phase(theta) - phase(theta - TAU / 3.0))
        });
        let values: Vec<String> = values.collect();
        format!(
            "emf_shape = \"samples\"\nemf_samples = [{}]",
            values.join(", ")
        )
    };
    vec![
        (
            "third, fifth and seventh",
            harmonics(
                "[3, 5, 7]",
                "[\"20 %\", \"5 %\", \"2 %\"]",
                "[\"0 deg\", \"0 deg\", \"0 deg\"]",
            ),
        ),
        (
            "peaked",
            harmonics("[5, 7]", "[\"-6 %\", \"4 %\"]", "[\"0 deg\", \"0 deg\"]"),
        ),
        (
            "slots",
            harmonics("[11, 13]", "[\"3 %\", \"2 %\"]", "[\"0 deg\", \"0 deg\"]"),
        ),
        (
            "skewed",
            harmonics("[5, 7]", "[\"8 %\", \"4 %\"]", "[\"60 deg\", \"-40 deg\"]"),
        ),
        ("rounded tops", rounded(2.2)),
        ("nearly a trapezoid", rounded(4.0)),
    ]
}

/// The 660 W motor, which turns 2.4 electrical degrees per period at rated speed.
fn drive(shape: &str, variant: Option<&str>) -> Prepared {
    let mut motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    motor.text = motor
        .text
        .replace("emf_shape = \"trapezoidal\"", shape)
        .replace("rated_torque = \"3.3 Nm\"\n", "");
    prepare(&motor, variant).unwrap_or_else(|why| panic!("{shape}: {why}"))
}

/// Mean torque over the demand, and ripple over the demand, percent.
fn torque(drive: &Prepared, plant: &PlantOptions, rpm: f64, demand: f64) -> [f64; 2] {
    let run = RunOptions {
        starts: vec![0.1],
        ..plant.run(drive, rpm, demand)
    };
    let maker = drive.maker(Model::Fixed, plant.set_point(drive, demand));
    let measured = measure(&plant.plant(drive).expect("sound"), &run, maker).expect("runs");
    assert_eq!(measured.tripped, None, "{rpm} rpm");
    let figures = measured.figures;
    [
        figures.mean_torque_nm.expect("runs") * 100.0 / demand,
        figures.ripple_pp_pct.expect("runs"),
    ]
}

#[test]
fn with_the_true_shape_stated_the_torque_is_smooth() {
    let nominal = PlantOptions::default();
    shapes().par_iter().for_each(|(name, shape)| {
        for variant in [None, Some("pdcc:emf=model")] {
            let drive = drive(shape, variant);
            for (rpm, sign) in [(400.0, 1.0), (2000.0, 1.0), (-2000.0, -1.0), (1500.0, -1.0)] {
                let [mean, ripple] = torque(&drive, &nominal, rpm, sign * drive.demand());
                let told = format!("{name} {variant:?} {rpm} rpm: {mean} % {ripple} %");
                assert!((mean - 100.0).abs() < 1.0, "{told}");
                assert!(ripple < 1.0, "{told}");
            }
        }
    });
}

/// The reason for the feature.
#[test]
fn with_a_trapezoid_stated_in_its_place_it_ripples() {
    let trapezoid = drive("emf_shape = \"trapezoidal\"", None);
    let plant = PlantOptions {
        emf_shape: Some(EmfShape::Harmonics(Harmonics::of([
            (5, -0.06, 0.0),
            (7, 0.04, 0.0),
        ]))),
        ..PlantOptions::default()
    };
    let [mean, ripple] = torque(&trapezoid, &plant, 1500.0, 2.8);
    assert!(ripple > 4.0, "{mean} % {ripple} %");
}
