//! Disturbances, alone and two at once: no default drive of the library trips, and none oscillates.

use hexagen_lab::engine::{PerSensor, PlantOptions, Prepared, SelectedMotor};
use hexagen_lab::robustness::{Outcome, measured};
use rayon::prelude::*;

/// Drives whose modulator and observer correct a wrong plant.
const VARIANTS: [&str; 2] = ["pdcc", "pi-pwm"];

/// Speeds over the rated one.
const SPEEDS: [f64; 3] = [0.1, 0.75, 1.0];

/// A change of a drive's plant.
type Change = fn(&mut PlantOptions, &Prepared);

/// Disturbances; two of one kind, which is their first word, make no pair.
const DISTURBANCES: [(&str, Change); 16] = [
    ("none", |_, _| ()),
    ("R x 0.5", |plant, _| plant.scale_r = Some(0.5)),
    ("R x 2", |plant, _| plant.scale_r = Some(2.0)),
    ("L x 0.75", |plant, _| plant.scale_l = Some(0.75)),
    ("L x 1.3", |plant, _| plant.scale_l = Some(1.3)),
    ("k_b x 0.8", |plant, _| plant.scale_kb = Some(0.8)),
    ("k_b x 1.2", |plant, _| plant.scale_kb = Some(1.2)),
    ("bus x 0.85", |plant, drive| {
        plant.v_bus = Some(0.85 * drive.spec.inverter.v_bus);
    }),
    ("dead time, 1 us more", |plant, drive| {
        plant.dead_time = Some(drive.spec.inverter.dead_time + 1e-6);
    }),
    ("sensors all 5 deg late", |plant, _| {
        plant.hall_error = Some([5.0; 3]);
    }),
    ("sensors all 5 deg early", |plant, _| {
        plant.hall_error = Some([-5.0; 3]);
    }),
    ("sensors, one 5 deg late", |plant, drive| {
        // An angle sensor is one.
        let others = if drive.spec.angle_sensor().is_some() {
            5.0
        } else {
            0.0
        };
        plant.hall_error = Some([5.0, others, others]);
    }),
    ("sensors 5 deg apart", |plant, drive| {
        let is_one = drive.spec.angle_sensor().is_some();
        plant.hall_error = Some(if is_one { [-5.0; 3] } else { [5.0, -5.0, 0.0] });
    }),
    ("ADC 0.5 % of the range off", |plant, drive| {
        let inverter = &drive.spec.inverter;
        let range = inverter.adc_gain.abs() * f64::from(1_u32 << (inverter.adc_bits - 1));
        plant.adc_offset = Some(PerSensor(vec![0.005 * range]));
    }),
    ("gain of one ADC 2 % more", |plant, drive| {
        let mut scales = vec![1.0; drive.spec.inverter.sensors().len()];
        scales[0] = 1.02;
        plant.scale_adc = Some(PerSensor(scales));
    }),
    ("noise, 1 count rms", |plant, _| {
        plant.adc_noise = Some(1.0);
    }),
];

fn kind(name: &str) -> Option<&str> {
    name.split([' ', ',']).next()
}

/// Outcome of a drive at rated torque under two disturbances, from one start.
fn outcome(drive: &Prepared, changes: [Change; 2], speed: f64) -> Outcome {
    let mut plant = PlantOptions {
        start_angle: Some(0.1),
        ..PlantOptions::default()
    };
    for change in changes {
        change(&mut plant, drive);
    }
    let torque = drive.demand();
    let params = plant.plant(drive).expect("is possible");
    let run = plant.run(drive, speed * drive.rated_rpm(), torque);
    let set_point = plant.set_point(drive, torque);
    let expected = torque * plant.scale_kb.unwrap_or(1.0);
    let run = measured(drive, &params, &run, set_point, expected).expect("runs");
    run.judged(&run).outcome
}

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn no_pair_of_disturbances_trips_a_default_drive_or_makes_it_oscillate() {
    let library = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let drives: Vec<(String, Prepared)> = library
        .iter()
        .flat_map(|motor| {
            VARIANTS.map(|variant| {
                let name = format!("{} {variant}", motor.source.name);
                (name, motor.prepare(Some(variant)).expect("generates"))
            })
        })
        .collect();
    let mut pairs = Vec::new();
    for (place, first) in DISTURBANCES.iter().enumerate() {
        let others = DISTURBANCES[place + 1..].iter();
        let others = others.filter(|second| kind(first.0) != kind(second.0));
        pairs.extend(others.map(|second| (first, second)));
    }
    let runs: Vec<_> = drives
        .iter()
        .flat_map(|drive| pairs.iter().map(move |pair| (drive, pair)))
        .flat_map(|(drive, pair)| SPEEDS.map(|speed| (drive, pair, speed)))
        .collect();
    println!("{} runs", runs.len());
    assert!(runs.len() > 8000, "{} runs", runs.len());
    let diverging = runs
        .par_iter()
        .filter_map(|((name, drive), (first, second), speed)| {
            let outcome = outcome(drive, [first.1, second.1], *speed);
            let what = format!("{name}: {} and {} at {speed}", first.0, second.0);
            (outcome != Outcome::Runs).then(|| format!("{what}: {}", outcome.name()))
        });
    let diverging: Vec<String> = diverging.collect();
    assert!(
        diverging.is_empty(),
        "{} of {} diverge: {diverging:#?}",
        diverging.len(),
        runs.len()
    );
}
