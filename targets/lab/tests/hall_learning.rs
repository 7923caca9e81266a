//! Hall sensors out of place, learnt: the ripple of torque behind 20 electrical turns.

use hexagen_lab::closed_loop::{ClosedLoop, Trace, figures_of_merit};
use hexagen_lab::engine::{Model, MotorSource, Prepared, library, plant_of, prepare, run_of};
use hexagen_lab::plant::{Plant, PlantParams};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Displacements of the sensors whose edges begin sectors 1 and 4, 2 and 5, 3 and 6, degrees: one or three.
const PLACES: [[f64; 3]; 3] = [[5.0, 0.0, 0.0], [5.0, -5.0, 0.0], [-1.0, -4.0, -5.0]];

/// Electrical turns of learning.
const TURNS: f64 = 20.0;

/// Electrical turns that are measured behind them.
const MEASURED: f64 = 6.0;

/// The plant with sensors out of place.
fn displaced(drive: &Prepared, places: [f64; 3]) -> PlantParams {
    let mut params = plant_of(&drive.spec);
    for (edge, degrees) in params.hall_edges_deg.iter_mut().enumerate() {
        *degrees += places[edge % 3];
    }
    params
}

/// Mean torque and its ripple at a share of the rated speed, in percent of the demand.
fn figures(drive: &Prepared, params: PlantParams, share: f64, spell: bool) -> [f64; 2] {
    let omega = share * drive.spec.motor.rated_speed;
    let turn = TAU / (omega.abs() * f64::from(params.pole_pairs) * params.t_s);
    let demand = share.signum() * 0.8 * drive.demand();
    let run = run_of(&drive.spec, omega, demand);
    let plant = Plant::new(params, 0.3, omega).expect("a plant");
    let light = if spell { 0.05 } else { 1.0 };
    let engine = drive.engine(Model::Fixed, drive.set_point(light * demand));
    let mut closed = ClosedLoop::new(plant, engine, run.delay);
    if spell {
        closed.run((TURNS * turn) as usize, &mut ());
        closed.controller().set_current(drive.set_point(demand).current);
    }
    closed.run((TURNS * turn) as usize, &mut ());
    let mut trace = Trace::of_run(closed.plant(), &run, (MEASURED * turn) as usize);
    closed.run((MEASURED * turn) as usize, &mut trace);
    assert_eq!(closed.tripped(), None, "{} at {share}", drive.motor);
    let found = figures_of_merit(&trace, run.current, run.commutation_threshold);
    let mean = found.mean_torque_nm.expect("turns") / demand.abs();
    [
        100.0 * mean.abs(),
        found.ripple_pp_pct.expect("turns"),
    ]
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

#[test]
fn sensors_out_of_place_ripple_little_more_than_others_behind_twenty_turns() {
    let lines: Vec<String> = motors()
        .par_iter()
        .flat_map(|source| {
            let prepared = |options: &str| match prepare(source, Some(options)) {
                Ok(drive) => drive,
                Err(why) => panic!("{}: {why}", source.name),
            };
            let [plain, learning] =
                ["pdcc", "pdcc:hall_learning=on"].map(prepared);
            let mut lines = vec![];
            for share in [0.25, 0.6, -1.0] {
                let [_, still] = figures(&plain, plant_of(&plain.spec), share, false);
                let [_, own] = figures(&learning, plant_of(&plain.spec), share, true);
                lines.push(format!("{} {share}: {still:.2} {own:.2}", source.name));
                for places in PLACES {
                    let [_, unlearnt] = figures(&plain, displaced(&plain, places), share, false);
                    let [mean, learnt] = figures(&learning, displaced(&plain, places), share, false);
                    let [after, spelt] = figures(&learning, displaced(&plain, places), share, true);
                    lines.push(format!("    {places:?}: unlearnt {unlearnt:.2} learnt {learnt:.2} mean {mean:.2}, after a spell {spelt:.2} mean {after:.2}"));
                }
            }
            lines
        })
        .collect();
    for line in lines {
        println!("{line}");
    }
}
