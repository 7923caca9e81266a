//! The current sensors of the plant: each channel shows the current of its own instant.

use hexagen::{LegState, Legs};
use hexagen_lab::plant::{AdcChannel, LowSide, Plant, PlantParams};

const R: f64 = 0.135;
const L: f64 = 0.22e-3;
const V: f64 = 48.0;
const T_S: f64 = 50e-6;
const N: u16 = 1800;

/// A motor without EMF whose second channel, of phase b, is sampled at `instant` (second).
fn motor(instant: f64) -> PlantParams {
    let mut params = PlantParams::ideal(4, R, L, 0.0, V, T_S);
    params.adc = vec![AdcChannel::bipolar(16, 40.0); 2];
    params.adc[1].instant = instant;
    params
}

fn plant(params: PlantParams, currents: [f64; 2]) -> Plant {
    let mut plant = Plant::new(params, 0.3, 0.0).expect("a plant");
    plant.set_currents(currents);
    plant
}

fn pulsed(compare: [u16; 3]) -> Legs {
    Legs::new(compare, [LegState::Pulsed; 3])
}

/// Current of a phase `t` seconds behind `start`, with a constant voltage of the winding.
fn decayed(start: f64, voltage: f64, t: f64) -> f64 {
    let end = voltage / R;
    end + (start - end) * (-R / L * t).exp()
}

/// The currents in amperes that a sample shows.
fn read(plant: &mut Plant, next: Legs) -> [f64; 2] {
    let [a, b, _] = plant.sample(next).adc();
    [a, b].map(|count| (f64::from(count) - 32768.0) * 40.0 / 32768.0)
}

#[track_caller]
fn assert_reads(got: f64, want: f64) {
    // Half a count, and nothing else.
    assert!(
        (got - want).abs() <= 0.5 * 40.0 / 32768.0 + 1e-9,
        "{got} A, but {want} A flow"
    );
}

#[test]
fn a_later_conversion_sees_the_current_under_the_command_of_the_period_that_begins() {
    const LATE: f64 = 2e-6;
    // Leg a is high from the start on: the winding of phase b has a third of the bus against it.
    let next = pulsed([N, 0, 0]);
    let mut plant = plant(motor(LATE), [5.0, -8.0]);
    let before = plant.truth();
    let [i_a, i_b] = read(&mut plant, next);
    assert_reads(i_a, 5.0);
    assert_reads(i_b, decayed(-8.0, -V / 3.0, LATE));
    assert!(i_b < -8.13, "the current moves by 140 mA");
    // To sample is not to run.
    assert_eq!(plant.truth(), before);
    // Another command, another current.
    let [_, i_b] = read(&mut plant, pulsed([0, N, 0]));
    assert_reads(i_b, decayed(-8.0, 2.0 * V / 3.0, LATE));
}

#[test]
fn a_later_conversion_sees_what_switches_before_it() {
    const LATE: f64 = 2e-6;
    // Leg a turns on 1 us behind the start of the period: 36 of the 900 counts of half a period.
    let compare = N - 72;
    let mut plant = plant(motor(LATE), [5.0, -8.0]);
    let [_, i_b] = read(&mut plant, pulsed([compare, 0, 0]));
    let at_edge = decayed(-8.0, 0.0, 1e-6);
    assert_reads(i_b, decayed(at_edge, -V / 3.0, 1e-6));
}

#[test]
fn an_early_conversion_sees_the_period_that_ends() {
    const EARLY: f64 = 3e-6;
    let mut params = motor(-EARLY);
    params.adc[0].instant = -2.0 * EARLY;
    let mut plant = plant(params, [5.0, -8.0]);
    plant.run_period(pulsed([N, 0, 0]), &mut ());
    let [i_a, i_b] = read(&mut plant, pulsed([0, N, 0]));
    assert_reads(i_a, decayed(5.0, 2.0 * V / 3.0, T_S - 2.0 * EARLY));
    assert_reads(i_b, decayed(-8.0, -V / 3.0, T_S - EARLY));
}

#[test]
fn a_leg_that_rises_between_two_conversions_blinds_the_second() {
    const LATE: f64 = 1e-6;
    const APERTURE: f64 = 0.2e-6;
    let blind = |low: f64| {
        let mut params = motor(LATE);
        params.low_side = Some(LowSide {
            settling: 1e-6,
            aperture: APERTURE,
        });
        let compare = N - (2.0 * low / T_S * f64::from(N)).round() as u16;
        let command = pulsed([900, compare, 900]);
        let mut plant = plant(params, [5.0, -8.0]);
        plant.run_period(command, &mut ());
        let [_, i_b] = read(&mut plant, command);
        (plant.blind_samples(), i_b)
    };
    let (count, i_b) = blind(1.5e-6);
    assert_eq!(count, 0);
    assert!(i_b < -4.0, "{i_b} A");
    // The conversion begins in time and ends too late.
    assert_eq!(blind(1.1e-6).0, 1);
    // The upper switch carries the current at the instant.
    assert_eq!(blind(0.9e-6), (1, 0.0));
}

#[test]
fn noise_is_the_same_in_every_run_and_another_one_in_every_sample() {
    let mut params = motor(0.0);
    params
        .adc
        .iter_mut()
        .for_each(|channel| channel.noise = 5.0);
    let run = || {
        let mut plant = plant(params.clone(), [5.0, -8.0]);
        [(); 20].map(|()| plant.sample(Legs::OFF).adc())
    };
    let first = run();
    assert_eq!(first, run());
    let mut distinct = first.to_vec();
    distinct.sort_unstable();
    distinct.dedup();
    assert!(distinct.len() > 15, "{first:?}");
}
