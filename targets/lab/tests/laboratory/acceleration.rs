//! The torque in fast acceleration: between Hall edges the angle follows the speed of the
//! coming sector, not that of the last turn; of an encoder's angles the filter of the speed is fast enough.

use crate::encoder::with_encoder;
use hexagen_lab::closed_loop::ClosedLoop;
use hexagen_lab::engine::{
    Library, Model, MotorSource, Prepared, library, plant_of, prepare, run_of,
};
use hexagen_lab::plant::{Mechanics, Plant};
use rayon::prelude::*;

/// Controllers with a modulator.
const LAWS: [&str; 2] = ["pdcc", "pi-pwm"];

/// Mechanical acceleration by the rated torque, rad/s2.
const ACCELERATION: f64 = 3000.0;

/// Least mean torque over the rated one.
const LEAST: f64 = 0.99;

/// Electrical turns from rest behind which the torque is averaged: within the first one the acceleration is not
/// known yet.
const FROM: f64 = 1.5;

/// Speed up to which it is averaged, over the rated one.
const TO: f64 = 0.8;

/// Fewest electrical turns of an average.
const FEWEST: f64 = 0.5;

/// Mean torque over the rated one, and the electrical turns that it lasts.
fn torque(drive: &Prepared, sign: f64) -> (f64, f64) {
    let spec = &drive.spec;
    let rated = drive.demand();
    let mut params = plant_of(spec);
    params.mechanics = Some(Mechanics {
        inertia: rated / ACCELERATION,
        opposing_torque: 0.0,
        external_torque: 0.0,
        viscous: 0.0,
    });
    let plant = Plant::new(params, 0.2, 0.0).expect("a plant");
    let delay = run_of(spec, 0.0, 0.0).delay;
    let engine = drive.engine(Model::Fixed, drive.set_point(sign * rated));
    let mut closed = ClosedLoop::new(plant, engine, delay);
    let (mut sum, mut periods, mut turns) = (0.0, 0_u32, -FROM);
    loop {
        closed.run(1, &mut ());
        let truth = closed.plant().truth();
        let share = sign * truth.omega_m / spec.motor.rated_speed;
        turns += share * spec.motor.rated_turn(spec.inverter.t_s) / 360.0;
        if turns > 0.0 {
            sum += sign * truth.mean_torque;
            periods += 1;
        }
        if share > TO {
            break;
        }
        assert_eq!(closed.tripped(), None, "{}", drive.motor);
    }
    (sum / f64::from(periods) / rated, turns)
}

/// What is wrong with a motor's runs with a law, of those that last long enough.
fn wrong(motor: &Library, law: &str) -> Vec<Option<String>> {
    let drive = |source: &MotorSource| prepare(source, Some(law)).expect("generates");
    let halls = drive(&MotorSource::from(motor));
    let encoder = drive(&with_encoder(motor.name, halls.spec.motor.pole_pairs));
    let runs = [(&halls, "Halls"), (&encoder, "encoder")]
        .into_iter()
        .flat_map(|run| [(run, 1.0), (run, -1.0)]);
    runs.filter_map(|((drive, sensor), sign)| {
        let (share, turns) = torque(drive, sign);
        let name = motor.name;
        let text = format!("{name} {law} {sensor} {sign}: {share:.4} in {turns:.1} turns");
        println!("{text}");
        (turns > FEWEST).then(|| (share < LEAST).then_some(text))
    })
    .collect()
}

#[test]
fn the_torque_lasts_in_fast_acceleration() {
    let found: Vec<Option<String>> = library()
        .par_iter()
        .flat_map_iter(|motor| LAWS.into_iter().flat_map(|law| wrong(motor, law)))
        .collect();
    assert!(found.len() >= 112, "{} runs", found.len());
    let wrong: Vec<String> = found.into_iter().flatten().collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
