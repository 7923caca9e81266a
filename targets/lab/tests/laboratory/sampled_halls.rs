//! Hall edges that are seen at samples only: the ripple in the generator's warning against that of simulated runs.

use hexagen_codegen::spec::{MOST_RIPPLE, RotorSensing};
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor};
use hexagen_lab::motors::TORQUE;
use hexagen_lab::period::degrees_per_period;
use rayon::prelude::*;

/// Speeds over the rated one. In some of them a sixth of a turn is a whole number of periods, and edges are seen in
/// time.
const SPEEDS: [f64; 6] = [0.90, 0.92, 0.94, 0.96, 0.98, 1.0];

/// Ripple of a drive without any error of the angle: quantisation, percent.
const FLOOR: f64 = 0.7;

/// Greatest measured over stated ripple, beyond the floor.
const BEYOND: f64 = 2.0;

/// Greatest stated over measured ripple.
const SHORT: f64 = 1.6;

/// The greatest ripple, percent, and the torque furthest from the demand, over it.
fn worst(drive: &Prepared) -> (f64, f64) {
    SPEEDS.iter().fold((0.0, 1.0), |(ripple, torque), speed| {
        let demand = drive.demand();
        let run = drive.measure_at(speed * drive.spec.motor.rated_speed, demand);
        let run = run.expect("runs");
        assert!(run.tripped.is_none(), "{} {speed}", drive.motor);
        let mean: f64 = run.figures.mean_torque_nm.expect("a torque") / demand;
        let is_farther = (mean - 1.0).abs() > f64::abs(torque - 1.0);
        let here = run.figures.ripple_pp_pct.expect("a ripple");
        (
            f64::max(ripple, here),
            if is_farther { mean } else { torque },
        )
    })
}

#[test]
fn the_ripple_is_the_one_that_the_generator_tells() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let drives = motors.iter().filter_map(|motor| {
        let drive = motor.prepare(Some("pdcc:hall_capture=sampled")).ok()?;
        (drive.spec.inverter.rotor_sensing == RotorSensing::SampledHalls).then_some(drive)
    });
    let drives: Vec<Prepared> = drives.collect();
    assert!(drives.len() >= 10, "{}", drives.len());
    drives.par_iter().for_each(|drive| {
        let stated = 100.0 * drive.spec.sampled_ripple().expect("is sampled");
        let (ripple, torque) = worst(drive);
        let degrees = degrees_per_period(&drive.spec);
        let text = format!(
            "{:22} {degrees:5.2} deg: {stated:5.1} % told, {ripple:5.1} % and {torque:.4} of the torque measured",
            drive.motor
        );
        println!("{text}");
        assert!(ripple <= BEYOND * stated + FLOOR, "{text}");
        assert!(stated <= SHORT * ripple + FLOOR, "{text}");
        // Nothing to be told of.
        assert!(stated > 100.0 * MOST_RIPPLE || (torque - 1.0).abs() <= TORQUE / 100.0, "{text}");
    });
}
