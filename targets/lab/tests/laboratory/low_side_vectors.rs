//! Whole vectors on boards with two shunts in the low legs, in closed loop: no sample is blind, and the torque is that of
//! sensors in the phases on a bus of the voltage that the pulsed legs reach.

use hexagen_lab::closed_loop::ClosedLoop;
use hexagen_lab::engine::{Model, MotorSource, Prepared, plant_of, prepare, run_of};
use hexagen_lab::plant::Plant;
use hexagen_tests::sensors::LOW_SIDE;
use rayon::prelude::*;

const MOTORS: [&str; 3] = ["trivedi-keshri-660w", "linix-45zwn24-40", "anaheim-bly341s"];

const VARIANTS: [&str; 7] = [
    "fcs-mpc:candidates=three_phase",
    "fcs-mpc:candidates=three_phase,emf=held",
    "fcs-mpc:candidates=three_phase,modulated=on",
    "fcs-mpc:candidates=three_phase,switching_weight=0.2A",
    "fcs-mpc:candidates=three_phase,torque_weight=2",
    "fcs-mpc:candidates=three_phase,horizon=2",
    "phcc:candidates=three_phase",
];

struct Run {
    tripped: bool,
    blind: u64,
    /// Mean over the demanded one.
    torque: f64,
    /// Turn-ons of a switch in a PWM period, mean of the six.
    turn_ons: f64,
}

/// The text of a library motor with more fields of its inverter, on its bus times `share`.
fn text(motor: &str, fields: &str, share: f64) -> MotorSource {
    let source = MotorSource::of_library(motor).expect("a motor of the library");
    let is_replaced =
        |line: &&str| line.starts_with("current_sensing") && fields.contains("current_sensing");
    let lines = source
        .text
        .lines()
        .filter(|line| !is_replaced(line))
        .map(|line| match line.strip_prefix("bus_voltage = \"") {
            Some(volts) => {
                let volts: f64 = volts.trim_end_matches(" V\"").parse().expect("volts");
                format!("bus_voltage = \"{:.6} V\"", volts * share)
            }
            None if line == "[inverter]" => format!("{line}\n{fields}"),
            None => line.to_owned(),
        });
    MotorSource {
        text: lines.collect::<Vec<_>>().join("\n"),
        ..source
    }
}

/// A drive at rated torque, on the plant of another one.
fn run(drive: &Prepared, own: &Prepared, share_of_speed: f64) -> Run {
    let omega = share_of_speed * own.spec.motor.rated_speed;
    let demand = drive.demand() * share_of_speed.signum();
    let params = plant_of(&own.spec);
    let run = run_of(&drive.spec, omega, demand);
    let plant = Plant::new(params, 0.117, omega).expect("a plant");
    let engine = drive.engine(Model::Fixed, drive.set_point(demand));
    let mut closed = ClosedLoop::new(plant, engine, run.delay);
    let (settling, measured) = run.periods(&plant_of(&own.spec));
    closed.run(settling, &mut ());
    let before = closed.plant().turn_ons();
    let mut torque = 0.0;
    for _ in 0..measured {
        closed.run(1, &mut ());
        torque += closed.plant().truth().mean_torque / measured as f64;
    }
    let tripped = closed.tripped().is_some();
    let turn_ons = closed.plant().turn_ons() - before;
    Run {
        tripped,
        blind: closed.plant().blind_samples(),
        torque: torque / demand,
        turn_ons: turn_ons as f64 / 6.0 / measured as f64,
    }
}

/// The drive of a variant with these sensors; see [`text`].
fn drive(motor: &str, variant: &str, sensors: &str, share: f64) -> Prepared {
    let fields = format!("{sensors}dead_time = \"500 ns\"\n");
    let drive = prepare(&text(motor, &fields, share), Some(variant));
    drive.unwrap_or_else(|errors| panic!("{motor}, {variant}: {errors}"))
}

fn each_drive(check: impl Fn(&str, &Prepared, &Prepared) + Sync) {
    let drives = MOTORS
        .into_iter()
        .flat_map(|motor| VARIANTS.map(|variant| (motor, variant)));
    let drives: Vec<_> = drives.collect();
    drives.into_par_iter().for_each(|(motor, variant)| {
        let low_side = drive(motor, variant, LOW_SIDE, 1.0);
        let reach = low_side.spec.reach_share();
        let in_phase = drive(motor, variant, "", reach);
        check(&format!("{motor}, {variant}"), &low_side, &in_phase);
    });
}

/// Speeds over the rated one, up to where the bus limits the torque.
const SPEEDS: [f64; 4] = [0.15, 0.5, -0.5, 0.9];

#[test]
fn pulsed_legs_leave_no_sample_blind_and_the_torque_of_their_voltage() {
    each_drive(|name, low_side, in_phase| {
        for speed in SPEEDS {
            let [pulsed, held] = [low_side, in_phase].map(|drive| run(drive, drive, speed));
            let name = format!("{name} at {speed}");
            assert!(!pulsed.tripped && !held.tripped, "{name}");
            assert_eq!(pulsed.blind, 0, "{name}");
            let torques = [pulsed.torque, held.torque];
            assert!(
                (torques[0] - torques[1]).abs() < 0.03,
                "{name}: {torques:?}"
            );
            // A high leg switches in every period, as those of two vectors do on any board; at most two are high.
            let turn_ons = [pulsed.turn_ons, held.turn_ons];
            assert!(
                turn_ons[0] > 0.98 * turn_ons[1] && turn_ons[0] < 2.0 / 3.0,
                "{name}: {turn_ons:?}"
            );
        }
    });
}

/// The reason for the pulses: legs that are held high show no current, and what is made of the samples trips the drive or
/// loses the torque.
#[test]
fn without_the_window_the_currents_are_lost() {
    let unaware = |motor, variant| drive(motor, variant, "", 1.0);
    for motor in MOTORS {
        for variant in VARIANTS {
            let own = drive(motor, variant, LOW_SIDE, 1.0);
            let run = run(&unaware(motor, variant), &own, 0.5);
            let name = format!("{motor}, {variant}");
            assert!(run.blind > 0, "{name}");
            assert!(run.tripped || run.torque < 0.5, "{name}: {}", run.torque);
        }
    }
}
