//! Hall code and time since the edge, read on either side of an edge: angle and speed hardly
//! change.

use crate::variants::{self, Variant};
use hexagen::Sample;
use hexagen_reference::{BitTrue, FormatTable};
use std::f64::consts::{PI, TAU};

/// Control periods of 60 electrical degrees: 1500 rpm with four pole pairs at 50 us.
const SECTOR: f64 = 33.37;
/// An edge this soon after the first read comes before the second, periods.
const BETWEEN: f64 = 0.3;

/// The read after the edge.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Late {
    Neither,
    Code,
    Ticks,
}

fn timed() -> Variant {
    let wanted =
        "660 W: three_phase keep_angle model 1 quasi_square advance 0 delay 1 exact timer fixed";
    let mut all = variants::all().into_iter();
    all.find(|variant| variant.name == wanted)
        .expect("the variant")
}

/// Angle and angle per period, step by step, of a rotor at constant speed.
fn run(variant: &Variant, late: Late) -> Vec<[f64; 2]> {
    let formats = FormatTable::new(variant.formats);
    let mut model = BitTrue::new(&variant.spec, &formats).expect("a model");
    let (motor, inverter) = (&variant.spec.motor, &variant.spec.inverter);
    let sector = |time: f64| (time / SECTOR).floor();
    let steps = (0..2000).map(|step| {
        let first = f64::from(step);
        let second = first + BETWEEN;
        let [code, ticks] = match late {
            Late::Neither => [first, first],
            Late::Code => [second, first],
            Late::Ticks => [first, second],
        };
        let since = (ticks - sector(ticks) * SECTOR) * inverter.ticks;
        let code = motor.hall_codes[sector(code) as usize % 6];
        let sample = Sample::with_hall([inverter.adc_offset.first() as u16; 2], code);
        model.step(&sample.hall_ticks(since as u16));
        let trace = model.trace();
        [trace.theta, trace.step_angle]
    });
    steps.collect()
}

#[test]
fn a_read_on_either_side_of_an_edge_moves_the_angle_by_less_than_a_period() {
    let variant = timed();
    let right = run(&variant, Late::Neither);
    let period = TAU / 6.0 / SECTOR;
    for late in [Late::Code, Late::Ticks] {
        let torn = run(&variant, late);
        assert_ne!(torn, right, "{late:?}: no edge between two reads");
        // The speed is known after a turn and an edge.
        for (step, (torn, right)) in torn.iter().zip(&right).enumerate().skip(240) {
            let off = (torn[0] - right[0] + PI).rem_euclid(TAU) - PI;
            assert!(
                off.abs() < period,
                "{late:?}, step {step}: {:.1} degrees off",
                off.to_degrees()
            );
            let speed = torn[1] / right[1];
            assert!(
                (speed - 1.0).abs() < 0.01,
                "{late:?}, step {step}: speed {speed}"
            );
        }
    }
}
