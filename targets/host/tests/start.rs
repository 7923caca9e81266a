//! Control begins on a rotor that turns: without a trip up to the speed that the type states.

use hexagen_host::closed_loop::ClosedLoop;
use hexagen_host::engine::{Model, MotorSource, Prepared, library, plant_of, prepare, run_of};
use hexagen_host::plant::Plant;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Rotor angles that control begins at.
const ANGLES: u32 = 36;

/// Periods of a run.
const PERIODS: usize = 400;

const VARIANTS: [&str; 8] = [
    "pdcc",
    "pdcc:emf=model",
    "pdcc:delay=0",
    "fcs-mpc",
    "phcc",
    "pi-pwm",
    "pi-pwm:feed_forward=off",
    "pi-pwm:emf=model",
];

/// The greatest speed that the type states, rpm.
fn start_speed(drive: &Prepared) -> f64 {
    let text = drive.generated.interface.constants.iter();
    let constant = text
        .map(|constant| (constant.name.as_str(), &constant.value))
        .find(|(name, _)| *name == "START_SPEED_RPM");
    match constant {
        Some((_, hexagen_codegen::interface::PublicValue::Integer { value, .. })) => *value as f64,
        other => panic!("{other:?}"),
    }
}

/// Whether control that begins at this speed, either way, trips from some angle.
fn trips(drive: &Prepared, rpm: f64) -> bool {
    let set_point = drive.set_point(0.0);
    (0..ANGLES).any(|n| {
        let omega = if n % 2 == 0 { rpm } else { -rpm } * TAU / 60.0;
        let angle = f64::from(n) * TAU / f64::from(ANGLES);
        let plant = Plant::new(plant_of(&drive.spec), angle, omega).expect("a plant");
        let run = run_of(&drive.spec, omega, 0.0);
        let engine = drive.engine(Model::Fixed, set_point);
        let mut closed = ClosedLoop::new(plant, engine, run.delay);
        closed.run(PERIODS, &mut ());
        closed.tripped().is_some()
    })
}

#[test]
fn no_drive_trips_below_the_speed_that_it_states() {
    let outcomes: Vec<(String, [bool; 2])> = library()
        .par_iter()
        .flat_map_iter(|motor| VARIANTS.map(|variant| (motor.name, variant)))
        .filter_map(|(name, variant)| {
            let motor = MotorSource::of_library(name).expect("is in the library");
            let drive = prepare(&motor, Some(variant)).ok()?;
            let rpm = start_speed(&drive);
            let top = drive.spec.inverter.maximum_speed * 60.0 / TAU;
            let beyond = 1.7 * rpm;
            let at = [trips(&drive, rpm), beyond < top && trips(&drive, beyond)];
            Some((format!("{name} {variant}: {rpm} of {top:.0} rpm"), at))
        })
        .collect();
    for (name, [below, beyond]) in &outcomes {
        println!("{name}: below {below}, beyond {beyond}");
    }
    let wrong: Vec<&String> = outcomes
        .iter()
        .filter(|(_, [below, _])| *below)
        .map(|(name, ..)| name)
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    // Beyond it some do: the test sees trips.
    let tripping = outcomes.iter().filter(|(_, [_, beyond])| *beyond).count();
    assert!(tripping >= 3, "{tripping} trip at 1.7 times their speed");
}
