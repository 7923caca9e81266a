//! What a person gets who states a motor and nothing else: the demanded torque with little ripple.

use crate::encoder::with_encoder;
use crate::exact::least_ripple;
use hexagen_codegen::spec::{Envelope, RotorSensing, Spec};
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor, prepare};
use hexagen_lab::motors::{FreeStart, Limit, RatedPoint, SPEEDS, further, greatest_ripple};
use hexagen_tests::random_motor::random_drives;
use rayon::prelude::*;
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// A point at which a default drive is not right: motor, speed in percent, and why.
type Limited = (&'static str, u32, Limit);

/// Points of the library at which bus or control period limits the drive. Each run begins at the demanded torque.
const LIBRARY: [Limited; 2] = [
    ("br2804-1700kv", 100, Limit::ControlPeriod),
    ("velineon-3500", 100, Limit::ControlPeriod),
];

/// The same of the motors set aside.
const SET_ASIDE: [Limited; 2] = [
    ("maxon-ec-4pole-30", 100, Limit::ControlPeriod),
    ("maxon-ec-max-40", 100, Limit::BusVoltage),
];

/// Speed up to which the bus drives the whole current, percent of the rated one.
pub fn envelope(drive: &Prepared) -> f64 {
    let lasts = Envelope::of(&drive.spec).speed(drive.demand());
    100.0 * lasts.expect("a speed") / drive.spec.motor.rated_speed
}

/// Whether a default drive can be right: it has an edge timer or an angle sensor, and its period is short enough for the
/// motor.
pub fn can_be_right(spec: &Spec) -> bool {
    spec.inverter.rotor_sensing != RotorSensing::SampledHalls && spec.long_period().is_none()
}

/// Whether a limit follows from the data of motor and inverter, whatever the control.
fn is_physical(drive: &Prepared, speed: u32, limit: Limit) -> bool {
    match limit {
        Limit::BusVoltage => envelope(drive) < f64::from(speed),
        Limit::ControlPeriod => {
            let least = least_ripple(drive, speed).unwrap_or_default();
            // Or a period is as long as the current's rise.
            least > greatest_ripple(&drive.spec) || !can_be_right(&drive.spec)
        }
        Limit::Trip | Limit::Start => false,
    }
}

/// The points of a drive: speed in percent, negative backward, and 1 for motoring, -1 for braking.
struct Points<'d> {
    drive: &'d Prepared,
    all: Vec<(RatedPoint, i32, i32)>,
}

impl<'d> Points<'d> {
    fn of(drive: &'d Prepared) -> Self {
        let all = RatedPoint::of_quadrants(drive).expect("runs");
        Self { drive, all }
    }

    /// Those at which the drive is not right.
    fn wrong(&self) -> Vec<(RatedPoint, i32, i32)> {
        let most = greatest_ripple(&self.drive.spec);
        let all = self.all.iter().copied();
        all.filter(|(point, ..)| !point.is_right(most)).collect()
    }

    /// What contradicts the list of limited points.
    fn unexpected(&self, limited: &[Limited]) -> Vec<String> {
        let name = &self.drive.motor;
        let (wrong, mut unexpected) = (self.wrong(), Vec::new());
        let own: Vec<_> = limited.iter().filter(|(of, ..)| of == name).collect();
        for &&(_, at, limit) in &own {
            if !wrong.iter().any(|(point, ..)| point.speed_pct == at) {
                unexpected.push(format!("{name} is right at {at} % now"));
            }
            if !is_physical(self.drive, at, limit) {
                unexpected.push(format!("{name} at {at} %: not for {limit:?}"));
            }
        }
        let is_known = |point: &RatedPoint| {
            let here = (point.speed_pct, point.limit());
            own.iter().any(|&&(_, at, limit)| (at, limit) == here)
        };
        let unknown = wrong.iter().filter(|(point, ..)| !is_known(point));
        let texts =
            unknown.map(|(point, speed, mode)| format!("{name} {speed} % {mode}: {point:?}"));
        unexpected.extend(texts);
        unexpected
    }

    /// One line: at each speed the torque furthest from the demand and the greatest ripple, percent.
    fn line(&self) -> String {
        let (name, spec) = (&self.drive.motor, &self.drive.spec);
        let (degrees, envelope) = (spec.degrees_per_period(), envelope(self.drive));
        let mut line = format!("{name:22} {degrees:5.2} deg, bus up to {envelope:3.0} %");
        let wrong = self.wrong();
        for speed in SPEEDS {
            let of_speed = |points: &[(RatedPoint, i32, i32)]| {
                let points = points.iter().map(|(point, ..)| *point);
                let here = points.filter(|point| point.speed_pct == speed);
                here.collect::<Vec<_>>()
            };
            let here = of_speed(&self.all);
            let torques = here.iter().filter_map(|point| point.torque_pct);
            let torque = torques.reduce(|one, other| further((one, other)));
            let ripples = here.iter().filter_map(|point| point.ripple_pct);
            let (torque, ripple) = (torque.unwrap_or(f64::NAN), ripples.fold(0.0, f64::max));
            let _ = write!(line, "; {speed} %: {torque:.2} with {ripple:.2}");
            if let Some(point) = of_speed(&wrong).first() {
                let _ = write!(line, " ({:?})", point.limit());
            }
        }
        line
    }
}

/// Failed starts: of the bare rotor, where its inertia is known, and with a load.
fn failed_starts(drive: &Prepared) -> Vec<String> {
    let starts = FreeStart::all(drive).expect("runs").into_iter();
    let failed = starts.filter(|(start, _)| start.seconds.is_none());
    let failed = failed.map(|(start, [inertia, angle, sign])| {
        format!(
            "{} {inertia:e} kg m2 {angle:.2} {sign}: {start:?}",
            drive.motor
        )
    });
    failed.collect()
}

/// Checks points and starts of all drives, and prints a line of each.
fn check(drives: &[Prepared], limited: &[Limited]) {
    let (lines, unexpected): (Vec<_>, Vec<_>) = drives
        .par_iter()
        .map(|drive| {
            let points = Points::of(drive);
            let mut unexpected = points.unexpected(limited);
            unexpected.extend(failed_starts(drive));
            (points.line(), unexpected)
        })
        .unzip();
    println!("{}", lines.join("\n"));
    let unexpected = unexpected.concat();
    assert!(unexpected.is_empty(), "{unexpected:#?}");
}

fn prepared(motors: &[SelectedMotor]) -> Vec<Prepared> {
    let drive = |motor: &SelectedMotor| motor.prepare(Some("pdcc")).expect("generates");
    motors.iter().map(drive).collect()
}

#[test]
fn every_library_motor_is_right_by_default() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    check(&prepared(&motors), &LIBRARY);
}

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn every_library_motor_is_right_with_an_encoder() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let drives = prepared(&motors).into_iter().map(|drive| {
        let source = with_encoder(&drive.motor, drive.spec.motor.pole_pairs);
        prepare(&source, Some("pdcc")).expect("generates")
    });
    check(&drives.collect::<Vec<_>>(), &LIBRARY);
}

/// What counts as a limit of the data is one: exact control ripples no more than the drive where that is right.
#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn exact_control_ripples_no_more_than_a_drive() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let found = prepared(&motors).into_iter().flat_map(|drive| {
        let points = Points::of(&drive).all;
        let forward = points
            .iter()
            .filter(|(_, speed, mode)| *speed > 0 && *mode > 0);
        let rougher = forward.filter_map(|(point, speed, _)| {
            let least = least_ripple(&drive, *speed as u32)?;
            let ripple = point.ripple_pct?;
            println!("{} {speed} %: {least:.2} and {ripple:.2}", drive.motor);
            (least > ripple + 0.2)
                .then(|| format!("{} {speed} %: {least} and {ripple}", drive.motor))
        });
        rougher.collect::<Vec<_>>()
    });
    let found: Vec<String> = found.collect();
    assert!(found.is_empty(), "{found:#?}");
}

/// A count of their timer moves the current of these by 0.5 to 1.5 % of the rated one.
const COARSE_TIMERS: [&str; 3] = ["br2804-1700kv", "tekin-redline-4600kv", "velineon-3500"];

/// Unpredicted, the rounding of two commands adds up in the current: predicted, that of one is left.
#[test]
fn rounding_that_is_predicted_ripples_less() {
    let plant = PlantOptions::default();
    let parts: Vec<(&str, f64)> = COARSE_TIMERS
        .into_par_iter()
        .map(|name| {
            let motor = SelectedMotor::find(name, &plant).expect("is in the library");
            let [off, on] = ["off", "on"].map(|state| {
                let variant = format!("pdcc:rounding_prediction={state}");
                let drive = motor.prepare(Some(&variant)).expect("generates");
                let point = RatedPoint::measure(&drive, 25, 1.0).expect("runs");
                point.ripple_pct.expect("runs")
            });
            (name, on / off)
        })
        .collect();
    println!("{parts:?}");
    for (motor, part) in parts {
        assert!((0.4..0.8).contains(&part), "{motor}: {part}");
    }
}

/// Motors of other makers, on which nothing is tuned.
pub fn set_aside() -> Vec<SelectedMotor> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/set_aside");
    let files = fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    paths.sort();
    let plant = PlantOptions::default();
    let motors: Vec<_> = paths
        .iter()
        .map(|path| SelectedMotor::find(&path.to_string_lossy(), &plant).expect("is a motor"))
        .collect();
    assert!(motors.len() >= 10, "{paths:?}");
    motors
}

#[test]
fn every_motor_set_aside_is_right_by_default() {
    check(&prepared(&set_aside()), &SET_ASIDE);
}

/// Random motors, in a push and in the nightly run.
const DRAWN: [usize; 2] = [6, 200];

/// Draws whose starts are tried, or as many as there are.
const STARTED: usize = 20;

/// Nearly all points are right but those that bus or control period limits by the data of motor and inverter: of the
/// nightly run's 3200 points 3 more are not, of two motors (3.1 and 7.5 % of ripple for 3 and 7). No start fails.
#[test]
fn random_motors_are_right_by_default() {
    // Motors with an edge timer, and periods short enough for them.
    let drawn = random_drives(0, "pdcc", DRAWN, |drive| can_be_right(&drive.spec));
    let wrong: Vec<(String, RatedPoint)> = drawn
        .par_iter()
        .flat_map_iter(|drive| {
            let degrees = drive.spec.degrees_per_period();
            let wrong = Points::of(drive).wrong().into_iter();
            let unexplained =
                wrong.filter(|(point, ..)| !is_physical(drive, point.speed_pct, point.limit()));
            unexplained.map(move |(point, speed, mode)| {
                let at = format!("{} {degrees:.1} deg {speed} % {mode}", drive.motor);
                (at, point)
            })
        })
        .collect();
    println!("{} of {} points: {wrong:#?}", wrong.len(), 16 * drawn.len());
    let trips = wrong.iter().filter(|(_, point)| point.tripped.is_some());
    let tripping: Vec<_> = trips.map(|(at, ..)| at).collect();
    assert!(tripping.is_empty(), "{tripping:?}");
    assert!(
        400 * wrong.len() < 16 * drawn.len(),
        "{}: {wrong:#?}",
        wrong.len()
    );
    let started = drawn.par_iter().take(STARTED);
    let failed: Vec<String> = started.flat_map_iter(failed_starts).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}
