//! Limits of the bus current hold in the mean, and take nothing where they are not reached.

use crate::bench::Bench;
use hexagen_lab::engine::{MotorSource, Prepared, library, prepare};
use hexagen_lab::plant::EnergyMeter;
use rayon::prelude::*;

/// Laws with the tolerance of the mean: that of whole vectors is of currents that change much in a period.
const LAWS: [(&str, f64); 6] = [
    ("pdcc", 0.015),
    ("pi-pwm", 0.015),
    ("pdcc:modulation=pair", 0.015),
    ("pdcc:emf=held,reference=quasi_square", 0.015),
    ("fcs-mpc", 0.06),
    ("phcc", 0.06),
];

/// The drive of a library motor with these fields of the inverter.
fn drive(motor: &str, law: &str, fields: &str) -> Prepared {
    let mut source = MotorSource::of_library(motor).expect("is in the library");
    let section = format!("[inverter]\n{fields}");
    source.text = source.text.replace("[inverter]\n", &section);
    prepare(&source, Some(law)).unwrap_or_else(|why| panic!("{motor}, {law}: {why}"))
}

fn limits([drawn, returned]: [f64; 2]) -> String {
    format!("bus_current_limit = \"{drawn} A\"\nreturn_current_limit = \"{returned} A\"\n")
}

/// The bus current that limits leave of a free one.
fn left(free: f64, [drawn, returned]: [f64; 2]) -> f64 {
    free.clamp(-returned, drawn)
}

impl Bench<'_> {
    /// Mean bus current over so many periods, ampere.
    fn bus_current(&mut self, periods: usize) -> f64 {
        let plant = self.closed.plant();
        let (mut meter, v_bus) = (EnergyMeter::new(plant), plant.params().v_bus);
        self.closed.run(periods, &mut meter);
        let energy = meter.balance(self.closed.plant()).bus;
        energy / v_bus / (periods as f64 * self.drive.spec.inverter.t_s)
    }

    /// The same at a set-point, once it has settled.
    fn settled(&mut self, current: f64) -> f64 {
        self.closed.controller().set_current(current);
        self.closed.run(1500, &mut ());
        self.bus_current(24 * self.sector)
    }
}

#[test]
fn every_controller_keeps_to_the_limits() {
    const LIMITS: [f64; 2] = [8.0, 3.0];
    let cases = LAWS
        .iter()
        .flat_map(|law| [(law, ""), (law, "dead_time = \"1 us\"\n")]);
    let cases: Vec<_> = cases.collect();
    cases.par_iter().for_each(|((law, tolerance), dead_time)| {
        let free = drive("trivedi-keshri-660w", law, dead_time);
        let fields = format!("{}{dead_time}", limits(LIMITS));
        let limited = drive("trivedi-keshri-660w", law, &fields);
        let rated = free.spec.motor.rated_current;
        for share in [0.1, 0.5, 1.0, -1.0] {
            let [mut one, mut two] = [&free, &limited].map(|drive| Bench::at(drive, share));
            for part in [1.0, -1.0, 0.3] {
                let [free, found] = [&mut one, &mut two].map(|bench| bench.settled(part * rated));
                let wanted = left(free, LIMITS);
                assert!(
                    (found - wanted).abs() < tolerance * wanted.abs() + 0.02,
                    "{law} {dead_time} at {share} of rated speed, {part} of rated current: {found} A, free {free} A"
                );
            }
            assert_eq!(two.closed.tripped(), None, "{law}");
        }
    });
}

/// The limits are 0.4 and 0.3 of what the motor draws and returns at rated speed. 300 periods after a step,
/// the mean is within 3 % of them.
#[test]
fn limits_hold_for_every_motor() {
    library().par_iter().for_each(|motor| {
        let free = drive(motor.name, "pdcc", "");
        let rated = free.spec.motor.rated_current;
        let free = [1.0, -1.0].map(|part| Bench::at(&free, 1.0).settled(part * rated));
        // A motor whose windings take all of the braking power returns nothing to limit.
        let returns = free[1] < 0.0;
        let returned = if returns { -free[1] } else { free[0] };
        let limits = [0.4 * free[0], 0.3 * returned];
        let limited = drive(motor.name, "pdcc", &self::limits(limits));
        for (part, free) in [1.0, -1.0].into_iter().zip(free) {
            if part < 0.0 && !returns {
                continue;
            }
            let mut bench = Bench::at(&limited, 1.0);
            bench.closed.controller().set_current(part * rated);
            bench.closed.run(300, &mut ());
            // A count of the timer moves the current of some by a hundredth: over few periods the mean is not settled.
            let found = bench.bus_current(24 * bench.sector);
            let wanted = left(free, limits);
            assert!(
                (found / wanted - 1.0).abs() < 0.03,
                "{} at {part} of rated current: {found} A in place of {wanted} A",
                motor.name
            );
            assert_eq!(bench.closed.tripped(), None, "{}", motor.name);
        }
    });
}

/// Periods after a step from no current to the rated one in which the mean of 8 periods is more than 5 % above
/// the limit.
fn exceeding(bench: &mut Bench, limit: f64) -> usize {
    bench
        .closed
        .controller()
        .set_current(bench.drive.spec.motor.rated_current);
    let means = (0..60).map(|_| bench.bus_current(8));
    let beyond = means.collect::<Vec<_>>();
    let last = beyond.iter().rposition(|mean| *mean > 1.05 * limit);
    8 * last.map_or(0, |last| last + 1)
}

/// What the guide and the semantics page say of a step at full speed.
#[test]
fn a_step_exceeds_a_limit_for_some_hundred_periods() {
    for motor in [
        "trivedi-keshri-660w",
        "hoverboard-hub",
        "teknic-m2310p",
        "hurst-long",
    ] {
        let free = drive(motor, "pdcc", "");
        let rated = free.spec.motor.rated_current;
        let limit = 0.5 * Bench::at(&free, 1.0).settled(rated);
        let limited = drive(motor, "pdcc", &limits([limit, 1.0]));
        let periods = exceeding(&mut Bench::at(&limited, 1.0), limit);
        assert!((50..=150).contains(&periods), "{motor}: {periods} periods");
    }
}
