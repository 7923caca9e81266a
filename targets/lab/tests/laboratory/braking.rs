//! `brake()` slows every motor of the library down without a trip; `coast()` leaves it alone.

use hexagen::{Fault, LegState, Legs, Sample};
use hexagen_codegen::interface::PublicValue;
use hexagen_lab::closed_loop::{ClosedLoop, CurrentLoop, Recorder, Step};
use hexagen_lab::engine::{MotorSource, Prepared, library, plant_of, prepare, run_of};
use hexagen_lab::plant::{Mechanics, Observer, Plant, Segment, Truth};
use hexagen_lab::{Interpreted, closed_loop::Trip};
use hexagen_reference::verify::Subject;
use hexagen_reference::{AnyCommand, Stop};
use rayon::prelude::*;
use std::f64::consts::TAU;

const VARIANTS: [&str; 4] = [
    "pdcc",
    "pdcc:emf=model,hall_capture=timer,reference=proportional",
    "pdcc:modulation=pair",
    "pi-pwm",
];

/// Time in which the largest torque stops the rotor from its speed, second.
const STOPPING: f64 = 0.05;

struct InLoop<'g>(Interpreted<'g>);

impl CurrentLoop for InLoop<'_> {
    fn step(&mut self, sample: &Sample, _: &Truth) -> AnyCommand {
        self.0.step(sample)
    }

    fn fault(&self) -> Option<Fault> {
        self.0.fault()
    }
}

/// What happened while a rotor was left to a drive.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Greatest phase current, ampere.
    current: f64,
    /// Periods with all lower switches on, with pulses, and with all legs off.
    low: u32,
    pulsed: u32,
    off: u32,
}

impl Observer for Seen {
    fn segment(&mut self, _: &Segment) {}
}

impl Recorder for Seen {
    fn period(&mut self, step: &Step<'_>) {
        let currents = step.truth.currents.map(f64::abs);
        self.current = currents.into_iter().fold(self.current, f64::max);
        match step.applied.legs().expect("pulses") {
            Legs::LOW => self.low += 1,
            Legs::OFF => self.off += 1,
            legs if legs.state().contains(&LegState::Pulsed) => self.pulsed += 1,
            legs => panic!("{legs:?}"),
        }
    }
}

/// A free rotor at this speed, rad/s, under a drive that stops so.
fn stopped(drive: &Prepared, stop: Stop, omega: f64) -> (Seen, f64, Option<Trip>) {
    let spec = &drive.spec;
    let torque = spec.inverter.max_current * spec.torque_constant();
    let mut params = plant_of(spec);
    params.mechanics = Some(Mechanics {
        inertia: torque * STOPPING / omega.abs(),
        opposing_torque: 0.0,
        external_torque: 0.0,
        viscous: 0.0,
    });
    let plant = Plant::new(params, 0.3, omega).expect("a plant");
    let generated = &drive.generated;
    let engine = InLoop(Interpreted::new(
        generated.graph.program(),
        &generated.interface,
    ));
    let mut closed = ClosedLoop::new(plant, engine, run_of(spec, omega, 0.0).delay);
    closed.run(200, &mut ());
    let begun = closed.plant().truth().omega_m;
    closed.controller().0.stop(stop);
    let mut seen = Seen::default();
    closed.run((2.0 * STOPPING / spec.inverter.t_s) as usize, &mut seen);
    let left = closed.plant().truth().omega_m / begun;
    (seen, left, closed.tripped())
}

/// The greatest speed at which control may begin, stated by the type, rad/s.
fn start_speed(drive: &Prepared) -> f64 {
    let mut constants = drive.generated.interface.constants.iter();
    let constant = constants.find(|constant| constant.name == "START_SPEED_RPM");
    match constant.map(|constant| &constant.value) {
        Some(PublicValue::Integer { value, .. }) => *value as f64 * TAU / 60.0,
        other => panic!("{other:?}"),
    }
}

#[test]
fn braking_stops_every_motor_of_the_library_and_coasting_none() {
    let motors = library();
    let cases = motors
        .iter()
        .flat_map(|motor| VARIANTS.map(|variant| (motor.name, variant)));
    let cases: Vec<_> = cases.collect();
    let outcomes: Vec<(bool, bool)> = cases
        .par_iter()
        .filter_map(|&(motor, variant)| {
            let source = MotorSource::of_library(motor).expect("is in the library");
            let drive = prepare(&source, Some(variant)).ok()?;
            let spec = &drive.spec;
            let sign = if motor.len() % 2 == 0 { 1.0 } else { -1.0 };
            // Control begins on a turning rotor, once its direction is known.
            let omega = sign * (0.6 * spec.motor.rated_speed).min(start_speed(&drive));
            let (seen, left, trip) = stopped(&drive, Stop::Brake, omega);
            let largest = seen.current / spec.inverter.max_current;
            let what = format!(
                "{motor} {variant}: short up to {} periods, {left:.3} of the speed left, {largest:.2} of the largest current, {seen:?}",
                spec.brake_periods()
            );
            println!("{what}");
            assert!(trip.is_none(), "{what}: {trip:?}");
            // A short circuit with little resistance makes little torque at speed.
            assert!(left.abs() < 0.7, "{what}");
            let (seen, left, trip) = stopped(&drive, Stop::Coast, omega);
            assert!(trip.is_none() && (left - 1.0).abs() < 0.01, "{what}: coasts to {left}");
            assert!(seen.off + 1 >= seen.low + seen.pulsed, "{what}: {seen:?}");
            Some((spec.brake_periods() == 0, spec.brake_periods() > 0))
        })
        .collect();
    let (always, above) = outcomes.iter().fold((0, 0), |(always, above), outcome| {
        (always + u32::from(outcome.0), above + u32::from(outcome.1))
    });
    println!("{always} may be shorted at every speed, {above} below one");
    assert!(outcomes.len() > 40 && above > 20);
}
