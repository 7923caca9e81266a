//! With a slew rate the torque rises and falls along a straight line, through a reversal too, and a
//! set-point that is there is held as without one.

use hexagen_lab::closed_loop::ClosedLoop;
use hexagen_lab::engine::{Engine, Model, MotorSource, Prepared, plant_of, prepare, run_of};
use hexagen_lab::plant::Plant;
use rayon::prelude::*;

const MOTORS: [&str; 3] = ["trivedi-keshri-660w", "hurst-long", "teknic-m2310p"];

/// Laws, with the deviation from the line that their ripple allows, relative to the rated torque.
const LAWS: [(&str, f64); 4] = [
    (
        "pdcc:emf=model,hall_capture=timer,reference=proportional",
        0.03,
    ),
    (
        "pi-pwm:emf=model,hall_capture=timer,reference=proportional",
        0.05,
    ),
    ("phcc", 0.25),
    ("fcs-mpc", 0.25),
];

/// Time from no current to the rated one, second.
const RISE: f64 = 0.08;

/// Share of the rated speed at which the shaft is held.
const SPEED: f64 = 0.25;

fn drive(motor: &str, law: &str) -> Prepared {
    let source = MotorSource::of_library(motor).expect("is in the library");
    let plain = prepare(&source, Some(law)).unwrap_or_else(|why| panic!("{motor}: {why}"));
    let rate = plain.spec.motor.rated_current / RISE;
    let separator = if law.contains(':') { ',' } else { ':' };
    let law = format!("{law}{separator}slew_rate={rate} A/s");
    prepare(&source, Some(&law)).unwrap_or_else(|why| panic!("{motor}: {why}"))
}

/// Mean torque over a part of the time, Nm.
fn mean(closed: &mut ClosedLoop<Engine<'_>>, periods: usize) -> f64 {
    let mut sum = 0.0;
    for _ in 0..periods {
        closed.run(1, &mut ());
        sum += closed.plant().truth().mean_torque;
    }
    sum / periods as f64
}

#[test]
fn the_torque_follows_a_set_point_along_a_line() {
    let all: Vec<_> = MOTORS
        .iter()
        .flat_map(|motor| LAWS.map(|law| (*motor, law)))
        .collect();
    all.par_iter().for_each(|&(motor, (law, allowed))| {
        let drive = drive(motor, law);
        let spec = &drive.spec;
        let omega = SPEED * spec.motor.rated_speed;
        let plant = Plant::new(plant_of(spec), 0.2, omega).expect("a plant");
        let delay = run_of(spec, omega, 0.0).delay;
        let engine = drive.engine(Model::Fixed, drive.set_point(0.0));
        let mut closed = ClosedLoop::new(plant, engine, delay);
        let rated = spec.motor.rated_current;
        let torque = rated * spec.torque_constant();
        // The rotor's speed becomes known.
        let sixth = std::f64::consts::FRAC_PI_3 / (omega * f64::from(spec.motor.pole_pairs));
        closed.run((20.0 * sixth / spec.inverter.t_s) as usize, &mut ());
        // A tenth of the rise at a time, and some of them behind it.
        let part = (RISE / 10.0 / spec.inverter.t_s) as usize;
        let mut from = 0.0;
        for goal in [1.0, -1.0, 0.5] {
            closed.controller().set_current(goal * rated);
            for number in 0..24 {
                let found = mean(&mut closed, part) / torque;
                let way = (f64::from(number) + 0.5) / 10.0;
                let (low, high) = (f64::min(from, goal), f64::max(from, goal));
                let line = (from + (goal - from).signum() * way).clamp(low, high);
                assert!(
                    (found - line).abs() < allowed,
                    "{motor} {law}: {found} in place of {line} of the rated torque, part {number} from {from} to {goal}"
                );
            }
            from = goal;
        }
        assert_eq!(closed.tripped(), None, "{motor} {law}");
    });
}
