//! A second of closed loop on one core: the 660 W motor at 1500 rpm under rated torque, sampled
//! every 50 us.
//!
//! `cargo bench -p hexagen-lab`; a second of one controller should take less than 0.2 s, and one of
//! an interpreted controller at most twice as long as a compiled one.

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use hexagen_lab::closed_loop::{ClosedLoop, Delay};
use hexagen_lab::engine::{EngineKind, Model, MotorSource, Prepared, plant_of, prepare};
use hexagen_lab::plant::Plant;
use std::f64::consts::TAU;
use std::time::Duration;

/// Every kind of controller in its default variant, which is compiled in.
const CONTROLLERS: [&str; 5] = ["fcs-mpc", "p-pwm", "pdcc", "phcc", "pi-pwm"];

/// A variant that is not: the interpreter runs it.
const INTERPRETED: &str = "pdcc:emf=model,advance=2";

const RPM: f64 = 1500.0;

/// A loop from rest, and the periods of a second.
fn closed_loop(drive: &Prepared) -> (ClosedLoop<hexagen_lab::engine::Engine<'_>>, usize) {
    let params = plant_of(&drive.spec);
    let periods = (1.0 / params.t_s).round() as usize;
    let set_point = drive.set_point(drive.demand());
    let plant = Plant::new(params, 0.1, RPM * TAU / 60.0).expect("a plant of the library");
    let engine = drive.engine(Model::Fixed, set_point);
    (ClosedLoop::new(plant, engine, Delay::OnePeriod), periods)
}

fn second(criterion: &mut Criterion) {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    let mut group = criterion.benchmark_group("closed-loop second");
    group
        .sample_size(20)
        .measurement_time(Duration::from_secs(5));
    let compiled = CONTROLLERS.map(|controller| (controller, EngineKind::Compiled));
    let all = compiled
        .into_iter()
        .chain([(INTERPRETED, EngineKind::Interpreter)]);
    for (controller, engine) in all {
        let drive = prepare(&motor, Some(controller)).expect("generates");
        assert_eq!(drive.engine_kind(), engine, "{controller}");
        group.bench_function(controller, |bencher| {
            bencher.iter_batched(
                || closed_loop(&drive),
                |(mut closed, periods)| {
                    closed.run(periods, &mut ());
                    closed.plant().truth()
                },
                BatchSize::LargeInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, second);
criterion_main!(benches);
