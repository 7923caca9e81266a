//! The over-speed watch in closed loop: a driven shaft trips the drive soon behind the stated speed, and
//! a motor at its rated speed does not.

use crate::encoder::with_encoder;
use hexagen::Fault;
use hexagen_lab::closed_loop::{ClosedLoop, CurrentLoop};
use hexagen_lab::engine::{
    Engine, Model, MotorSource, Prepared, library, plant_of, prepare, run_of,
};
use hexagen_lab::plant::{Mechanics, Plant, PlantParams};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Laws with and without an angle, with edges at samples and at a timer's ticks.
const LAWS: [&str; 5] = [
    "pdcc:hall_capture=timer",
    "pdcc:modulation=pair,reference=quasi_square,emf=estimated,hall_capture=sampled",
    "fcs-mpc:hall_capture=sampled",
    "phcc:hall_capture=timer",
    "pi-pwm:hall_capture=sampled",
];

const MOTORS: [&str; 3] = ["trivedi-keshri-660w", "hurst-long", "teknic-m2310p"];

/// A motor of the library whose over-speed is this, of its plain drive.
fn drive(motor: &str, law: &str, over_speed: impl Fn(&Prepared) -> f64) -> Prepared {
    let source = MotorSource::of_library(motor).expect("is in the library");
    drive_of((motor, source), law, over_speed)
}

fn drive_of(
    (motor, mut source): (&str, MotorSource),
    law: &str,
    over_speed: impl Fn(&Prepared) -> f64,
) -> Prepared {
    let of = |source: &MotorSource| {
        prepare(source, Some(law)).unwrap_or_else(|why| panic!("{motor} {law}: {why}"))
    };
    let rpm = over_speed(&of(&source)) * 60.0 / TAU;
    let field = format!("[inverter]\nover_speed = \"{rpm} rpm\"\n");
    source.text = source.text.replacen("[inverter]\n", &field, 1);
    of(&source)
}

/// A closed loop that turns at this speed.
fn closed(drive: &Prepared, params: PlantParams, omega: f64, share: f64) -> ClosedLoop<Engine<'_>> {
    let plant = Plant::new(params, 0.2, omega).expect("a plant");
    let engine = drive.engine(Model::Fixed, drive.set_point(share * drive.demand()));
    ClosedLoop::new(plant, engine, run_of(&drive.spec, omega, 0.0).delay)
}

/// Electrical turns from the stated speed to the trip, with a shaft that the rated torque drives in a direction from
/// a speed below: it would double the rated speed in a quarter of a second.
fn turns_until_trip(drive: &Prepared, direction: f64) -> f64 {
    let (motor, inverter) = (&drive.spec.motor, &drive.spec.inverter);
    let over_speed = inverter.over_speed.expect("is watched");
    let turn = TAU / (over_speed * f64::from(motor.pole_pairs));
    // With edges at samples a turn must be shorter by a whole period to be surely seen as short.
    let sure = over_speed * (1.0 + 1.1 * inverter.t_s / turn);
    let mut params = plant_of(&drive.spec);
    params.mechanics = Some(Mechanics {
        inertia: drive.demand() * 0.25 / motor.rated_speed,
        opposing_torque: 0.0,
        external_torque: direction * drive.demand(),
        viscous: 0.0,
    });
    let mut closed = closed(drive, params, direction * 0.9 * motor.rated_speed, 0.0);
    let mut since = 0;
    for _ in 0..(1.0 / inverter.t_s) as usize {
        closed.run(1, &mut ());
        let omega = direction * closed.plant().truth().omega_m;
        if let Some(fault) = closed.controller().fault() {
            assert_eq!(fault, Fault::OverSpeed, "{}", drive.motor);
            assert!(omega >= over_speed, "{}: at {omega} rad/s", drive.motor);
            return f64::from(since) * inverter.t_s / turn;
        }
        since += i32::from(omega >= sure);
    }
    panic!("{}: no trip", drive.motor)
}

#[test]
fn a_driven_shaft_trips_within_two_turns() {
    let all: Vec<_> = MOTORS
        .iter()
        .flat_map(|motor| LAWS.map(|law| (*motor, law)))
        .collect();
    all.par_iter().for_each(|&(motor, law)| {
        let drive = drive(motor, law, |plain| 1.3 * plain.spec.motor.rated_speed);
        for direction in [1.0, -1.0] {
            let turns = turns_until_trip(&drive, direction);
            // The mean lags by half a turn, seven edges take one more, and the first one up to a sector.
            assert!(turns < 2.0, "{motor} {law} {direction}: {turns} turns");
        }
    });
}

#[test]
fn a_driven_shaft_with_an_encoder_trips_within_two_turns() {
    for motor in MOTORS {
        let plain = drive(motor, "pdcc", |plain| 1.3 * plain.spec.motor.rated_speed);
        let encoder = with_encoder(motor, plain.spec.motor.pole_pairs);
        let rated = plain.spec.motor.rated_speed * 60.0 / TAU;
        // Also where that is above the greatest speed.
        let field = format!("[inverter]\nmaximum_speed = \"{rated} rpm\"\n");
        for fields in ["[inverter]\n", &field] {
            let mut source = encoder.clone();
            source.text = source.text.replacen("[inverter]\n", fields, 1);
            let drive = drive_of((motor, source), "pdcc", |plain| {
                1.3 * plain.spec.motor.rated_speed
            });
            for direction in [1.0, -1.0] {
                let turns = turns_until_trip(&drive, direction);
                assert!(turns < 2.0, "{motor} {fields} {direction}: {turns} turns");
            }
        }
    }
}

/// The least over-speed that is accepted: its turn is a period shorter than that at rated speed.
fn least(plain: &Prepared) -> f64 {
    let (motor, inverter) = (&plain.spec.motor, &plain.spec.inverter);
    let pole_pairs = f64::from(motor.pole_pairs);
    let turn = TAU / (motor.rated_speed * pole_pairs);
    1.000_001 * TAU / ((turn - inverter.t_s) * pole_pairs)
}

/// A trip at rated speed, motoring in either direction and braking, with Hall sensors out of place.
fn trip_at_rated_speed(drive: &Prepared) -> Option<Fault> {
    [(1.0, 0.5), (-1.0, 0.5), (1.0, -0.5)]
        .into_iter()
        .find_map(|(direction, share)| {
            let mut params = plant_of(&drive.spec);
            params.hall_error_deg = [5.0, -5.0, 0.0];
            let omega = direction * drive.spec.motor.rated_speed;
            let mut closed = closed(drive, params, omega, share);
            closed.run((0.2 / drive.spec.inverter.t_s) as usize, &mut ());
            closed.controller().fault()
        })
}

#[test]
fn no_motor_of_the_library_trips_at_its_rated_speed() {
    // Of laws that every motor takes.
    let laws = [
        ["pdcc:hall_capture=timer", "pdcc"],
        ["pi-pwm:hall_capture=sampled", "pi-pwm"],
    ];
    library().par_iter().for_each(|motor| {
        let source = MotorSource::from(motor);
        let has_angle = source.text.contains("rotor = \"angle\"");
        for law in laws.map(|[halls, angle]| if has_angle { angle } else { halls }) {
            let fault = trip_at_rated_speed(&drive(motor.name, law, least));
            assert_eq!(fault, None, "{} {law}", motor.name);
        }
    });
}
