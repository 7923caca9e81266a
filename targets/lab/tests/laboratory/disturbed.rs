//! One disturbance at a time, at rated torque: the current stays what was asked for, with little ripple.

use hexagen_codegen::spec::{Envelope, Spec};
use hexagen_lab::closed_loop::{Measurement, measure};
use hexagen_lab::engine::{
    Model, MotorSource, PlantOptions, Prepared, SelectedMotor, prepare, run_of,
};
use rayon::prelude::*;

/// Controllers with a modulator and an observer.
const VARIANTS: [&str; 2] = ["pdcc", "pi-pwm"];

/// Speeds, percent of the rated one.
const SPEEDS: [u32; 4] = [10, 25, 60, 100];

/// Dead time of the disturbances, second.
const DEAD_TIME: f64 = 1e-6;

/// What differs between plant and drive.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Disturbance {
    Resistance(f64),
    Inductance(f64),
    Emf(f64),
    Bus(f64),
    /// Stated in the motor file, so the drive knows it.
    StatedDeadTime,
    UnstatedDeadTime,
}

use Disturbance::{Bus, Emf, Inductance, Resistance, StatedDeadTime, UnstatedDeadTime};

const DISTURBANCES: [Disturbance; 9] = [
    Resistance(0.5),
    Resistance(2.0),
    Inductance(0.75),
    Inductance(1.3),
    Emf(0.8),
    Emf(1.2),
    Bus(0.85),
    StatedDeadTime,
    UnstatedDeadTime,
];

/// Where the motor's inductance lets the current move too far in a period: motor, disturbance, and there the torque's
/// greatest distance from the demand and the greatest ripple, percent.
const MISSED: &[(&str, Disturbance, f64, f64)] = &[
    ("anaheim-bly171d", Inductance(0.75), 0.2, 6.5),
    ("anaheim-bly171d", Inductance(1.3), 0.2, 5.5),
    ("anaheim-bly172s", Inductance(0.75), 0.2, 6.5),
    ("br2804-1700kv", Bus(0.85), 0.9, 9.5),
    ("br2804-1700kv", Emf(0.8), 0.2, 8.0),
    ("br2804-1700kv", Emf(1.2), 1.0, 11.5),
    ("br2804-1700kv", Inductance(0.75), 1.4, 12.0),
    ("br2804-1700kv", Inductance(1.3), 0.8, 7.5),
    ("br2804-1700kv", Resistance(0.5), 0.7, 11.0),
    ("br2804-1700kv", Resistance(2.0), 1.5, 8.5),
    ("br2804-1700kv", StatedDeadTime, 1.3, 22.0),
    ("br2804-1700kv", UnstatedDeadTime, 9.3, 44.0),
    ("hurst-long", Inductance(0.75), 0.3, 7.5),
    ("hurst-long", Inductance(1.3), 0.2, 6.0),
    // The drop across the resistance lies along the current, and is corrected along the EMF.
    ("linix-45zwn24-40", Resistance(2.0), 0.2, 5.5),
    ("odrive-d6374-150kv", UnstatedDeadTime, 2.2, 10.0),
    ("tekin-redline-4600kv", Bus(0.85), 0.8, 8.0),
    ("tekin-redline-4600kv", Emf(1.2), 0.8, 10.0),
    ("tekin-redline-4600kv", Inductance(0.75), 1.0, 10.0),
    ("tekin-redline-4600kv", Resistance(2.0), 0.3, 7.5),
    ("tekin-redline-4600kv", StatedDeadTime, 1.0, 9.5),
    ("tekin-redline-4600kv", UnstatedDeadTime, 4.6, 15.0),
    ("velineon-3500", Bus(0.85), 0.5, 10.5),
    ("velineon-3500", Emf(0.8), 0.6, 7.0),
    ("velineon-3500", Emf(1.2), 0.5, 12.5),
    ("velineon-3500", Inductance(0.75), 0.8, 11.5),
    ("velineon-3500", Inductance(1.3), 0.5, 8.0),
    ("velineon-3500", Resistance(0.5), 0.5, 11.0),
    ("velineon-3500", Resistance(2.0), 0.9, 9.0),
    ("velineon-3500", StatedDeadTime, 0.9, 22.0),
    ("velineon-3500", UnstatedDeadTime, 6.0, 21.5),
];

impl Disturbance {
    /// The plant options, on top of the drive's own plant.
    fn plant(self, spec: &Spec) -> PlantOptions {
        let mut plant = PlantOptions::default();
        match self {
            Resistance(scale) => plant.scale_r = Some(scale),
            Inductance(scale) => plant.scale_l = Some(scale),
            Emf(scale) => plant.scale_kb = Some(scale),
            Bus(share) => plant.v_bus = Some(share * spec.inverter.v_bus),
            StatedDeadTime => (),
            UnstatedDeadTime => plant.dead_time = Some(spec.inverter.dead_time + DEAD_TIME),
        }
        plant
    }

    /// Torque over the demand at the demanded current.
    fn torque(self) -> f64 {
        match self {
            Emf(scale) => scale,
            _ => 1.0,
        }
    }

    /// Speed up to which the disturbed plant's bus drives the whole current, rad/s.
    fn reach(self, spec: &Spec, torque: f64) -> f64 {
        let mut real = spec.clone();
        let (motor, inverter) = (&mut real.motor, &mut real.inverter);
        match self {
            Resistance(scale) => motor.resistance *= scale,
            Inductance(scale) => motor.inductance *= scale,
            Emf(scale) => motor.emf_constant *= scale,
            Bus(share) => inverter.v_bus *= share,
            StatedDeadTime | UnstatedDeadTime => {
                // Lost on either edge of a period.
                inverter.v_bus *= 1.0 - 2.0 * DEAD_TIME / inverter.pwm_period();
            }
        }
        let torque = torque * self.torque();
        Envelope::of(&real).speed(torque).unwrap_or_default()
    }

    /// Least torque and greatest ripple, percent of the demand. Edges that are seen at samples add a ripple of their own.
    fn limits(self, spec: &Spec) -> [f64; 2] {
        let fine = spec.degrees_per_period() <= 12.0;
        let of_edges = 100.0 * spec.sampled_ripple().unwrap_or(0.0);
        let [torque, ripple] = match self {
            UnstatedDeadTime => [96.0, 9.0],
            _ => [99.0, if fine { 5.0 } else { 7.0 }],
        };
        [torque, ripple + of_edges]
    }
}

/// A drive of a motor as its file has it, or with [`DEAD_TIME`] stated.
fn drive(motor: &str, variant: &str, states_dead_time: bool) -> Prepared {
    let lines = states_dead_time.then_some("dead_time = \"1 us\"\n");
    drive_with(motor, variant, lines)
}

/// A drive of a motor as its file has it, or with these lines, the dead time among them, in its inverter.
fn drive_with(motor: &str, variant: &str, stated: Option<&str>) -> Prepared {
    let mut source = MotorSource::of_library(motor).expect("is in the library");
    if let Some(stated) = stated {
        let is_other = |line: &&str| !line.starts_with("dead_time =");
        let lines: Vec<&str> = source.text.lines().filter(is_other).collect();
        let text = lines.join("\n") + "\n";
        source.text = text.replacen("[inverter]\n", &format!("[inverter]\n{stated}"), 1);
        assert!(source.text.contains("\ndead_time"), "{}", source.text);
    }
    prepare(&source, Some(variant)).expect("generates")
}

/// A point that is not right.
struct Miss {
    motor: String,
    disturbance: Disturbance,
    torque: f64,
    ripple: f64,
    text: String,
}

/// A run at a signed speed and a signed torque; none where the torque is right.
fn miss(drive: &Prepared, disturbance: Disturbance, speed: u32, signs: [f64; 2]) -> Option<Miss> {
    let spec = &drive.spec;
    let omega = f64::from(speed) / 100.0 * spec.motor.rated_speed;
    let demand = drive.demand();
    if disturbance.reach(spec, demand) < omega {
        return None;
    }
    let [direction, mode] = signs;
    let torque = direction * mode * demand;
    let plant = disturbance.plant(spec);
    let params = plant.plant(drive).expect("is possible");
    let run = run_of(spec, direction * omega, torque);
    let set_point = plant.set_point(drive, torque);
    let Measurement {
        figures, tripped, ..
    } = measure(&params, &run, drive.maker(Model::Fixed, set_point)).expect("runs");
    let mean = figures.mean_torque_nm.filter(|_| tripped.is_none());
    let torque = mean.map_or(0.0, |mean| 100.0 * mean / torque / disturbance.torque());
    let ripple = figures.ripple_pp_pct.unwrap_or(f64::INFINITY);
    let [least, most] = disturbance.limits(spec);
    let is_right = torque >= least && torque <= 200.0 - least && ripple <= most;
    let motor = drive.motor.clone();
    let text = format!("{motor} {disturbance:?} {speed} % {signs:?}: {torque:.2} with {ripple:.2}");
    (!is_right).then_some(Miss {
        motor,
        disturbance,
        torque,
        ripple,
        text,
    })
}

/// Directions and modes: motoring and braking, forward and backward.
const QUADRANTS: [[f64; 2]; 4] = [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]];

/// The points that are not right, of some speeds in all quadrants.
fn misses(
    drive: &Prepared,
    disturbance: Disturbance,
    speeds: &[u32],
) -> impl Iterator<Item = Miss> {
    speeds.iter().flat_map(move |&speed| {
        let at = move |signs| miss(drive, disturbance, speed, signs);
        QUADRANTS.into_iter().filter_map(at)
    })
}

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn no_disturbance_changes_the_current_or_makes_it_ripple() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let drives = motors.iter().flat_map(|motor| {
        let drive =
            |variant| [false, true].map(|states| drive(&motor.source.name, variant, states));
        VARIANTS.map(drive)
    });
    let drives: Vec<[Prepared; 2]> = drives.collect();
    let pairs: Vec<_> = drives
        .iter()
        .flat_map(|[as_filed, stating]| {
            DISTURBANCES.map(|disturbance| match disturbance {
                StatedDeadTime => (stating, disturbance),
                _ => (as_filed, disturbance),
            })
        })
        .collect();
    let misses = pairs
        .par_iter()
        .flat_map_iter(|&(drive, disturbance)| misses(drive, disturbance, &SPEEDS));
    let misses: Vec<Miss> = misses.collect();
    let is_known = |miss: &Miss| {
        MISSED.iter().any(|(motor, disturbance, torque, ripple)| {
            miss.motor == *motor
                && miss.disturbance == *disturbance
                && (miss.torque - 100.0).abs() <= *torque
                && miss.ripple <= *ripple
        })
    };
    let unknown = misses.iter().filter(|miss| !is_known(miss));
    let unknown: Vec<&str> = unknown.map(|miss| miss.text.as_str()).collect();
    assert!(unknown.is_empty(), "{unknown:#?}");
    for (motor, disturbance, ..) in MISSED {
        let here = |miss: &Miss| miss.motor == *motor && miss.disturbance == *disturbance;
        assert!(misses.iter().any(here), "{motor} {disturbance:?} is right");
    }
}

/// The same with Hall edges seen at samples only, on the motors for which no warning (HX0620) tells of their ripple.
#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn an_observer_of_sampled_edges_bears_the_same_disturbances() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    // Some have no Hall sensors.
    let drives = motors.iter().flat_map(|motor| {
        VARIANTS.into_iter().filter_map(|variant| {
            let variant = format!("{variant}:hall_capture=sampled");
            prepare(&motor.source, Some(&variant)).ok()
        })
    });
    let is_smooth = |drive: &Prepared| {
        let spec = &drive.spec;
        spec.sampled_ripple().is_some() && spec.told_sampled_ripple().is_none()
    };
    let drives: Vec<Prepared> = drives.filter(is_smooth).collect();
    assert!(drives.len() >= 10, "{} drives", drives.len());
    let found = drives.par_iter().flat_map_iter(|drive| {
        // The dead time of a drive stands in its file.
        let others = DISTURBANCES
            .into_iter()
            .filter(|what| *what != StatedDeadTime);
        others.flat_map(move |disturbance| misses(drive, disturbance, &SPEEDS))
    });
    let found: Vec<String> = found.map(|miss| miss.text).collect();
    assert!(found.is_empty(), "{found:#?}");
}

/// The observer corrects the EMF along its own shape. Along the proportional current, which is short where the EMF is
/// long, it would leave the harmonics uncorrected.
#[test]
fn a_wrong_constant_leaves_no_harmonics_of_a_trapezoid() {
    for motor in ["hurst-long", "linix-45zwn24-40"] {
        for variant in VARIANTS {
            let drive = &drive(motor, variant, false);
            for disturbance in [Emf(0.8), Emf(1.2), Bus(0.85)] {
                let misses = misses(drive, disturbance, &[60, 100]);
                let misses: Vec<String> = misses.map(|miss| miss.text).collect();
                assert!(misses.is_empty(), "{variant}: {misses:#?}");
            }
        }
    }
}

/// The dead time delays the pulses, and a sample at the turning point shows more than the mean current while the EMF
/// takes it down: of this motor's 8.73 uH by 1.8 %.
#[test]
fn shunts_that_are_read_in_the_middle_of_late_pulses_show_the_mean_current() {
    let motor = "odrive-d6374-150kv";
    for variant in VARIANTS {
        let late = drive(motor, variant, true);
        let misses: Vec<Miss> = misses(&late, StatedDeadTime, &[25, 100]).collect();
        let texts: Vec<&str> = misses.iter().map(|miss| miss.text.as_str()).collect();
        assert!(texts.is_empty(), "{texts:#?}");
        let at_the_turning_point = "dead_time = \"1 us\"\nsampling_lead = \"0 us\"\n";
        let early = drive_with(motor, variant, Some(at_the_turning_point));
        let miss = miss(&early, StatedDeadTime, 100, [1.0, 1.0]).expect("a torque that is off");
        assert!((miss.torque - 98.1).abs() < 0.3, "{}", miss.text);
    }
}

/// One ADC reads the second phase later: the mean of both samples is in the middle of the pulses.
#[test]
fn shunts_that_are_read_in_turn_show_the_mean_current() {
    // That they are not read at once makes a ripple of its own.
    let off = |lines: &str| {
        let stated = format!("dead_time = \"1 us\"\n{lines}");
        let drive = drive_with("odrive-d6374-150kv", "pdcc", Some(&stated));
        let misses = misses(&drive, StatedDeadTime, &[25, 100]);
        misses.fold(0.0, |most: f64, miss| most.max((miss.torque - 100.0).abs()))
    };
    for conversion in ["400 ns", "1 us"] {
        let off = off(&format!("conversion_time = \"{conversion}\"\n"));
        assert!(off < 1.0, "{conversion}: {off} %");
    }
    let later = off("conversion_time = \"1 us\"\nsampling_lead = \"-500 ns\"\n");
    assert!(later > 1.2, "{later} %");
}

/// A PI regulator alone follows a reference that turns late: of 250 Hz and more it loses torque.
#[test]
fn pi_control_keeps_the_torque_where_the_reference_turns_fast() {
    for motor in ["mit-mini-cheetah", "odrive-d6374-150kv", "velineon-3500"] {
        for options in ["", ":delay=0", ":bandwidth=300Hz"] {
            let source = MotorSource::of_library(motor).expect("is in the library");
            let drive = prepare(&source, Some(&format!("pi-pwm{options}"))).expect("generates");
            let demand = drive.demand();
            let run = drive.measure_at(drive.spec.motor.rated_speed, demand);
            let mean = run.expect("runs").figures.mean_torque_nm;
            let torque = mean.map_or(0.0, |mean| 100.0 * mean / demand);
            assert!((torque - 100.0).abs() < 1.0, "{motor}{options}: {torque}");
        }
    }
}
