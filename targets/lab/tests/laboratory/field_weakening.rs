//! Torque beyond the speed at which the bus voltage ends, with field weakening and without.

use hexagen_codegen::spec::Envelope;
use hexagen_lab::closed_loop::{RunOptions, mean_torque, measure};
use hexagen_lab::engine::{Model, MotorSource, Prepared, plant_of, prepare, run_of};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// A motor of the library on a bus that takes current, to twice its rated speed.
fn drive(name: &str, max_current: Option<&str>, options: &str) -> Prepared {
    let mut source = MotorSource::of_library(name).expect("is in the library");
    let mut fields = "[inverter]\nbus_clamp = \"1 kV\"\n".to_owned();
    if let Some(most) = max_current {
        let lines = source.text.lines();
        let others = lines.filter(|line| !line.starts_with("max_current"));
        source.text = others.collect::<Vec<_>>().join("\n");
        let _ = writeln!(fields, "max_current = \"{most}\"");
    }
    source.text = source.text.replacen("[inverter]\n", &fields, 1);
    prepare(&source, Some(options)).unwrap_or_else(|why| panic!("{name} {options}: {why}"))
}

/// Mean torque at a speed in mechanical rad/s, Nm.
fn torque(drive: &Prepared, omega_m: f64, demand: f64) -> f64 {
    let run = RunOptions {
        starts: vec![0.1],
        ..run_of(&drive.spec, omega_m, demand)
    };
    let maker = drive.maker(Model::Fixed, drive.set_point(demand));
    let torque = mean_torque(&plant_of(&drive.spec), &run, &maker).expect("runs");
    torque.unwrap_or_else(|trip| panic!("{} at {omega_m} rad/s: {trip}", drive.motor))
}

/// Speeds in rpm, and the torque of the proportional current of 3.3 Nm at the best constant angle there, Nm: of a
/// float simulation of another hand. The current's peak is 22 A.
const BEST: [(f64, f64); 4] = [
    (2400.0, 3.15),
    (2600.0, 2.92),
    (2800.0, 2.61),
    (3000.0, 2.00),
];

#[test]
fn the_angle_finds_the_best_torque_within_five_percent() {
    for kind in ["pdcc", "pi-pwm"] {
        let options = format!("{kind}:field_weakening=on");
        let weakened = drive("trivedi-keshri-660w", Some("20.4 A"), &options);
        for (rpm, best) in BEST {
            let found = torque(&weakened, rpm * TAU / 60.0, 3.3);
            println!("{kind} at {rpm} rpm: {found:.3} Nm, best {best} Nm");
            assert!(found > 0.95 * best, "{kind} at {rpm} rpm: {found}");
        }
    }
}

/// Trapezoid and sines, of 2.4 to 11 electrical degrees per period at rated speed.
const MOTORS: [&str; 5] = [
    "trivedi-keshri-660w",
    "teknic-m2310p",
    "hurst-long",
    "odrive-d6374-150kv",
    "mit-mini-cheetah",
];

/// Speeds over that at which the EMF takes the whole bus.
const SPEEDS: [f64; 7] = [0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.15];

/// Mean torque over the demanded one at each of the `speeds`, forward and backward; `share`: of the rated torque.
fn curves(drive: &Prepared, share: f64, speeds: &[f64]) -> Vec<Vec<f64>> {
    let idle = Envelope::of(&drive.spec).idle_speed();
    let demand = share * drive.demand();
    [1.0, -1.0]
        .into_par_iter()
        .map(|way| {
            let at = |speed: &f64| torque(drive, way * speed * idle, way * demand) / (way * demand);
            speeds.iter().map(at).collect()
        })
        .collect()
}

#[test]
fn the_torque_of_a_weakened_envelope_is_reached_within_two_percent() {
    MOTORS.par_iter().for_each(|motor| {
        let weakened = drive(motor, None, "pdcc:field_weakening=on");
        let envelope = Envelope::of(&weakened.spec);
        let plain = Envelope {
            weakening: None,
            ..envelope
        };
        let lasts = plain.speed(weakened.demand()).expect("is held");
        for share in [1.02, 1.1, 1.2] {
            let omega_m = share * lasts;
            let most = envelope.torque(omega_m);
            assert!(most >= plain.torque(omega_m), "{motor} at {share}");
            let demand = most.min(weakened.demand());
            // No angle of a low inductance helps far beyond.
            if demand == 0.0 {
                continue;
            }
            let reached = torque(&weakened, omega_m, demand);
            println!(
                "{motor} at {share}: {reached:.4} of {demand:.4} Nm, {:.4} without",
                plain.torque(omega_m)
            );
            assert!(
                reached > 0.98 * demand,
                "{motor} at {share}: {reached} of {demand} Nm"
            );
        }
    });
}

/// Ripple in percent and rms current at a speed in mechanical rad/s.
fn ripple_and_current(drive: &Prepared, omega_m: f64, demand: f64) -> [f64; 2] {
    let run = run_of(&drive.spec, omega_m, demand);
    let maker = drive.maker(Model::Fixed, drive.set_point(demand));
    let measured = measure(&plant_of(&drive.spec), &run, maker).expect("runs");
    assert_eq!(measured.tripped, None, "{} at {omega_m} rad/s", drive.motor);
    let ripple = measured.figures.ripple_pp_pct.expect("a torque");
    [ripple, measured.figures.current_rms_a.expect("a current")]
}

/// The current of a trapezoid's weakening once took voltage that held its own angle, where the bus drives the current
/// without any; and its torque rippled by more than the demand beyond.
#[test]
fn weakening_ends_where_the_bus_drives_the_current() {
    for motor in ["trivedi-keshri-660w", "hurst-long", "anaheim-bly171d"] {
        for kind in ["pdcc", "pi-pwm"] {
            let plain = drive(motor, None, kind);
            let weakened = drive(motor, None, &format!("{kind}:field_weakening=on"));
            let bus = Envelope {
                weakening: None,
                ..Envelope::of(&plain.spec)
            };
            for share in [0.15, 0.3, 0.6] {
                let demand = share * plain.demand();
                let lasts = bus.speed(demand).expect("is held");
                for (speed, most) in [(0.9, 1.5), (0.97, 1.5), (1.03, 0.0)] {
                    let [ripple, current] = ripple_and_current(&weakened, speed * lasts, demand);
                    let [without, least] = ripple_and_current(&plain, speed * lasts, demand);
                    let named = format!(
                        "{motor} {kind}, {share} of the torque at {speed} of its last speed: {ripple:.1} %, {current:.2} A; without {without:.1} %, {least:.2} A"
                    );
                    println!("{named}");
                    assert!(ripple < without + most, "{named}");
                    assert!(speed > 1.0 || current < 1.05 * least, "{named}");
                }
            }
        }
    }
}

#[test]
fn torque_falls_steadily_and_never_turns_against_the_demand() {
    MOTORS.par_iter().for_each(|motor| {
        let plain = drive(motor, None, "pdcc");
        let weakened = drive(motor, None, "pdcc:field_weakening=on");
        for share in [1.0, 0.3] {
            let with = curves(&weakened, share, &SPEEDS);
            // Without field weakening no current flows along the EMF where that exceeds the bus.
            let without = curves(&plain, share, &SPEEDS[..4]);
            println!("{motor}, {share}: {with:.2?}, without {without:.2?}");
            // A turned current of a trapezoid ripples, and the mean of a small demand wanders with it.
            let wanders = if share < 1.0 { 0.03 } else { 0.01 };
            for curve in with.iter().chain(&without) {
                let named = || format!("{motor}, {share}: {curve:.3?}");
                assert!(curve[0] > 0.98, "{}", named());
                let falls = curve.windows(2).all(|pair| pair[1] < pair[0] + wanders);
                assert!(falls, "{}", named());
                assert!(curve.iter().all(|torque| *torque > -0.01), "{}", named());
            }
            for (with, without) in with.iter().zip(&without) {
                let gains = with.iter().zip(without).all(|(a, b)| a + wanders > *b);
                assert!(gains, "{motor}, {share}: {with:.3?} {without:.3?}");
            }
        }
    });
}
