//! The speed loop in closed loop, on motors of different size: run-up from standstill under load,
//! reversal, load steps, a held rotor, current limit, and the documented lowest speed.

use hexagen_lab::closed_loop::ClosedLoop;
use hexagen_lab::engine::{
    Engine, Model, MotorSource, Prepared, library, plant_of, prepare, run_of,
};
use hexagen_lab::plant::{Mechanics, Plant};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Variants of every kind, and the excess of their phase currents over the current limit, relative
/// to the rated current: ripple, the more the fewer vectors they choose from.
const VARIANTS: [(&str, f64); 7] = [
    ("pdcc:speed_loop=on", 0.25),
    ("pi-pwm:speed_loop=on", 0.6),
    ("pdcc:reference=quasi_square,speed_loop=on", 0.15),
    (
        "pdcc:speed_loop=on,emf=model,advance=2,hall_capture=timer",
        0.1,
    ),
    ("pi-pwm:speed_loop=on,six_step=on", 0.6),
    ("fcs-mpc:speed_loop=on", 0.7),
    ("phcc:speed_loop=on", 0.9),
];

/// From this ripple on, a small current is too low for slow rotation.
const RESTLESS: f64 = 0.7;

/// A kind that exceeds the limit further with one motor than with others: two periods of a vector
/// change its current by 1.5 times the rated one.
const ROUGH: (&str, &str) = ("hurst-long", "phcc");

/// Motors, from a servo of tens of watts to a traction motor, and an inertia of rotor and load with
/// a short run-up.
const MOTORS: [(&str, &str); 3] = [
    ("anaheim-bly171d", "1.5e-5 kg m2"),
    ("hurst-long", "5e-5 kg m2"),
    ("trivedi-keshri-660w", "2e-3 kg m2"),
];

/// The same with loads that make the run-up a long one at the current limit.
const HEAVY: [(&str, &str); 3] = [
    ("anaheim-bly171d", "3e-4 kg m2"),
    ("hurst-long", "1.5e-3 kg m2"),
    ("trivedi-keshri-660w", "3e-2 kg m2"),
];

/// The library's motor with this inertia, without a stall time-out.
fn motor_with(name: &str, inertia: &str) -> MotorSource {
    let mut motor = MotorSource::of_library(name).expect("is in the library");
    let own = motor
        .text
        .lines()
        .filter(|line| !line.starts_with("inertia"));
    let text = own.collect::<Vec<_>>().join("\n");
    motor.text = text.replace("[motor]\n", &format!("[motor]\ninertia = \"{inertia}\"\n"));
    motor.text = motor
        .text
        .replace("[inverter]\n", "[inverter]\nstall_timeout = \"0 s\"\n");
    motor
}

fn drive(name: &str, inertia: &str, variant: &str) -> Prepared {
    let motor = motor_with(name, inertia);
    prepare(&motor, Some(variant)).unwrap_or_else(|why| panic!("{name} {variant}: {why}"))
}

/// Measurements of an interval.
#[derive(Clone, Copy, Debug)]
struct Leg {
    /// Mean speed over the last fifth, relative to the set-point.
    mean: f64,
    /// Least speed over the last fifth, relative to the set-point.
    least: f64,
    /// Greatest speed, relative to the set-point.
    peak: f64,
    /// Excess of the greatest phase current over the limit, relative to the rated current.
    excess: f64,
}

/// A drive with a free shaft.
struct Bench<'d> {
    drive: &'d Prepared,
    closed: ClosedLoop<Engine<'d>>,
    /// Limit of the current, ampere.
    limit: f64,
}

impl<'d> Bench<'d> {
    /// At rest, with a current limit and a load relative to the rated torque.
    fn at_rest(drive: &'d Prepared, limit: f64, load: f64) -> Self {
        let speed = drive.spec.controller.common().speed.expect("a speed loop");
        let mut params = plant_of(&drive.spec);
        params.mechanics = Some(Mechanics {
            inertia: speed.inertia,
            opposing_torque: load * drive.demand(),
            external_torque: 0.0,
            viscous: 0.0,
        });
        let plant = Plant::new(params, 0.2, 0.0).expect("a plant");
        let set_point = drive.set_point(limit * drive.demand());
        let delay = run_of(&drive.spec, 0.0, 0.0).delay;
        Self {
            drive,
            closed: ClosedLoop::new(plant, drive.engine(Model::Fixed, set_point), delay),
            limit: set_point.current,
        }
    }

    /// Runs this many times 1/f at a fraction of the rated speed.
    fn run(&mut self, share: f64, times: f64) -> Leg {
        let spec = &self.drive.spec;
        let speed = spec.controller.common().speed.expect("a speed loop");
        let omega = share * spec.motor.rated_speed;
        self.closed.controller().set_speed(omega * 60.0 / TAU);
        let periods = (times / speed.bandwidth / spec.inverter.t_s) as usize;
        let last = periods * 4 / 5;
        let (mut peak, mut least, mut current, mut sum) = (0.0_f64, f64::INFINITY, 0.0_f64, 0.0);
        for period in 0..periods {
            self.closed.run(1, &mut ());
            let truth = self.closed.plant().truth();
            let reached = truth.omega_m / omega;
            peak = peak.max(reached);
            current = truth
                .currents
                .iter()
                .fold(current, |most, i| most.max(i.abs()));
            if period >= last {
                sum += reached;
                least = least.min(reached);
            }
        }
        Leg {
            mean: sum / (periods - last) as f64,
            least,
            peak,
            excess: (current - self.limit) / spec.motor.rated_current,
        }
    }

    fn load(&mut self, load: f64) {
        let torque = load * self.drive.demand();
        self.closed.plant_mut().set_load(torque);
    }
}

/// Runs a test on all motors and variants, with the tolerated excess of the current.
fn on_all(motors: &[(&str, &str)], test: impl Fn(&str, &Prepared, f64) + Sync) {
    let all: Vec<_> = motors
        .iter()
        .flat_map(|motor| VARIANTS.map(|variant| (*motor, variant)))
        .filter(|((motor, _), (variant, _))| !(*motor == ROUGH.0 && variant.starts_with(ROUGH.1)))
        .collect();
    all.par_iter()
        .for_each(|&((motor, inertia), (variant, excess))| {
            let drive = drive(motor, inertia, variant);
            test(&format!("{motor} {variant}"), &drive, excess);
        });
}

#[test]
fn starts_under_load_reverses_and_handles_load_steps() {
    on_all(&MOTORS, |name, drive, excess| {
        let mut bench = Bench::at_rest(drive, 1.0, 0.3);
        for (share, load) in [
            (0.5, 0.3),
            (0.5, 0.7),
            (0.5, 0.0),
            (-0.5, 0.3),
            (0.2, 0.3),
            (0.8, 0.3),
        ] {
            bench.load(load);
            let leg = bench.run(share, 6.0);
            println!("{name} {share} of rated speed, {load} of rated torque: {leg:.3?}");
            assert!((leg.mean - 1.0).abs() < 0.01, "{name} {share}: {leg:?}");
            assert!(leg.least > 0.95, "{name} {share}: {leg:?}");
            assert!(leg.excess < excess, "{name} {share}: {leg:?}");
        }
        assert_eq!(bench.closed.tripped(), None, "{name}");
    });
}

/// Time in which the rated torque brings a motor and its load to the rated speed, second.
const RUN_UP: f64 = 0.25;

/// What is wrong with a motor's speeds under load.
fn wrong_speeds(motor: &str, law: &str) -> Vec<String> {
    let source = MotorSource::of_library(motor).expect("is in the library");
    let plain = prepare(&source, Some(law)).unwrap_or_else(|why| panic!("{motor} {law}: {why}"));
    let inertia = plain.demand() * RUN_UP / plain.spec.motor.rated_speed;
    let drive = drive(
        motor,
        &format!("{inertia} kg m2"),
        &format!("{law}:speed_loop=on"),
    );
    let mut bench = Bench::at_rest(&drive, 1.0, 0.3);
    let mut wrong = vec![];
    for share in [0.8, -0.5] {
        let leg = bench.run(share, 12.0);
        println!("{motor} {law} {share} of rated speed: {leg:.4?}");
        if (leg.mean - 1.0).abs() > 0.01 || bench.closed.tripped().is_some() {
            wrong.push(format!("{motor} {law} {share}: {leg:?}"));
        }
    }
    wrong
}

#[test]
fn every_library_motor_holds_its_speed_within_a_percent() {
    let wrong: Vec<String> = library()
        .par_iter()
        .flat_map_iter(|motor| {
            let laws = ["pdcc", "pi-pwm"].into_iter();
            laws.flat_map(|law| wrong_speeds(motor.name, law))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn a_long_run_up_at_the_limit_ends_without_overshoot() {
    on_all(&HEAVY, |name, drive, excess| {
        for (limit, load, times) in [(1.0, 0.0, 15.0), (0.5, 0.1, 40.0)] {
            let mut bench = Bench::at_rest(drive, limit, load);
            let early = bench.run(0.6, 1.0);
            // At the limit all the time, and far below the speed.
            assert!(early.peak < 0.7, "{name}: {early:?}");
            let leg = bench.run(0.6, times);
            println!("{name} {limit} of rated current, {load} of rated torque: {leg:.3?}");
            assert!((leg.mean - 1.0).abs() < 0.02, "{name}: {leg:?}");
            assert!(leg.peak < 1.01, "{name}: {leg:?}");
            assert!(leg.excess < excess, "{name}: {leg:?}");
            assert_eq!(bench.closed.tripped(), None, "{name}");
        }
    });
}

/// Seconds for which the rotor is held, longer than the default stall time-out, which is off here.
const HELD: f64 = 2.0;

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn a_rotor_that_was_held_starts_again_without_overshoot() {
    on_all(&MOTORS, |name, drive, excess| {
        let mut bench = Bench::at_rest(drive, 1.0, 0.3);
        bench.run(0.5, 6.0);
        // More than the current limit overcomes.
        bench.load(4.0);
        let speed = drive.spec.controller.common().speed;
        bench.run(0.5, HELD * speed.expect("a speed loop").bandwidth);
        let speed = bench.closed.plant().truth().omega_m;
        assert!(speed.abs() < 1e-3, "{name}: {speed} rad/s");
        bench.load(0.3);
        let leg = bench.run(0.5, 6.0);
        println!("{name}: {leg:.3?}");
        assert!(leg.peak < 1.1, "{name}: {leg:?}");
        assert!((leg.mean - 1.0).abs() < 0.01, "{name}: {leg:?}");
        assert!(leg.excess < excess, "{name}: {leg:?}");
        assert_eq!(bench.closed.tripped(), None, "{name}");
    });
}

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn four_turns_in_the_loops_time_are_enough_and_one_is_not() {
    on_all(&MOTORS, |name, drive, excess| {
        if excess >= RESTLESS {
            return;
        }
        let spec = &drive.spec;
        let speed = spec.controller.common().speed.expect("a speed loop");
        let pole_pairs = f64::from(spec.motor.pole_pairs);
        let share =
            |turns: f64| turns * speed.bandwidth * TAU / pole_pairs / spec.motor.rated_speed;
        let [slow, slower] = [4.0, 1.0].map(|turns| {
            let mut bench = Bench::at_rest(drive, 1.0, 0.0);
            bench.run(share(turns), 12.0)
        });
        println!("{name} four turns: {slow:.3?}, one: {slower:.3?}");
        assert!((slow.mean - 1.0).abs() < 0.01, "{name}: {slow:?}");
        assert!(slow.least > 0.98, "{name}: {slow:?}");
        assert!(slower.least < 0.95, "{name}: {slower:?}");
    });
}

/// A clock of 2.5 ticks a period: intervals counted with two or three would give a speed with an
/// error of 0.6 %.
#[test]
fn edge_ticks_with_a_fraction_give_the_speed() {
    let mut motor = motor_with("trivedi-keshri-660w", "2e-3 kg m2");
    motor.text = motor.text.replace("\"1 MHz\"", "\"50 kHz\"");
    let variant = "pdcc:speed_loop=on,emf=model,advance=2,hall_capture=timer";
    let drive = prepare(&motor, Some(variant)).unwrap_or_else(|why| panic!("{why}"));
    let mut bench = Bench::at_rest(&drive, 1.0, 0.3);
    for share in [0.8, -0.5] {
        let leg = bench.run(share, 12.0);
        println!("{share} of rated speed: {leg:.4?}");
        assert!((leg.mean - 1.0).abs() < 0.002, "{share}: {leg:?}");
    }
    assert_eq!(bench.closed.tripped(), None);
}
