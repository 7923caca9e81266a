//! Current sensors in the low legs, in closed loop: an accepted drive has no blind sample, and without the window the
//! same controller loses its currents.

use hexagen_codegen::pipeline::generate;
use hexagen_codegen::spec::{check, parse_toml};
use hexagen_lab::Interpreted;
use hexagen_lab::engine::plant_of;
use hexagen_lab::plant::Plant;
use hexagen_reference::verify::Subject;
use hexagen_tests::sensors::{LOW_SIDE, specification};
use std::f64::consts::TAU;

/// Periods of a run, and from which on the torque counts.
const PERIODS: u32 = 1200;
const SETTLED: u32 = 600;

struct Run {
    blind: u64,
    torque: f64,
    turn_ons: u64,
}

/// A drive that was generated for `sensors`, at full current, on a plant whose sensors are in the low legs.
fn run(sensors: &str, controller: &str, rpm: f64) -> Run {
    run_on(sensors, LOW_SIDE, controller, rpm)
}

/// The same on a plant with its own sensors.
fn run_on(sensors: &str, own: &str, controller: &str, rpm: f64) -> Run {
    let checked = |sensors: &str| {
        let text = specification(sensors, controller);
        parse_toml(&text, "m.toml")
            .and_then(|ast| check(&ast))
            .expect("a right specification")
    };
    let (spec, origins) = checked(sensors);
    let generated = generate(&spec, &origins).expect("a drive");
    let mut drive = Interpreted::new(generated.graph.program(), &generated.interface);
    drive.set_current(20 << 16);
    let params = plant_of(&checked(own).0);
    let mut plant = Plant::new(params, 0.117, rpm * TAU / 60.0).expect("a plant");
    let mut pending = hexagen::Legs::OFF;
    let mut torque = 0.0;
    for period in 0..PERIODS {
        let command = drive.step(&plant.sample());
        let applied = std::mem::replace(&mut pending, command);
        plant.run_period(applied, &mut ());
        if period >= SETTLED {
            torque += plant.truth().mean_torque / f64::from(PERIODS - SETTLED);
        }
    }
    Run {
        blind: plant.blind_samples(),
        torque,
        turn_ons: plant.turn_ons(),
    }
}

/// The same controller with its sensors in any two legs, and unlike: it reads the currents of the right ones.
#[test]
fn sensors_of_any_two_legs_show_the_same_torque() {
    let controller = "kind = \"pdcc\"";
    let expected = run(LOW_SIDE, controller, 1500.0).torque;
    for sensors in [
        "sensed_phases = \"bc\"\n",
        "sensed_phases = \"ca\"\n",
        "sensed_phases = \"ca\"\nadc_inverted = [\"on\", \"off\"]\nadc_offset = [2100, 2011]\n",
    ] {
        let sensors = format!("{LOW_SIDE}{sensors}");
        let own = run_on(&sensors, &sensors, controller, 1500.0);
        assert_eq!(own.blind, 0, "{sensors}");
        assert!(
            (own.torque / expected - 1.0).abs() < 0.01,
            "{sensors}: {} Nm",
            own.torque
        );
        let other = run_on(&sensors, LOW_SIDE, controller, 1500.0);
        assert!(
            other.torque < 0.5 * expected,
            "{sensors}: {} Nm",
            other.torque
        );
    }
}

/// A control period of two PWM periods: the legs switch as often, currents are read half as often, at instants that
/// every command leaves readable.
#[test]
fn a_command_is_repeated_in_each_pwm_period() {
    let controller = "kind = \"pdcc\"";
    let every = run(LOW_SIDE, controller, 1000.0);
    let sensors = format!("{LOW_SIDE}pwm_per_control = 2\n");
    let second = run_on(&sensors, &sensors, controller, 1000.0);
    assert_eq!(second.blind, 0);
    let ratio = second.turn_ons as f64 / every.turn_ons as f64;
    assert!(
        (1.9..2.1).contains(&ratio),
        "{ratio} times as many turn-ons in twice the time"
    );
    let torque = second.torque / every.torque;
    assert!((torque - 1.0).abs() < 0.02, "{torque} times the torque");
}

#[test]
fn an_accepted_drive_has_no_blind_sample() {
    for controller in [
        "kind = \"pdcc\"\nsaturation = \"keep_angle\"",
        "kind = \"pdcc\"",
        "kind = \"pdcc\"\ncommon_mode = \"clamped_low\"",
        "kind = \"pdcc\"\ncommon_mode = \"centred\"",
        "kind = \"pi-pwm\"",
        "kind = \"p-pwm\"",
    ] {
        for rpm in [-1500.0, 300.0, 1000.0, 1500.0, 1800.0, 2200.0] {
            let run = run(LOW_SIDE, controller, rpm);
            assert_eq!(run.blind, 0, "{controller} at {rpm} rpm");
        }
    }
}

/// The reason for the window: near the voltage limit a controller that does not know of it reads 0 A of legs that carry
/// the whole current.
#[test]
fn without_the_window_the_currents_are_lost() {
    let controller = "kind = \"pdcc\"";
    let (with, without) = (
        run(LOW_SIDE, controller, 1800.0),
        run("", controller, 1800.0),
    );
    assert_eq!(with.blind, 0);
    assert!(without.blind > 50, "{} blind samples", without.blind);
    assert!(
        without.torque < 0.5 * with.torque,
        "{} Nm, {} Nm",
        without.torque,
        with.torque
    );
}
