//! Hall edges that are seen at samples only: the ripple in the generator's warning against that of simulated runs.

use crate::defaults::{envelope, set_aside};
use hexagen_codegen::spec::RotorSensing;
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor};
use hexagen_lab::motors::{QUADRANTS, TORQUE};
use rayon::prelude::*;

/// Speeds over the rated one. In some of them a sixth of a turn is a whole number of periods, and edges are seen in
/// time.
const SPEEDS: [f64; 6] = [0.90, 0.92, 0.94, 0.96, 0.98, 1.0];

/// Ripple of a drive without any error of the angle: quantisation, percent.
const FLOOR: f64 = 0.7;

/// Stated ripple, percent, from which on the jump of the current is a large part of the current and no longer in
/// proportion to that of the angle.
const LARGE: f64 = 30.0;

/// Greatest measured over stated ripple, beyond the floor: below and above [`LARGE`].
const BEYOND: [f64; 2] = [1.3, 2.0];

/// Greatest stated over measured ripple, beyond the floor.
const SHORT: f64 = 1.3;

/// The greatest ripple, percent, and the torque furthest from the demand, over it, of both directions, motoring and
/// braking.
fn worst(drive: &Prepared) -> (f64, f64) {
    let rated = drive.spec.motor.rated_speed;
    let runs = QUADRANTS.into_iter().flat_map(|(direction, mode)| {
        SPEEDS.map(|speed| {
            (
                f64::from(direction) * speed * rated,
                f64::from(direction * mode),
            )
        })
    });
    runs.fold((0.0, 1.0), |(ripple, torque), (omega, sign)| {
        let demand = sign * drive.demand();
        let run = drive.measure_at(omega, demand).expect("runs");
        assert!(run.tripped.is_none(), "{} {omega}", drive.motor);
        let mean: f64 = run.figures.mean_torque_nm.expect("a torque") / demand;
        let is_farther = (mean - 1.0).abs() > f64::abs(torque - 1.0);
        let here = run.figures.ripple_pp_pct.expect("a ripple");
        (
            f64::max(ripple, here),
            if is_farther { mean } else { torque },
        )
    })
}

/// Checks all drives with sampled edges of these motors, and tells how many they are.
fn check(motors: &[SelectedMotor]) -> usize {
    let drives = motors.iter().flat_map(|motor| {
        ["pdcc", "pi-pwm"].into_iter().filter_map(move |law| {
            let variant = format!("{law}:hall_capture=sampled");
            Some((law, motor.prepare(Some(&variant)).ok()?))
        })
    });
    // Beyond the envelope the bus adds a ripple of its own, and another warning tells of it.
    let counts = |drive: &Prepared| {
        drive.spec.inverter.rotor_sensing == RotorSensing::SampledHalls && envelope(drive) >= 100.0
    };
    let drives: Vec<_> = drives.filter(|(_, drive)| counts(drive)).collect();
    let (lines, wrong): (Vec<_>, Vec<_>) = drives
        .par_iter()
        .map(|(law, drive)| {
            let stated = 100.0 * drive.spec.sampled_ripple().expect("is sampled");
            let (ripple, torque) = worst(drive);
            let degrees = drive.spec.degrees_per_period();
            let text = format!(
                "{:22} {law:6} {degrees:5.2} deg: {stated:5.1} % told, {ripple:5.1} % and {torque:.4} of the torque measured",
                drive.motor
            );
            let beyond = BEYOND[usize::from(stated > LARGE)];
            // Nothing to be told of.
            let is_smooth = drive.spec.told_sampled_ripple().is_none();
            let is_right = ripple <= beyond * stated + FLOOR
                && stated <= SHORT * ripple + FLOOR
                && (!is_smooth || (torque - 1.0).abs() <= TORQUE / 100.0);
            (text.clone(), (!is_right).then_some(text))
        })
        .unzip();
    println!("{}", lines.join("\n"));
    let wrong: Vec<String> = wrong.into_iter().flatten().collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    drives.len()
}

#[test]
fn the_ripple_is_the_one_that_the_generator_tells() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let drives = check(&motors);
    assert!(drives >= 20, "{drives}");
}

/// Of motors on which the formula was not fitted.
#[test]
fn the_ripple_is_that_of_the_motors_set_aside() {
    let drives = check(&set_aside());
    assert!(drives >= 10, "{drives}");
}
