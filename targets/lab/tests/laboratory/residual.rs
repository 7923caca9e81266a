//! The residual watch (`residual_timeout`): notices currents that do not follow the voltages, and
//! never a sound drive whose motor, bus, dead time or sensors deviate.

use hexagen::Fault;
use hexagen_lab::closed_loop::{ClosedLoop, CurrentLoop};
use hexagen_lab::engine::{
    Model, MotorSource, PlantOptions, Prepared, library, plant_of, prepare, run_of,
};
use hexagen_lab::faults::{FaultStudy, Part, study};
use hexagen_lab::plant::{Mechanics, Plant, PlantParams};
use hexagen_tests::random_motor::random_drives;
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
        ("switch stays off", 0.5),
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
        // Sensors in the low legs see nothing with a dead time that is longer than stated.
        if plant.low_side.is_none() {
            plant.dead_time = 1e-6;
        }
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

/// The first trip of a deviating plant whose set-point goes through these parts of the rated current,
/// each for so many seconds.
fn trip_in(
    drive: &Prepared,
    omega: f64,
    mechanics: Option<Mechanics>,
    (goals, seconds): (&[f64], f64),
) -> Option<(Fault, String)> {
    let spec = &drive.spec;
    for (what, deviate) in DEVIATIONS {
        let mut plant = plant_of(spec);
        deviate(&mut plant);
        plant.mechanics = mechanics;
        let plant = Plant::new(plant, 0.2, omega).expect("a plant");
        let engine = drive.engine(Model::Fixed, drive.set_point(0.0));
        let delay = run_of(spec, omega, 0.0).delay;
        let mut closed = ClosedLoop::new(plant, engine, delay);
        for goal in goals {
            closed
                .controller()
                .set_current(goal * spec.motor.rated_current);
            closed.run((seconds / spec.inverter.t_s) as usize, &mut ());
            if let Some(fault) = closed.controller().fault() {
                return Some((fault, format!("{what}, set-point {goal}")));
            }
        }
    }
    None
}

/// A trip in steps and reversals of the torque, the shaft held at a part of the rated speed.
fn trip_in_steps(drive: &Prepared, share: f64) -> Option<(Fault, String)> {
    let goals = [0.0, 1.0, -1.0, 1.0, 0.0, -1.0, -0.1];
    let omega = share * drive.spec.motor.rated_speed;
    let (fault, what) = trip_in(drive, omega, None, (&goals, 0.02))?;
    Some((fault, format!("{share} of the rated speed, {what}")))
}

/// A trip on a free shaft, which reaches the rated speed in a quarter of a second and then reverses.
fn trip_in_start(drive: &Prepared) -> Option<(Fault, String)> {
    let motor = &drive.spec.motor;
    let torque = motor.rated_current * drive.spec.torque_constant();
    let shaft = Mechanics {
        inertia: torque * 0.25 / motor.rated_speed,
        opposing_torque: 0.0,
        external_torque: 0.0,
        viscous: 0.0,
    };
    let (fault, what) = trip_in(drive, 0.0, Some(shaft), (&[1.0, -1.0], 0.22))?;
    Some((fault, format!("start, {what}")))
}

/// At a low and a higher speed, and from standstill.
fn trips_of(drive: &Prepared) -> Vec<(Fault, String)> {
    let found = [0.1, 0.6].map(|share| trip_in_steps(drive, share));
    let found = found.into_iter().chain([trip_in_start(drive)]).flatten();
    found
        .map(|(fault, what)| (fault, format!("{}: {what}", drive.motor)))
        .collect()
}

#[test]
fn no_deviating_motor_of_the_library_trips_in_steps_reversals_and_starts() {
    // Both laws take turns.
    let found: Vec<(Fault, String)> = (library().par_iter().enumerate())
        .flat_map_iter(|(number, motor)| trips_of(&drive(motor.name, LAWS[number % 2])))
        .collect();
    assert!(found.is_empty(), "{found:#?}");
}

/// Random motors, in a push and in the nightly run.
const DRAWN: [usize; 2] = [6, 100];

#[test]
fn hardly_a_deviating_random_motor_trips() {
    let drawn = random_drives(1000, LAWS[0], DRAWN, |_| true);
    let found: Vec<(Fault, String)> = drawn.par_iter().flat_map_iter(trips_of).collect();
    // A motor whose current rises far in a period may trip by its current where L is low.
    let of_watch: Vec<_> = (found.iter())
        .filter(|(fault, _)| *fault == Fault::Residual)
        .collect();
    // Two deviations at once, with a rotor that runs up within two sectors, may be too much.
    let runs = 3 * DEVIATIONS.len() * drawn.len();
    println!("{} of {runs} runs: {of_watch:#?}", of_watch.len());
    assert!(300 * of_watch.len() <= runs, "{of_watch:#?}");
}
