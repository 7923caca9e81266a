//! Two disturbances at once: which default drives of the library trip or oscillate.

use hexagen_lab::engine::{PlantOptions, SelectedMotor};
use hexagen_lab::robustness::{Cell, Outcome, robustness};
use rayon::prelude::*;

/// Drives whose modulator and observer correct a wrong plant.
const VARIANTS: [&str; 2] = ["pdcc", "pi-pwm"];

/// A change of the plant of a bus voltage.
type Change = fn(&mut PlantOptions, f64);

/// The first disturbance of a pair; the second is each one of the robustness sheet in turn.
const FIRST: [(&str, Change); 10] = [
    ("R -30 %", |plant, _| plant.scale_r = Some(0.7)),
    ("R +30 %", |plant, _| plant.scale_r = Some(1.3)),
    ("L -30 %", |plant, _| plant.scale_l = Some(0.7)),
    ("L +30 %", |plant, _| plant.scale_l = Some(1.3)),
    ("k_b -30 %", |plant, _| plant.scale_kb = Some(0.7)),
    ("k_b +30 %", |plant, _| plant.scale_kb = Some(1.3)),
    ("bus -10 %", |plant, bus| plant.v_bus = Some(0.9 * bus)),
    ("dead time 1 us", |plant, _| plant.dead_time = Some(1e-6)),
    ("Hall +5 deg", |plant, _| plant.hall_error = Some([5.0; 3])),
    ("ADC noise", |plant, _| plant.adc_noise = Some(1.0)),
];

/// Motors, and a disturbance beside which another one makes them trip or oscillate. The dead time is one that nobody
/// stated; sensors apart trouble motors whose control period is as long as the rise of their current.
const BREAKING: [(&str, &str); 7] = [
    ("br2804-1700kv", "dead time"),
    ("hoverboard-hub", "dead time"),
    ("odrive-d6374-150kv", "dead time"),
    ("tekin-redline-4600kv", "Hall +5, -5, 0 deg"),
    ("tekin-redline-4600kv", "dead time"),
    ("velineon-3500", "Hall +5, -5, 0 deg"),
    ("velineon-3500", "dead time"),
];

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn pairs_of_disturbances_diverge_with_a_dead_time_or_sensors_apart_alone() {
    let library = SelectedMotor::library(&PlantOptions::default()).expect("the library");
    let motors: Vec<(String, f64)> = library
        .iter()
        .map(|motor| {
            let drive = motor.prepare(None).expect("generates");
            (motor.source.name.clone(), drive.spec.inverter.v_bus)
        })
        .collect();
    let variants = &VARIANTS.map(str::to_owned);
    let pairs = motors.par_iter().flat_map_iter(|(motor, bus)| {
        FIRST.into_iter().flat_map(move |(first, change)| {
            let mut plant = PlantOptions::default();
            change(&mut plant, *bus);
            let sheet = robustness(motor, variants, &plant, &()).expect("runs");
            let columns = sheet.controllers.into_iter();
            let cells = columns.flat_map(|column| {
                let controller = column.controller;
                // The same one twice is none of a sheet's size.
                let kind = |name: &str| name.split(' ').next().map(str::to_owned);
                let others = column.cells.into_iter();
                let others = others.filter(|cell| kind(&cell.disturbance) != kind(first));
                let of = |cell: Cell| {
                    let outcome = cell.figures.expect("is possible").outcome;
                    let (second, rpm) = (cell.disturbance, cell.rpm);
                    let what = format!("{motor} {controller}: {first} and {second}, {rpm:.0} rpm");
                    (what, outcome)
                };
                others.map(of).collect::<Vec<_>>()
            });
            cells.collect::<Vec<_>>()
        })
    });
    let pairs: Vec<(String, Outcome)> = pairs.collect();
    println!("{} runs", pairs.len());
    assert!(pairs.len() > 8000, "{} runs", pairs.len());
    let diverging = pairs
        .into_iter()
        .filter(|(_, outcome)| *outcome != Outcome::Runs);
    let diverging = diverging.map(|(what, outcome)| format!("{what}: {}", outcome.name()));
    let diverging: Vec<String> = diverging.collect();
    println!("{} of them diverge: {diverging:#?}", diverging.len());
    let is_known = |what: &&String| {
        let mut known = BREAKING.iter();
        known.any(|(motor, disturbance)| what.starts_with(motor) && what.contains(disturbance))
    };
    let (known, new): (Vec<_>, Vec<_>) = diverging.iter().partition(is_known);
    assert!(new.is_empty(), "{new:#?}");
    for (motor, disturbance) in BREAKING {
        let of = |what: &&&String| what.starts_with(motor) && what.contains(disturbance);
        assert!(
            known.iter().any(|what| of(&what)),
            "{motor} bears {disturbance}"
        );
    }
}
