//! Torque steps on a motor with three quarters of the stated inductance: they overshoot, and a ramp of a few
//! periods (`slew_rate`) prevents it.

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

/// Greatest overshoot on a ramp, over the rated torque.
const MOST: f64 = 0.05;

/// Controllers with a modulator, and the control periods of a ramp to the rated current: a PI regulator follows it
/// late, and gains what it lacks at its end.
const LAWS: [(&str, f64); 2] = [("pdcc", 5.0), ("pi-pwm", 8.0)];

/// Speeds of the shaft over the rated one.
const SPEEDS: [f64; 4] = [0.1, 0.4, -0.4, 0.7];

/// Greatest overshoot of steps up, down and through a reversal, over the rated torque.
fn overshoot(drive: &Prepared, speed: f64) -> f64 {
    let spec = &drive.spec;
    let omega = speed * spec.motor.rated_speed;
    let mut params = plant_of(spec);
    params.inductance = params.inductance.map(|inductance| 0.75 * inductance);
    let plant = Plant::new(params, 0.2, omega).expect("a plant");
    let delay = run_of(spec, omega, 0.0).delay;
    let rated = drive.demand();
    let engine = drive.engine(Model::Fixed, drive.set_point(0.1 * rated));
    let mut closed = ClosedLoop::new(plant, engine, delay);
    let sixth = FRAC_PI_3 / (omega.abs() * f64::from(spec.motor.pole_pairs));
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

/// A step and a ramp of a motor at a speed, over the rated torque.
struct Found {
    name: String,
    step: f64,
    ramp: f64,
}

fn found(source: &MotorSource, law: &str, periods: f64) -> Vec<Found> {
    let plain = of_variant(source, law);
    let rate = plain.spec.motor.rated_current / (periods * plain.spec.inverter.t_s);
    let ramped = of_variant(source, &format!("{law}:slew_rate={rate} A/s"));
    let at = |speed| {
        let [step, ramp] = [&plain, &ramped].map(|drive| overshoot(drive, speed));
        let name = format!("{} {law} {speed}", source.name);
        Found { name, step, ramp }
    };
    SPEEDS.map(at).into()
}

#[test]
fn a_ramp_of_a_few_periods_keeps_the_overshoot_small() {
    let found: Vec<Found> = library()
        .par_iter()
        .flat_map_iter(|motor| {
            let source = MotorSource::from(motor);
            LAWS.into_iter()
                .flat_map(move |(law, periods)| found(&source, law, periods))
        })
        .collect();
    for Found { name, step, ramp } in &found {
        println!("{name}: {step:.3} in a step, {ramp:.3} on a ramp");
    }
    let wrong = found.iter().filter(|found| found.ramp >= MOST);
    let wrong: Vec<&str> = wrong.map(|found| found.name.as_str()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    for (law, _) in LAWS {
        let of_law = found.iter().filter(|found| found.name.contains(law));
        let most = of_law.map(|found| found.step).fold(0.0, f64::max);
        assert!(most > 4.0 * MOST, "{law} without a ramp: {most}");
    }
}
