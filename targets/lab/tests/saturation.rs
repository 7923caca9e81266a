//! A bus that sinks until the voltage ends the current, and comes back: what the observer has learnt meanwhile is soon
//! unlearnt.

mod bench;

use bench::Bench;
use hexagen_codegen::spec::Envelope;
use hexagen_lab::engine::{PlantOptions, Prepared, SelectedMotor};
use rayon::prelude::*;

/// Controllers with an observer.
const LAWS: [&str; 2] = ["pdcc", "pi-pwm"];

/// Speed over that up to which the bus drives the whole current.
const SPEED: f64 = 0.85;

/// Bus voltage over the nominal one while it has sunk: too little for the current at most speeds, more than the EMF.
const SUNK: f64 = 0.78;

/// Sectors for which it has sunk.
const SECTORS: usize = 60;

/// Sectors behind which, and over which, the torque is judged.
const SETTLED: usize = 12;

/// Greatest distance of the torque from the demand, before and afterwards.
const WITHIN: f64 = 0.01;

/// Greatest torque of a period in the settling, over the demand.
const PEAK: f64 = 1.5;

/// The bus of the plant alone, or with what the drive measures of it.
fn set_bus(bench: &mut Bench<'_>, share: f64) {
    let volts = share * bench.drive.spec.inverter.v_bus;
    let plant = bench.closed.plant_mut();
    plant.change(|params| params.v_bus = volts).expect("a bus");
    if let Some(counts) = bench.drive.bus_counts(volts) {
        bench.closed.controller().set_bus(counts);
    }
}

/// Mean and greatest torque of some sectors over the demanded one.
fn torque(bench: &mut Bench<'_>, sectors: usize, demand: f64) -> (f64, f64) {
    let periods = sectors * bench.sector;
    let (mut sum, mut peak) = (0.0, f64::MIN);
    for _ in 0..periods {
        bench.closed.run(1, &mut ());
        let share = bench.closed.plant().truth().mean_torque / demand;
        sum += share;
        peak = f64::max(peak, share);
    }
    (sum / periods as f64, peak)
}

/// What is wrong with a drive behind the return of the bus, and whether its torque had sunk at all.
fn recovery(drive: &Prepared, direction: f64) -> (bool, Option<String>) {
    let spec = &drive.spec;
    let demand = drive.demand();
    let lasts = Envelope::of(spec).speed(demand).expect("is held");
    let omega = (SPEED * lasts).min(spec.inverter.maximum_speed);
    let mut bench = Bench::at(drive, direction * omega / spec.motor.rated_speed);
    let signed = direction * demand;
    bench
        .closed
        .controller()
        .set_current(drive.set_point(signed).current);
    torque(&mut bench, SECTORS, signed);
    let (before, _) = torque(&mut bench, SETTLED, signed);
    set_bus(&mut bench, SUNK);
    let (sunk, _) = torque(&mut bench, SECTORS, signed);
    set_bus(&mut bench, 1.0);
    let (_, peak) = torque(&mut bench, SETTLED, signed);
    let (after, _) = torque(&mut bench, SETTLED, signed);
    let tripped = bench.closed.tripped();
    let is_right = tripped.is_none()
        && [before, after]
            .iter()
            .all(|share| (share - 1.0).abs() < WITHIN)
        && peak < PEAK;
    let text = format!(
        "{} {} {direction}: {before:.3}, sunk {sunk:.3}, then {after:.3} with a peak of {peak:.3}, {tripped:?}",
        drive.motor, drive.variant
    );
    println!("{text}");
    (sunk < 0.95, (!is_right).then_some(text))
}

#[test]
fn the_torque_returns_with_the_bus() {
    let library = SelectedMotor::library(&PlantOptions::default()).expect("is read");
    let all: Vec<(&SelectedMotor, &str)> = library
        .iter()
        .flat_map(|motor| LAWS.map(|law| (motor, law)))
        .collect();
    let found: Vec<_> = all
        .par_iter()
        .flat_map_iter(|&(motor, law)| {
            let drive = motor.prepare_for_torque(Some(law)).expect("generates");
            [1.0, -1.0].map(|direction| recovery(&drive, direction))
        })
        .collect();
    let sunk = found.iter().filter(|(sank, _)| *sank).count();
    assert!(sunk > found.len() / 2, "{sunk} of {} sank", found.len());
    let wrong: Vec<String> = found.into_iter().filter_map(|(_, wrong)| wrong).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
