//! Hall sensors out of place, learnt: the ripple of torque behind 20 electrical turns.

use hexagen_lab::closed_loop::{ClosedLoop, Trace, figures_of_merit};
use hexagen_lab::engine::{Model, MotorSource, Prepared, library, plant_of, prepare, run_of};
use hexagen_lab::plant::{Plant, PlantParams};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Displacements of the sensors whose edges begin sectors 1 and 4, 2 and 5, 3 and 6, degrees: one; two in
/// opposite directions; two and three the same way, which only the EMF tells.
const PLACES: [[f64; 3]; 4] = [
    [5.0, 0.0, 0.0],
    [5.0, -5.0, 0.0],
    [5.0, 5.0, 0.0],
    [-1.0, -4.0, -5.0],
];

/// Electrical turns of learning.
const TURNS: f64 = 20.0;

/// Electrical turns that are measured behind them.
const MEASURED: f64 = 6.0;

/// What goes before the demand.
#[derive(Clone, Copy, PartialEq)]
enum Spell {
    None,
    /// As many turns at a twentieth of it, in which the EMF tells the angle.
    Light,
}

/// The plant with sensors out of place.
fn displaced(drive: &Prepared, places: [f64; 3]) -> PlantParams {
    with_edges(plant_of(&drive.spec), places)
}

fn with_edges(mut params: PlantParams, places: [f64; 3]) -> PlantParams {
    for (edge, degrees) in params.hall_edges_deg.iter_mut().enumerate() {
        *degrees += places[edge % 3];
    }
    params
}

/// Mean torque and its ripple at a share of the rated speed, in percent of the demand.
fn figures(drive: &Prepared, params: PlantParams, share: f64, spell: Spell) -> [f64; 2] {
    let omega = share * drive.spec.motor.rated_speed;
    let turn = TAU / (omega.abs() * f64::from(params.pole_pairs) * params.t_s);
    let demand = share.signum() * 0.8 * drive.demand();
    let run = run_of(&drive.spec, omega, demand);
    let plant = Plant::new(params, 0.3, omega).expect("a plant");
    let light = if spell == Spell::Light { 0.05 } else { 1.0 };
    let engine = drive.engine(Model::Fixed, drive.set_point(light * demand));
    let mut closed = ClosedLoop::new(plant, engine, run.delay);
    if spell == Spell::Light {
        closed.run((TURNS * turn) as usize, &mut ());
        closed
            .controller()
            .set_current(drive.set_point(demand).current);
    }
    closed.run((TURNS * turn) as usize, &mut ());
    let mut trace = Trace::of_run(closed.plant(), &run, (MEASURED * turn) as usize);
    closed.run((MEASURED * turn) as usize, &mut trace);
    assert_eq!(closed.tripped(), None, "{} at {share}", drive.motor);
    let found = figures_of_merit(&trace, run.current, run.commutation_threshold);
    let mean = found.mean_torque_nm.expect("turns") / demand.abs();
    [100.0 * mean.abs(), found.ripple_pp_pct.expect("turns")]
}

/// The motors of the library with Hall sensors, and edges that a timer of 2 MHz measures.
fn motors() -> Vec<MotorSource> {
    library()
        .iter()
        .map(MotorSource::from)
        .filter(|source| !source.text.contains("rotor = \"angle\""))
        .map(|mut source| {
            if !source.text.contains("hall_timer_clock") {
                let clock = "[inverter]\nhall_timer_clock = \"2 MHz\"\n";
                source.text = source.text.replacen("[inverter]\n", clock, 1);
            }
            source
        })
        .collect()
}

/// Rotor speeds over the rated one.
const SHARES: [f64; 3] = [0.25, 0.6, -1.0];

/// Ripple that sensors out of place may have beyond that of others, points of the demand.
const BEYOND: f64 = 1.5;

#[test]
fn sensors_out_of_place_ripple_little_more_than_others_behind_twenty_turns() {
    let lines: Vec<String> = motors()
        .par_iter()
        .flat_map(|source| {
            let prepared = |options: &str| match prepare(source, Some(options)) {
                Ok(drive) => drive,
                Err(why) => panic!("{}: {why}", source.name),
            };
            let [plain, learning] = ["pdcc", "pdcc:hall_learning=on"].map(prepared);
            let of = |drive, places, spell| move |share| figures(drive, displaced(drive, places), share, spell);
            let mut lines = vec![];
            for share in SHARES {
                let [full, sound] = of(&plain, [0.0; 3], Spell::None)(share);
                lines.push(format!("{} at {share}: {sound:.2} %", source.name));
                for (k, places) in PLACES.into_iter().enumerate() {
                    let [_, unlearnt] = of(&plain, places, Spell::None)(share);
                    let [_, apart] = of(&learning, places, Spell::None)(share);
                    let [mean, learnt] = of(&learning, places, Spell::Light)(share);
                    let found = format!(
                        "{places:?}: {unlearnt:.2} % unlearnt, {apart:.2} % at full current, {learnt:.2} % behind a spell of little"
                    );
                    assert!(learnt < sound + BEYOND, "{} at {share}: {found}", source.name);
                    let is_found = k >= 2 || apart < sound + BEYOND;
                    assert!(is_found, "{} at {share}: {found}", source.name);
                    assert!((mean - full).abs() < 1.0, "{} at {share}: {mean}", source.name);
                    lines.push(format!("    {found}"));
                }
            }
            lines
        })
        .collect();
    for line in lines {
        println!("{line}");
    }
}

#[test]
fn wrong_data_of_the_motor_do_not_turn_what_is_learnt() {
    for source in &motors() {
        let learning = prepare(source, Some("pdcc:hall_learning=on")).expect("generates");
        for (r, l, k) in [
            (2.0, 1.0, 1.0),
            (1.0, 1.3, 1.0),
            (1.0, 0.75, 1.0),
            (1.0, 1.0, 0.8),
        ] {
            for places in [[0.0; 3], PLACES[3]] {
                let plant = plant_of(&learning.spec).scaled(r, l, k);
                let displaced = with_edges(plant.clone(), places);
                let plain = figures(&learning, displaced, 0.6, Spell::Light);
                let sound = figures(&learning, plant, 0.6, Spell::None);
                println!(
                    "{} R x {r}, L x {l}, k x {k}, {places:?}: {plain:.2?} {sound:.2?}",
                    source.name
                );
                assert!(plain[1] < sound[1] + BEYOND, "{}: {plain:?}", source.name);
            }
        }
    }
}
