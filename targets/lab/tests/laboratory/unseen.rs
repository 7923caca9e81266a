//! The documented limits of the supervisor: a current sensor that is frozen within its range lets
//! the true current rise to several times the trip level, and nothing trips.
//!
//! If this fails because a drive trips, the supervisor detects it now: then change the paragraph
//! "What the supervisor cannot see" (`hexagen::Supervisor`, README) and this test.

use hexagen::{Fault, Sample};
use hexagen_lab::closed_loop::{ClosedLoop, CurrentLoop};
use hexagen_lab::engine::{Model, MotorSource, plant_of, prepare, run_of};
use hexagen_lab::plant::Plant;

/// Control periods, a tenth of a second.
const PERIODS: usize = 2000;

/// Kinds of controllers, each with fractions of the rated speed and of the rated torque. (At most
/// others PHCC trips, at 1.0 to 1.6 times the level.)
const RUNS: [(&str, f64, f64); 4] = [
    ("pdcc", 0.25, 1.0),
    ("fcs-mpc", 0.25, 1.0),
    ("phcc", 0.5, 0.1),
    ("pi-pwm", 0.25, 1.0),
];

/// The greatest true phase current over the trip level, and the fault, with sensor a working or
/// frozen at the count of zero current.
fn greatest_current(
    (variant, speed, share): (&str, f64, f64),
    is_frozen: bool,
) -> (f64, Option<Fault>) {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    let drive = prepare(&motor, Some(variant)).expect("generates");
    let inverter = &drive.spec.inverter;
    let omega = drive.spec.motor.rated_speed * speed;
    let plant = Plant::new(plant_of(&drive.spec), 0.1, omega).expect("a plant");
    let mut engine = drive.engine(Model::Fixed, drive.set_point(share * drive.demand()));
    let (mut most, mut fault) = (0.0_f64, None);
    let mid_scale = inverter.adc_offset as u16;
    let controller = |sample: &Sample, truth: &hexagen_lab::plant::Truth| {
        let [adc_a, adc_b, _] = sample.adc();
        let adc_a = if is_frozen { mid_scale } else { adc_a };
        let sample = Sample::with_hall([adc_a, adc_b], sample.hall()).hall_ticks(sample.ticks());
        let legs = engine.step(&sample, truth);
        most = truth
            .currents
            .iter()
            .fold(most, |most, i| most.max(i.abs()));
        fault = engine.fault();
        legs
    };
    ClosedLoop::new(plant, controller, run_of(&drive.spec, omega, 0.0).delay).run(PERIODS, &mut ());
    (most / inverter.trip_current, fault)
}

#[test]
fn a_sensor_frozen_at_mid_scale_drives_the_true_current_beyond_the_trip_level_without_a_fault() {
    for run in RUNS {
        let (sound, fault) = greatest_current(run, false);
        assert!(sound < 1.0 && fault.is_none(), "{run:?}: {sound} {fault:?}");
        let (frozen, fault) = greatest_current(run, true);
        println!("{run:?}: {frozen:.2} times the trip level, {fault:?}");
        assert_eq!(fault, None, "{run:?} sees it: change what is said");
        assert!(frozen > 2.0, "{run:?}: {frozen:.2} times the trip level");
    }
}
