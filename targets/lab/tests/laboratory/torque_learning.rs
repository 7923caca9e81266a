//! The torque constant, learnt at a set-point of 0: what it comes to, and the torque that `set_torque` then makes.

use hexagen_codegen::spec::BusSource;
use hexagen_lab::closed_loop::{ClosedLoop, Trace, figures_of_merit};
use hexagen_lab::engine::{
    Engine, Model, MotorSource, Prepared, library, plant_of, prepare, run_of,
};
use hexagen_lab::plant::{Plant, PlantParams};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Rotor speeds over the rated one.
const SHARES: [f64; 3] = [0.25, 0.5, -0.7];

/// Control periods of learning: eight time constants at a sixteenth of the bus, the least EMF.
const LEARNING: usize = 8_000;

/// Greatest error of the learnt constant, and of the torque that `set_torque` makes with it.
const MOST: f64 = 0.01;

/// R, L and k_b over the stated ones.
const PLANTS: [[f64; 3]; 6] = [
    [1.0, 1.0, 1.0],
    [1.0, 1.0, 0.8],
    [2.0, 1.0, 1.2],
    [0.5, 1.0, 0.8],
    [1.0, 1.3, 1.2],
    [1.0, 0.75, 0.8],
];

/// Every motor of the library with a measured bus, and edges that a timer of 2 MHz measures where Hall sensors tell
/// the angle; of a dead time the compare values are compensated.
fn drives(variant: &str) -> Vec<Prepared> {
    let drive = |mut source: MotorSource| {
        let plain = prepare(&source, Some("pdcc")).expect("generates").spec;
        let mut fields = String::new();
        if plain.inverter.bus == BusSource::Fixed {
            let range = 1.6 * plain.inverter.v_bus;
            fields += "v_bus = \"measured\"\nbus_adc_bits = 12\n";
            let _ = writeln!(fields, "bus_adc_range = \"{range:.3} V\"");
        }
        let has_halls = !source.text.contains("rotor = \"angle\"");
        if has_halls && !source.text.contains("hall_timer_clock") {
            fields += "hall_timer_clock = \"2 MHz\"\n";
        }
        let mut compensated = "";
        if plain.inverter.dead_time > 0.0 {
            compensated = ",dead_time_compensation=on";
        }
        let head = "[inverter]\n";
        source.text = source.text.replacen(head, &format!("{head}{fields}"), 1);
        let variant = format!("{variant}{compensated}");
        prepare(&source, Some(&variant)).unwrap_or_else(|why| panic!("{}: {why}", source.name))
    };
    library().iter().map(MotorSource::from).map(drive).collect()
}

/// The learnt word.
fn ratio(drive: &Prepared, engine: &mut Engine<'_>) -> f64 {
    let names = drive.state_names();
    let place = names.iter().position(|name| *name == "torque_ratio");
    let mut words = vec![0; names.len()];
    engine.subject().expect("a drive").state_words(&mut words);
    f64::from(words[place.expect("it learns")]) / 28_f64.exp2()
}

/// Learnt over true constant behind a spell without torque, and the torque over the one asked for then.
fn figures(drive: &Prepared, params: &PlantParams, [share, k_b]: [f64; 2]) -> [f64; 2] {
    let spec = &drive.spec;
    let omega = share * spec.motor.rated_speed;
    let turn = TAU / (omega.abs() * f64::from(params.pole_pairs) * params.t_s);
    let demand = share.signum() * 0.5 * drive.demand();
    let run = run_of(spec, omega, demand);
    let plant = Plant::new(params.clone(), 0.3, omega).expect("a plant");
    let engine = drive.engine(Model::Fixed, drive.set_point(0.0));
    let mut closed = ClosedLoop::new(plant, engine, run.delay);
    closed.run(LEARNING + (20.0 * turn) as usize, &mut ());
    let learnt = ratio(drive, closed.controller());
    let bits = (demand * 65_536.0).round() as i32;
    let subject = closed.controller().subject();
    subject.expect("a drive").set_torque(bits);
    closed.run((20.0 * turn) as usize + 200, &mut ());
    let periods = (6.0 * turn).round() as usize;
    let mut trace = Trace::of_run(closed.plant(), &run, periods);
    closed.run(periods, &mut trace);
    let held = ratio(drive, closed.controller());
    assert_eq!(closed.tripped(), None, "{} at {share}", drive.motor);
    assert!(
        (held / learnt - 1.0).abs() < 1e-4,
        "{}: {learnt}, under load {held}",
        drive.motor
    );
    let found = figures_of_merit(&trace, run.current, run.commutation_threshold);
    [
        1.0 / (learnt * k_b),
        found.mean_torque_nm.expect("turns") / demand,
    ]
}

/// Least EMF of a phase at which the constant is learnt, over the bus voltage.
const LEAST_EMF: f64 = 1.0 / 16.0;

/// Every motor with every plant and speed: what it learns, and the torque of which it is asked.
fn study(variant: &str, judge: impl Fn(&Prepared, [f64; 3], [f64; 2]) + Sync) {
    let lines: Vec<String> = drives(variant)
        .par_iter()
        .flat_map(|drive| {
            let runs = PLANTS
                .into_iter()
                .flat_map(|plant| SHARES.map(|share| (plant, share)));
            let of = |([r, l, k_b], share): ([f64; 3], f64)| {
                let plant = plant_of(&drive.spec).scaled(r, l, k_b);
                let found = figures(drive, &plant, [share, k_b]);
                let [constant, torque] = found;
                let motor = &drive.spec.motor;
                let emf = motor.emf_constant * motor.rated_speed * share.abs();
                if emf < LEAST_EMF * drive.spec.inverter.v_bus {
                    assert!(
                        (constant * k_b - 1.0).abs() < 1e-6,
                        "{}: learns",
                        drive.motor
                    );
                    return None;
                }
                let what = format!("{} R x {r}, L x {l}, k_b x {k_b} at {share}", drive.motor);
                println!("{what}: learnt over true constant {constant:.4}, torque {torque:.4}");
                assert!(
                    (constant - 1.0).abs() < MOST,
                    "{variant} {what}: {constant}"
                );
                judge(drive, [r, k_b, share], found);
                Some(what)
            };
            runs.filter_map(of).collect::<Vec<_>>()
        })
        .collect();
    assert!(lines.len() > 250, "{}", lines.len());
}

#[test]
fn the_learnt_constant_is_within_a_percent_and_makes_the_torque_asked_for() {
    study(
        "pdcc:torque_learning=on",
        |drive, [r, k_b, share], [_, torque]| {
            // A resistance of twice the stated one beside another constant costs the current loop more than that.
            let most = if r > 1.0 { 2.0 * MOST } else { MOST };
            let what = format!("{} R x {r}, k_b x {k_b} at {share}", drive.motor);
            assert!((torque - 1.0).abs() < most, "{what}: {torque}");
        },
    );
}

#[test]
#[ignore = "takes minutes: `cargo xtask nightly` runs it"]
fn a_pi_loop_learns_the_same() {
    study("pi-pwm:torque_learning=on", |_, _, _| {});
}

#[test]
fn nothing_is_learnt_under_load_and_a_reset_forgets() {
    for drive in &drives("pdcc:torque_learning=on") {
        let spec = &drive.spec;
        let omega = 0.6 * spec.motor.rated_speed;
        let demand = 0.8 * drive.demand();
        let plant = Plant::new(plant_of(spec).scaled(2.0, 1.0, 0.8), 0.3, omega).expect("a plant");
        let engine = drive.engine(Model::Fixed, drive.set_point(demand));
        let mut closed = ClosedLoop::new(plant, engine, run_of(spec, omega, demand).delay);
        closed.run(LEARNING, &mut ());
        let before = ratio(drive, closed.controller());
        assert!((before - 1.0).abs() < MOST, "{}: {before}", drive.motor);
        closed.controller().set_current(0.0);
        closed.run(LEARNING, &mut ());
        let learnt = ratio(drive, closed.controller());
        assert!(
            (learnt * 0.8 - 1.0).abs() < MOST,
            "{}: {learnt}",
            drive.motor
        );
        closed.controller().subject().expect("a drive").reset();
        let forgotten = ratio(drive, closed.controller());
        assert!(
            (forgotten - 1.0).abs() < f64::EPSILON,
            "{}: {forgotten}",
            drive.motor
        );
    }
}

#[test]
fn nothing_is_learnt_with_an_old_bus_voltage() {
    let mut moved = 0;
    for drive in &drives("pdcc:torque_learning=on") {
        let spec = &drive.spec;
        let omega = 0.6 * spec.motor.rated_speed;
        let plant = Plant::new(plant_of(spec).scaled(1.0, 1.0, 0.8), 0.3, omega).expect("a plant");
        let engine = drive.engine(Model::Fixed, drive.set_point(0.0));
        let mut closed = ClosedLoop::new(plant, engine, run_of(spec, omega, 0.0).delay);
        // The voltage is told once, at the begin.
        closed.run(1, &mut ());
        closed.controller().stop_telling_bus();
        let fresh = (0.1 / spec.inverter.t_s).ceil() as usize;
        closed.run(fresh + 2, &mut ());
        let old = ratio(drive, closed.controller());
        closed.run(LEARNING, &mut ());
        let held = ratio(drive, closed.controller());
        assert!((held - old).abs() < f64::EPSILON, "{}", drive.motor);
        let counts = drive.bus_counts(spec.inverter.v_bus);
        closed.controller().set_bus(counts.expect("a measured bus"));
        closed.run(LEARNING, &mut ());
        let learnt = ratio(drive, closed.controller());
        moved += u32::from(learnt > old);
    }
    assert!(moved > 5, "{moved}");
}

#[test]
fn nothing_is_learnt_where_the_emf_exceeds_the_bus() {
    let drives = drives("pdcc:torque_learning=on");
    let drive = drives
        .iter()
        .find(|drive| drive.motor == "trivedi-keshri-660w");
    let drive = drive.expect("is in the library");
    let spec = &drive.spec;
    // The EMF drives a current then, whatever is asked: R of twice the stated one would show in it.
    let omega = 1.25 * spec.inverter.v_bus / (2.0 * spec.motor.emf_constant);
    let plant = Plant::new(plant_of(spec).scaled(2.0, 1.0, 1.0), 0.3, omega).expect("a plant");
    let engine = drive.engine(Model::Fixed, drive.set_point(0.0));
    let mut closed = ClosedLoop::new(plant, engine, run_of(spec, omega, 0.0).delay);
    closed.run(LEARNING, &mut ());
    let ratio = ratio(drive, closed.controller());
    assert!((ratio - 1.0).abs() < MOST, "{ratio}");
}
