//! The residual watch (`residual_timeout`): notices currents that do not follow the voltages, and
//! never a sound drive whose motor, bus, dead time or sensors deviate.

use hexagen::Fault;
use hexagen_lab::closed_loop::{ClosedLoop, CurrentLoop};
use hexagen_lab::engine::{
    Model, MotorSource, PlantOptions, Prepared, library, plant_of, prepare, run_of,
};
use hexagen_lab::faults::{FaultStudy, Part, study};
use hexagen_lab::plant::{Mechanics, Plant, PlantParams};
use rayon::prelude::*;

/// The default drives with the watch.
const LAWS: [&str; 2] = ["pdcc:residual_timeout=5ms", "pi-pwm:residual_timeout=5ms"];

fn drive(motor: &str, law: &str) -> Prepared {
    let source = MotorSource::of_library(motor).expect("is in the library");
    prepare(&source, Some(law)).unwrap_or_else(|why| panic!("{motor}: {why}"))
}

fn studied(motor: &str, law: &str) -> FaultStudy {
    let drive = drive(motor, law);
    let options = PlantOptions::default();
    study(&drive, Model::Fixed, &options, drive.demand(), &()).expect("runs")
}

/// Runs of a study that trip, over all rows whose name has these words.
fn trips(study: &FaultStudy, words: &str) -> [usize; 2] {
    let rows = study.rows.iter().filter(|row| row.fault.contains(words));
    rows.fold([0; 2], |[tripped, runs], row| {
        [tripped + row.tripped, runs + row.runs]
    })
}

#[test]
fn dead_sensors_open_phases_and_exchanged_wires_are_noticed() {
    let law = LAWS[0];
    let watched = studied("trivedi-keshri-660w", law);
    assert_eq!(watched.residual_timeout_s, Some(5e-3));
    let plain = studied("trivedi-keshri-660w", law.split(':').next().expect("a law"));
    assert_eq!(plain.residual_timeout_s, None);
    // Words, and the least part of the runs that is noticed with the watch.
    for (words, least) in [
        ("stuck at 0 A", 0.75),
        ("stuck at its last value", 0.75),
        ("open", 0.7),
        ("switch stays off", 0.6),
        ("wires of phases a and b exchanged", 0.5),
        ("Hall sensors Ha and Hb exchanged", 0.5),
    ] {
        let [before, _] = trips(&plain, words);
        let [tripped, runs] = trips(&watched, words);
        let share = tripped as f64 / runs as f64;
        assert!(
            share >= least && tripped > before,
            "{law}, {words}: {tripped} of {runs} runs, {before} without the watch"
        );
    }
    let noticed = |study: &FaultStudy| study.totals.always + study.totals.sometimes;
    assert!(noticed(&watched) >= noticed(&plain) + 10, "{law}");
}

#[test]
fn sound_drives_do_not_trip() {
    for motor in ["hurst-long", "velineon-3500"] {
        let study = studied(motor, LAWS[0]);
        for row in study.of_part(Part::Sound) {
            assert_eq!(row.tripped, 0, "{motor}: {row:?}");
        }
    }
}

/// A deviation of the plant from its specification.
type Deviation = (&'static str, fn(&mut PlantParams));

const DEVIATIONS: [Deviation; 9] = [
    ("none", |_| {}),
    ("R and L high", |plant| {
        plant.resistance = plant.resistance.map(|r| 2.0 * r);
        plant.inductance = plant.inductance.map(|l| 1.3 * l);
    }),
    ("R and L low", |plant| {
        plant.resistance = plant.resistance.map(|r| 0.5 * r);
        plant.inductance = plant.inductance.map(|l| 0.75 * l);
    }),
    ("L low, k_b high", |plant| {
        plant.inductance = plant.inductance.map(|l| 0.75 * l);
        plant.k_phase = plant.k_phase.map(|k| 1.2 * k);
    }),
    ("k_b low, bus low", |plant| {
        plant.k_phase = plant.k_phase.map(|k| 0.8 * k);
        plant.v_bus *= 0.85;
    }),
    ("R high, bus low", |plant| {
        plant.resistance = plant.resistance.map(|r| 2.0 * r);
        plant.v_bus *= 0.85;
    }),
    ("R high, dead time", |plant| {
        plant.resistance = plant.resistance.map(|r| 2.0 * r);
        plant.dead_time = 1e-6;
    }),
    ("a Hall sensor off, L high", |plant| {
        plant.hall_error_deg = [5.0, 0.0, 0.0];
        plant.inductance = plant.inductance.map(|l| 1.3 * l);
    }),
    ("all Hall sensors off, k_b high", |plant| {
        plant.hall_error_deg = [5.0; 3];
        plant.k_phase = plant.k_phase.map(|k| 1.2 * k);
    }),
];

#[test]
fn steps_and_reversals_of_the_torque_trip_no_deviating_drive() {
    let motors = library();
    motors.par_iter().enumerate().for_each(|(number, motor)| {
        // Both laws take turns.
        for (law, share) in [(LAWS[number % 2], 0.1), (LAWS[(number + 1) % 2], 0.6)] {
            let drive = drive(motor.name, law);
            let spec = &drive.spec;
            let omega = share * spec.motor.rated_speed;
            let rated = spec.motor.rated_current;
            for (what, deviate) in DEVIATIONS {
                let mut plant = plant_of(spec);
                deviate(&mut plant);
                let plant = Plant::new(plant, 0.2, omega).expect("a plant");
                let engine = drive.engine(Model::Fixed, drive.set_point(0.0));
                let delay = run_of(spec, omega, 0.0).delay;
                let mut closed = ClosedLoop::new(plant, engine, delay);
                let part = (0.02 / spec.inverter.t_s) as usize;
                for goal in [0.0, 1.0, -1.0, 1.0, 0.0, -1.0, -0.1] {
                    closed.controller().set_current(goal * rated);
                    closed.run(part, &mut ());
                    let fault = closed.controller().fault();
                    assert_ne!(
                        fault,
                        Some(Fault::Residual),
                        "{}, {law} at {share} of the rated speed, {what}: set-point {goal}",
                        motor.name
                    );
                }
            }
        }
    });
}

#[test]
fn a_free_shaft_starts_and_reverses_without_a_trip() {
    let motors = library();
    motors.par_iter().enumerate().for_each(|(number, motor)| {
        let law = LAWS[number % 2];
        let drive = drive(motor.name, law);
        let spec = &drive.spec;
        let rated = spec.motor.rated_current;
        // From standstill to the rated speed in a quarter of a second.
        let torque = rated * spec.torque_constant();
        let inertia = torque * 0.25 / spec.motor.rated_speed;
        for (what, deviate) in DEVIATIONS {
            let mut plant = plant_of(spec);
            deviate(&mut plant);
            plant.mechanics = Some(Mechanics {
                inertia,
                opposing_torque: 0.0,
                external_torque: 0.0,
                viscous: 0.0,
            });
            let plant = Plant::new(plant, 0.2, 0.0).expect("a plant");
            let engine = drive.engine(Model::Fixed, drive.set_point(rated));
            let delay = run_of(spec, 0.0, 0.0).delay;
            let mut closed = ClosedLoop::new(plant, engine, delay);
            for goal in [1.0, -1.0] {
                closed.controller().set_current(goal * rated);
                closed.run((0.22 / spec.inverter.t_s) as usize, &mut ());
                let fault = closed.controller().fault();
                assert_ne!(
                    fault,
                    Some(Fault::Residual),
                    "{}, {law}, {what}: set-point {goal}",
                    motor.name
                );
            }
        }
    });
}
