//! A measured bus voltage takes torque back before it trips: what brakes at a high bus, what drives at
//! a low one, in either direction; beyond the limits the drive trips.

use crate::bench::Bench;
use hexagen::Fault;
use hexagen_lab::closed_loop::CurrentLoop;
use hexagen_lab::engine::{MotorSource, Prepared, prepare};
use rayon::prelude::*;

/// Trips at 70 % and 130 % of 48 V; braking torque is whole up to 54.4 V and 0 from 60.4 V on, motoring
/// torque whole from 41.6 V on and 0 up to 35.6 V.
const BUS: &str = "[inverter]\nv_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\n\
    braking_fade = \"8 V\"\nmotoring_fade = \"8 V\"\n";

const LAWS: [&str; 2] = [
    "pdcc:emf=model,hall_capture=timer,reference=proportional",
    "pi-pwm:emf=model,hall_capture=timer,reference=proportional",
];

/// Bus voltage, with the share of the set-point that is left in braking and in motoring.
const SHARES: [(f64, f64, f64); 9] = [
    (48.0, 1.0, 1.0),
    (54.0, 1.0, 1.0),
    (57.4, 0.5, 1.0),
    (60.5, 0.0, 1.0),
    (62.0, 0.0, 1.0),
    (42.0, 1.0, 1.0),
    (38.6, 1.0, 0.5),
    (35.5, 1.0, 0.0),
    (34.0, 1.0, 0.0),
];

fn drive(law: &str) -> Prepared {
    let mut motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    motor.text = motor.text.replace("[inverter]\n", BUS);
    prepare(&motor, Some(law)).unwrap_or_else(|why| panic!("{law}: {why}"))
}

impl Bench<'_> {
    fn set_bus(&mut self, volts: f64) {
        let plant = self.closed.plant_mut();
        plant.change(|params| params.v_bus = volts).expect("a bus");
        let counts = self.drive.bus_counts(volts).expect("a measured bus");
        self.closed.controller().set_bus(counts);
    }

    /// Mean torque in units of the rated torque, once the currents have settled.
    fn torque(&mut self, current: f64) -> f64 {
        self.closed.controller().set_current(current);
        self.closed.run(12 * self.sector, &mut ());
        let (mut sum, periods) = (0.0, 12 * self.sector);
        for _ in 0..periods {
            self.closed.run(1, &mut ());
            sum += self.closed.plant().truth().mean_torque;
        }
        let spec = &self.drive.spec;
        sum / periods as f64 / (spec.motor.rated_current * spec.torque_constant())
    }
}

#[test]
fn torque_fades_with_the_bus_voltage() {
    LAWS.par_iter().for_each(|law| {
        let drive = drive(law);
        let rated = drive.spec.motor.rated_current;
        for share in [0.25, -0.25] {
            let mut bench = Bench::at(&drive, share);
            let way = share.signum();
            for (volts, braking, motoring) in SHARES {
                bench.set_bus(volts);
                for (left, sign) in [(braking, -way), (motoring, way)] {
                    let found = bench.torque(sign * rated);
                    assert!(
                        (found - sign * left).abs() < 0.05,
                        "{law} at {share} of rated speed, {volts} V: {found} in place of {}",
                        sign * left
                    );
                }
            }
            assert_eq!(bench.closed.tripped(), None, "{law}");
        }
    });
}

#[test]
fn a_bus_voltage_beyond_its_limits_trips() {
    let drive = drive(LAWS[0]);
    for (volts, fault) in [(63.0, Fault::OverVoltage), (33.0, Fault::UnderVoltage)] {
        let mut bench = Bench::at(&drive, 0.25);
        bench.set_bus(volts);
        bench.closed.run(1, &mut ());
        assert_eq!(bench.closed.controller().fault(), Some(fault), "{volts} V");
    }
}
