//! With an acceleration limit the speed follows its set-point along a ramp, which begins at the rotor's
//! speed.

use hexagen_lab::closed_loop::{ClosedLoop, CurrentLoop};
use hexagen_lab::engine::{Engine, Model, MotorSource, Prepared, plant_of, prepare, run_of};
use hexagen_lab::plant::{Mechanics, Plant};
use rayon::prelude::*;
use std::f64::consts::TAU;

const LAWS: [&str; 3] = ["pdcc", "pi-pwm", "fcs-mpc"];

/// Motors, and an inertia of rotor and load that they bring to the rated speed within the ramp by a part
/// of the rated torque.
const MOTORS: [(&str, &str); 2] = [
    ("hurst-long", "5e-5 kg m2"),
    ("trivedi-keshri-660w", "2e-3 kg m2"),
];

/// Time of the ramp to rated speed, over that of the speed loop, 1/w.
const RISE: f64 = 25.0;

/// The same in seconds.
fn rise(drive: &Prepared) -> f64 {
    let speed = drive.spec.controller.common().speed.expect("a speed loop");
    RISE / (TAU * speed.bandwidth)
}

/// The motor with a ramp of the speed set-point.
fn drive((name, inertia): (&str, &str), law: &str) -> Prepared {
    let mut motor = MotorSource::of_library(name).expect("is in the library");
    let own = motor.text.lines();
    let own = own.filter(|line| !line.starts_with("inertia"));
    let text = own.collect::<Vec<_>>().join("\n");
    motor.text = text.replace("[motor]\n", &format!("[motor]\ninertia = \"{inertia}\"\n"));
    let of = |options: &str| {
        let law = format!("{law}:hall_capture=timer,speed_loop=on{options}");
        prepare(&motor, Some(&law)).unwrap_or_else(|why| panic!("{name} {law}: {why}"))
    };
    let plain = of("");
    let rate = plain.spec.motor.rated_speed * 60.0 / TAU / rise(&plain);
    of(&format!(",acceleration_limit={rate} rpm/s"))
}

/// A free shaft at a part of the rated speed.
fn closed(drive: &Prepared, share: f64) -> ClosedLoop<Engine<'_>> {
    let speed = drive.spec.controller.common().speed.expect("a speed loop");
    let mut params = plant_of(&drive.spec);
    params.mechanics = Some(Mechanics {
        inertia: speed.inertia,
        opposing_torque: 0.1 * drive.demand(),
        external_torque: 0.0,
        viscous: 0.0,
    });
    let omega = share * drive.spec.motor.rated_speed;
    let plant = Plant::new(params, 0.2, omega).expect("a plant");
    let engine = drive.engine(Model::Fixed, drive.set_point(drive.demand()));
    ClosedLoop::new(plant, engine, run_of(&drive.spec, omega, 0.0).delay)
}

/// Ten speeds over the rated one in twice the ramp, with the set-point at this part of it.
fn speeds(drive: &Prepared, closed: &mut ClosedLoop<Engine<'_>>, goal: f64) -> Vec<f64> {
    let motor = &drive.spec.motor;
    let rated = motor.rated_speed;
    closed.controller().set_speed(goal * rated * 60.0 / TAU);
    (0..10)
        .map(|_| {
            closed.run(
                (0.2 * rise(drive) / drive.spec.inverter.t_s) as usize,
                &mut (),
            );
            assert_eq!(closed.controller().fault(), None, "{}", drive.motor);
            closed.plant().truth().omega_m / rated
        })
        .collect()
}

fn all() -> Vec<((&'static str, &'static str), &'static str)> {
    let of = |motor| LAWS.map(|law| (motor, law));
    MOTORS.into_iter().flat_map(of).collect()
}

#[test]
fn the_speed_follows_a_ramp_up_and_through_a_reversal() {
    all().par_iter().for_each(|&(motor, law)| {
        let drive = drive(motor, law);
        let mut closed = closed(&drive, 0.2);
        for (from, goal) in [(0.2, 1.0), (1.0, -0.5)] {
            let speeds = speeds(&drive, &mut closed, goal);
            for (tenth, speed) in (1..).zip(&speeds) {
                let way = f64::from(tenth) * 0.2;
                let ramp = from + (goal - from).clamp(-way, way);
                assert!(
                    (speed - ramp).abs() < 0.1,
                    "{motor:?} {law}: {speed:.3} in place of {ramp:.3} of {speeds:.3?}"
                );
            }
            let last = speeds[9];
            assert!((last - goal).abs() < 0.03, "{motor:?} {law}: {speeds:.3?}");
        }
    });
}

#[test]
fn a_rotor_that_turns_is_not_stopped_first() {
    all().par_iter().for_each(|&(motor, law)| {
        let drive = drive(motor, law);
        let mut closed = closed(&drive, 0.5);
        let speeds = speeds(&drive, &mut closed, 0.6);
        let least = speeds.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(least > 0.4, "{motor:?} {law}: {speeds:.3?}");
    });
}
