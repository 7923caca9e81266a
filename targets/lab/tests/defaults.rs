//! What a person gets who states a motor and nothing else: the demanded torque with little ripple.

use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor};
use hexagen_lab::motors::{
    Limit, RatedPoint, SPEEDS, can_be_right, degrees_per_period, greatest_ripple,
};
use hexagen_tests::random_motor::random_drives;
use rayon::prelude::*;

/// Points at which a default drive is not right: motor, speed in percent. Control begins at the
/// demanded torque, whatever the speed.
const LIMITED: [(&str, u32); 3] = [
    // The bus is too low for this motor's EMF.
    ("anaheim-bly341s", 100),
    // A period is as long as the current's rise.
    ("br2804-1700kv", 100),
    ("velineon-3500", 100),
];

/// The points at which a drive is not right: speed in percent, negative backward, and 1 for
/// motoring, -1 for braking.
fn wrong(drive: &Prepared) -> Vec<(RatedPoint, i32, i32)> {
    let most = greatest_ripple(&drive.spec);
    let mut wrong = Vec::new();
    for speed in SPEEDS.map(|share| share as i32) {
        for (turn, mode) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
            let sign = f64::from(turn * mode);
            let point = RatedPoint::measure(drive, turn * speed, sign).expect("runs");
            if !point.is_right(most) {
                wrong.push((point, turn * speed, mode));
            }
        }
    }
    wrong
}

#[test]
fn every_library_motor_is_right_by_default() {
    let motors = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let drives: Vec<(&str, Prepared)> = motors
        .iter()
        .map(|motor| {
            let drive = motor.prepare(Some("pdcc")).expect("generates");
            (&motor.source.name[..], drive)
        })
        .collect();
    let unexpected: Vec<String> = drives
        .par_iter()
        .flat_map_iter(|(name, drive)| {
            let found = wrong(drive);
            let limits = |speed: u32| LIMITED.contains(&(*name, speed));
            for (_, at) in LIMITED.iter().filter(|(limited, ..)| limited == name) {
                let is_found = found.iter().any(|(point, ..)| point.speed_pct == *at);
                assert!(is_found, "{name} is right at {at} % now");
            }
            found
                .into_iter()
                .filter(|(point, ..)| !limits(point.speed_pct))
                .map(|(point, speed, mode)| format!("{name} {speed} % {mode}: {point:?}"))
                .collect::<Vec<_>>()
        })
        .collect();
    assert!(unexpected.is_empty(), "{unexpected:#?}");
}

/// Random motors, in a push and in the nightly run.
const DRAWN: [usize; 2] = [20, 200];

/// Nearly all points are right that do not end at the bus.
#[test]
fn random_motors_are_right_by_default() {
    // Motors with an edge timer, and periods short enough for them.
    let drawn = random_drives(0, "pdcc", DRAWN, |drive| can_be_right(&drive.spec));
    let points = 16 * drawn.len();
    let wrong: Vec<(String, RatedPoint)> = drawn
        .par_iter()
        .flat_map_iter(|drive| {
            let degrees = degrees_per_period(&drive.spec);
            wrong(drive).into_iter().map(move |(point, speed, mode)| {
                let at = format!("{} {degrees:.1} deg {speed} % {mode}", drive.motor);
                (at, point)
            })
        })
        .collect();
    let trips = wrong.iter().filter(|(_, point)| point.tripped.is_some());
    let tripping: Vec<_> = trips.map(|(at, ..)| at).collect();
    assert!(tripping.is_empty(), "{tripping:?}");
    let at_bus = |point: &RatedPoint| point.limit() == Limit::BusVoltage;
    let (known, unknown): (Vec<_>, Vec<_>) = wrong.iter().partition(|(_, point)| at_bus(point));
    println!("{} of {points} points: {known:#?}", known.len());
    assert!(20 * known.len() < points, "{} of {points}", known.len());
    assert!(
        30 * unknown.len() < points,
        "{} of {points}: {unknown:#?}",
        unknown.len()
    );
}
