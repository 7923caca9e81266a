//! A bus that sinks until the voltage ends the current, and comes back: what the observer has learnt meanwhile is soon
//! unlearnt.

use crate::bench::Bench;
use hexagen_codegen::spec::Envelope;
use hexagen_lab::engine::{MotorSource, Prepared, library, prepare};
use rayon::prelude::*;

/// Controllers with an observer.
const LAWS: [&str; 2] = ["pdcc", "pi-pwm"];

/// Speed over that up to which the bus drives the whole current.
const SPEED: f64 = 0.85;

/// Bus voltage over the nominal one while it has sunk: too little for the current at most speeds, more than the EMF.
const SUNK: f64 = 0.78;

/// Time in which it sinks, and comes back, second: a step would move the current of a motor with little inductance by
/// more than its rated one within two periods, whatever is computed.
const RAMP: f64 = 2e-3;

/// Sectors for which it has sunk.
const SECTORS: usize = 60;

/// Sectors behind which, and over which, the torque is judged, and the fewest control periods of that: the observer's
/// own time.
const SETTLED: usize = 12;
const FEWEST: usize = 200;

/// Greatest distance of the torque from the demand, before and afterwards.
const WITHIN: f64 = 0.01;

/// Torque over the demand below which a sunk bus has ended the current.
const CUT: f64 = 0.98;

/// Greatest torque of a period on the way back, over the demand; and that of motors whose inductance lets 1 % of the bus
/// move the current by 10 % of the rated one and more within two periods.
const PEAK: f64 = 1.5;
const PEAK_OF_LITTLE: f64 = 2.2;
const OF_LITTLE: [&str; 3] = ["br2804-1700kv", "tekin-redline-4600kv", "velineon-3500"];

/// Moves the bus of the plant, and what a drive with a measured bus sees of it, from a share of the nominal voltage to another
/// one; the greatest torque of a period meanwhile over the demanded one.
fn move_bus(bench: &mut Bench<'_>, [from, to]: [f64; 2], demand: f64) -> f64 {
    let inverter = &bench.drive.spec.inverter;
    let periods = (RAMP / inverter.t_s).ceil() as usize;
    let mut peak = f64::MIN;
    for period in 1..=periods {
        let share = from + (to - from) * period as f64 / periods as f64;
        let volts = share * inverter.v_bus;
        let plant = bench.closed.plant_mut();
        plant.change(|params| params.v_bus = volts).expect("a bus");
        if let Some(counts) = bench.drive.bus_counts(volts) {
            bench.closed.controller().set_bus(counts);
        }
        let (_, now) = torque(bench, 1, demand);
        peak = peak.max(now);
    }
    peak
}

/// Control periods of some sectors, at least [`FEWEST`].
fn periods(bench: &Bench<'_>, sectors: usize) -> usize {
    (sectors * bench.sector).max(FEWEST)
}

/// Mean and greatest torque of some periods over the demanded one.
fn torque(bench: &mut Bench<'_>, periods: usize, demand: f64) -> (f64, f64) {
    let (mut sum, mut peak) = (0.0, f64::MIN);
    for _ in 0..periods {
        bench.closed.run(1, &mut ());
        let share = bench.closed.plant().truth().mean_torque / demand;
        sum += share;
        peak = f64::max(peak, share);
    }
    (sum / periods as f64, peak)
}

/// What is wrong with a drive whose bus sinks and returns.
fn wrong(drive: &Prepared, direction: f64) -> Option<String> {
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
    let [long, settled] = [SECTORS, SETTLED].map(|sectors| periods(&bench, sectors));
    torque(&mut bench, long, signed);
    let (before, _) = torque(&mut bench, settled, signed);
    move_bus(&mut bench, [1.0, SUNK], signed);
    let (sunk, _) = torque(&mut bench, long, signed);
    let rising = move_bus(&mut bench, [SUNK, 1.0], signed);
    let (_, settling) = torque(&mut bench, settled, signed);
    let peak = rising.max(settling);
    let (after, _) = torque(&mut bench, settled, signed);
    let tripped = bench.closed.tripped();
    let is_of_little = OF_LITTLE.contains(&drive.motor.as_str());
    let most = if is_of_little { PEAK_OF_LITTLE } else { PEAK };
    let is_right = tripped.is_none()
        && sunk < CUT
        && [before, after]
            .iter()
            .all(|share| (share - 1.0).abs() < WITHIN)
        && peak < most;
    let text = format!(
        "{} {} {direction}: {before:.3}, sunk {sunk:.3}, then {after:.3} with a peak of {peak:.3}, {tripped:?}",
        drive.motor, drive.variant
    );
    println!("{text}");
    (!is_right).then_some(text)
}

#[test]
fn the_torque_returns_with_the_bus() {
    let wrong: Vec<String> = library()
        .par_iter()
        .flat_map_iter(|motor| {
            let source = MotorSource::from(motor);
            LAWS.into_iter().flat_map(move |law| {
                let drive = prepare(&source, Some(law)).expect("generates");
                [1.0, -1.0].map(|direction| wrong(&drive, direction))
            })
        })
        .flatten()
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}
