//! Torque steps of the default drive on a motor with three quarters of the stated inductance: they overshoot,
//! and a ramp of a few periods (`slew_rate`) prevents it.

use hexagen_lab::closed_loop::ClosedLoop;
use hexagen_lab::engine::{
    Engine, Model, MotorSource, Prepared, library, plant_of, prepare, run_of,
};
use hexagen_lab::plant::Plant;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_3;

fn of_variant(source: &MotorSource, variant: &str) -> Prepared {
    prepare(source, Some(variant)).unwrap_or_else(|why| panic!("{}: {why}", source.name))
}

/// Greatest torque beyond `goal` in a number of periods, Nm, each period's mean; `way`: 1 upward, -1 downward.
fn beyond(closed: &mut ClosedLoop<Engine<'_>>, periods: usize, goal: f64, way: f64) -> f64 {
    let mut most = f64::MIN;
    for _ in 0..periods {
        closed.run(1, &mut ());
        most = most.max(way * (closed.plant().truth().mean_torque - goal));
    }
    most
}

/// Control periods of a ramp to the rated current.
const RAMP: f64 = 5.0;

/// Greatest overshoot on a ramp, over the rated torque.
const MOST: f64 = 0.05;

/// Speed of the shaft over the rated one.
const SPEED: f64 = 0.4;

/// Greatest overshoot of steps up, down and through a reversal, over the rated torque.
fn overshoot(drive: &Prepared) -> f64 {
    let spec = &drive.spec;
    let omega = SPEED * spec.motor.rated_speed;
    let mut params = plant_of(spec);
    params.inductance = params.inductance.map(|inductance| 0.75 * inductance);
    let plant = Plant::new(params, 0.2, omega).expect("a plant");
    let delay = run_of(spec, omega, 0.0).delay;
    let rated = drive.demand();
    let engine = drive.engine(Model::Fixed, drive.set_point(0.1 * rated));
    let mut closed = ClosedLoop::new(plant, engine, delay);
    let sixth = FRAC_PI_3 / (omega * f64::from(spec.motor.pole_pairs));
    let settled = (40.0 * sixth / spec.inverter.t_s) as usize;
    closed.run(settled, &mut ());
    let (mut most, mut from) = (0.0_f64, 0.1);
    for goal in [1.0, 0.1, -1.0, 1.0] {
        closed
            .controller()
            .set_current(drive.set_point(goal * rated).current);
        let way = f64::signum(goal - from);
        most = most.max(beyond(&mut closed, settled, goal * rated, way) / rated);
        from = goal;
    }
    assert_eq!(closed.tripped(), None, "{}", drive.motor);
    most
}

#[test]
fn a_ramp_of_five_periods_keeps_the_overshoot_small() {
    let found: Vec<(String, [f64; 2])> = library()
        .par_iter()
        .map(|motor| {
            let source = &MotorSource::from(motor);
            let plain = of_variant(source, "pdcc");
            let rate = plain.spec.motor.rated_current / (RAMP * plain.spec.inverter.t_s);
            let ramped = of_variant(source, &format!("pdcc:slew_rate={rate} A/s"));
            (source.name.clone(), [&plain, &ramped].map(overshoot))
        })
        .collect();
    for (name, [step, ramp]) in &found {
        println!(
            "{name}: {:.1} % in a step, {:.1} % on a ramp",
            100.0 * step,
            100.0 * ramp
        );
        assert!(*ramp < MOST, "{name}: {ramp}");
    }
    let most = found
        .iter()
        .fold(0.0, |most, (_, [step, _])| f64::max(most, *step));
    assert!(most > 4.0 * MOST, "without a ramp {most}");
}
