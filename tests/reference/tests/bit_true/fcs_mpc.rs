//! FCS-MPC chooses the nearest vector of its list, the first of equals.

use crate::variants::{self, Variant};
use hexagen::{LegState, Sample};
use hexagen_reference::verify::{Action, Context, Stimulus};
use hexagen_reference::{
    BitTrue, Candidates, Controller, Duties, FcsMpc, Ideal, OffLeg, Reference, Switch,
};

/// The vectors' legs as the paper names them, by number.
const LEGS: [&str; 16] = [
    "---", "--+", "+-+", "+--", "++-", "-+-", "-++", "0-+", "+-0", "+0-", "0+-", "-+0", "-0+",
    "0--", "-0-", "--0",
];
/// The leg that is off in sectors 1 to 6.
const OFF: [usize; 6] = [0, 2, 1, 0, 2, 1];

fn fcs_mpc() -> impl Iterator<Item = (Variant, FcsMpc)> {
    variants::others().into_iter().filter_map(|variant| {
        let Controller::FcsMpc(options) = variant.spec.controller else {
            return None;
        };
        Some((variant, options))
    })
}

/// Phase voltages of a vector in units of the bus, a leg that is off without voltage.
fn voltage(vector: usize) -> [f64; 3] {
    let legs = LEGS[vector].as_bytes();
    let driven = 3.0 - LEGS[vector].matches('0').count() as f64;
    let high = LEGS[vector].matches('+').count() as f64;
    [0, 1, 2].map(|x| match legs[x] {
        b'+' => 1.0 - high / driven,
        b'-' => -high / driven,
        _ => 0.0,
    })
}

#[test]
fn the_nearest_candidate_is_chosen() {
    let mut seen = [0u32; 16];
    for (seed, (variant, options)) in (0..).zip(fcs_mpc()) {
        if !variants::is_plain(&options) {
            continue;
        }
        if options.off_leg == OffLeg::Physical && options.candidates != Candidates::ThreePhase {
            continue;
        }
        let mut ideal = Ideal::new(&variant.spec).expect("a model");
        let mut stimulus = Stimulus::new(&variant.spec, seed).expect("a stimulus");
        let mut v_bus = variant.spec.inverter.v_bus;
        for _ in 0..1000 {
            let context = Context {
                offset: [f64::from(variant.spec.inverter.adc_offset.first()); 3],
                tripped: !ideal.trace().run,
            };
            let (action, sample) = stimulus.next(&context);
            match action {
                Some(Action::SetCurrent(bits)) => ideal.set_current(bits),
                Some(Action::SetBus(counts)) => {
                    ideal.set_bus(counts);
                    v_bus = (f64::from(counts.min(4095)) * 0.1).clamp(40.0, 390.0);
                }
                Some(Action::Reset) => ideal.reset(),
                _ => {}
            }
            let duties = ideal.step(&sample);
            let trace = ideal.trace();
            if !trace.run {
                assert_eq!(trace.vector, 0);
                continue;
            }
            let list: Vec<usize> = match options.candidates {
                Candidates::ThreePhase => (0..7).collect(),
                Candidates::All => (0..13).collect(),
                Candidates::Table2 if trace.commutating => (0..7).collect(),
                Candidates::Table2 => std::iter::once(13 + OFF[trace.sector_eff - 1])
                    .chain(7..13)
                    .collect(),
            };
            let [a, b] = trace.u_unsat;
            let u = [a, b, -(a + b)];
            let cost = |v: [f64; 3]| -> f64 { (0..3).map(|x| (u[x] - v[x] * v_bus).powi(2)).sum() };
            let least = list
                .iter()
                .map(|v| cost(voltage(*v)))
                .fold(f64::MAX, f64::min);
            assert!(list.contains(&trace.vector), "{}", variant.name);
            assert!(
                cost(voltage(trace.vector)) <= least + 1e-9 * (v_bus + a.abs() + b.abs()).powi(2),
                "{}: {trace:?}",
                variant.name
            );
            seen[trace.vector] += 1;
            if options.modulated == Switch::On {
                shares_the_period(trace.vector, &list, &duties, &cost, v_bus);
                continue;
            }
            for (x, leg) in LEGS[trace.vector].bytes().enumerate() {
                let expected = match leg {
                    b'+' => (1.0, LegState::Pulsed),
                    // In variants without off legs, all are pulsed.
                    b'-' if options.candidates == Candidates::ThreePhase => (0.0, LegState::Pulsed),
                    b'-' => (0.0, LegState::Low),
                    _ => (0.0, LegState::Off),
                };
                assert_eq!((duties.duty[x], duties.state[x]), expected);
            }
        }
    }
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
}

/// The mean of the shared period costs no more than that of the chosen vector and any other at any
/// fraction, as far as pulses in the middle of the period can make it.
fn shares_the_period(
    vector: usize,
    list: &[usize],
    duties: &Duties,
    cost: &impl Fn([f64; 3]) -> f64,
    v_bus: f64,
) {
    let legs = |vector: usize| -> Vec<u8> { LEGS[vector].bytes().collect() };
    let off = |vector: usize| legs(vector).iter().position(|leg| *leg == b'0');
    let mean = {
        let mut terminal = duties.duty;
        if let Some(off) = off(vector) {
            assert_eq!(duties.state[off], LegState::Off);
            assert_eq!(terminal[off], 0.0);
            terminal[off] = terminal.iter().sum::<f64>() / 2.0;
        }
        let mean = terminal.iter().sum::<f64>() / 3.0;
        terminal.map(|t| t - mean)
    };
    let found = cost(mean);
    let mut others = list.to_vec();
    others.extend(13..16);
    for other in others {
        let nested = |one: usize, two: usize| {
            let pairs = legs(one).into_iter().zip(legs(two));
            pairs
                .into_iter()
                .all(|(one, two)| one != b'+' || two == b'+')
        };
        let can_share =
            off(other) == off(vector) && (nested(vector, other) || nested(other, vector));
        if !can_share {
            continue;
        }
        for share in 0..=50 {
            let share = f64::from(share) / 50.0;
            let (one, two) = (voltage(vector), voltage(other));
            let mixed = [0, 1, 2].map(|x| one[x] * share + two[x] * (1.0 - share));
            let scale = (v_bus + found.sqrt()).powi(2);
            assert!(
                found <= cost(mixed) + 1e-9 * scale,
                "{vector} and {other} at {share}"
            );
        }
    }
}

#[test]
fn ties_choose_the_first_candidate() {
    let mut tried = 0;
    for (variant, options) in fcs_mpc() {
        let (inverter, common) = (&variant.spec.inverter, variant.spec.loop_options());
        if options.candidates != Candidates::ThreePhase
            || !variants::is_plain(&options)
            || options.modulated == Switch::On
            || common.reference != Reference::QuasiSquare
            || variants::has_rotor(&variant)
        {
            continue;
        }
        for sector in 1..=6 {
            for sense in [1, -1] {
                // From rest the demand is the sector's corner, midway between two vectors.
                let mut bit_true =
                    BitTrue::new(&variant.spec, &variants::table(&variant)).expect("a model");
                let mut ideal = Ideal::new(&variant.spec).expect("a model");
                let bits = sense * (inverter.max_current * 65_536.0) as i32;
                bit_true.set_current(bits);
                ideal.set_current(bits);
                let code = variant.spec.motor.hall_codes[sector - 1];
                let sample = Sample::with_hall([inverter.adc_offset.first() as u16; 2], code);
                let legs = bit_true.step(&sample);
                let duties = ideal.step(&sample);
                let first = if sense > 0 {
                    sector
                } else {
                    (sector + 2) % 6 + 1
                };
                let expected = first.min(first % 6 + 1);
                assert_eq!(bit_true.trace().vector, expected, "{}", variant.name);
                assert_eq!(ideal.trace().vector, expected, "{}", variant.name);
                assert_eq!(legs, duties.to_command(inverter.timer_period as u16));
                tried += 1;
            }
        }
    }
    assert!(tried > 0);
}
