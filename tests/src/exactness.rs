//! Proof that every sum and product of the bit-true model is exact, by words with intervals.
//!
//! The model itself runs, with [`Bounded`] words in place of f64: state words are any of the
//! verifier's proven intervals, inputs any of their types. An operation in the source has the union
//! of its results over all paths so far, for all values, which must fit 53 bits. Arbitrary states
//! drive the program along its paths; a proof ends when as many further states as so far have added
//! nothing to any operation. Every value must lie in its interval, and every step must equal the
//! plain model's.

mod bounded;
pub mod ledger;
mod operations;

pub use bounded::Bounded;

use crate::states::States;
use hexagen::Format;
use hexagen_codegen::pipeline::Generated;
use hexagen_lab::formats;
use hexagen_reference::{BitTrue, FormatTable, Spec};
use ledger::Findings;
use std::f64::consts::TAU;

/// Minimum and maximum number of states of a proof.
const STATES: [usize; 2] = [1 << 10, 1 << 16];

/// Proves that a drive's bit-true model is exact.
///
/// # Errors
/// The place of a possibly inexact operation, or that the states did not suffice.
pub fn prove_exact(generated: &Generated) -> Result<Findings, String> {
    prove(generated, &formats(&generated.interface.formats), true)
}

/// Like [`prove_exact`] for another format table, in the drive's own states. Steps are not compared
/// with the plain model, which stops at numbers that are too long.
///
/// # Errors
/// Like [`prove_exact`].
pub fn prove_exact_in(generated: &Generated, table: &[Format]) -> Result<Findings, String> {
    prove(generated, table, false)
}

fn prove(generated: &Generated, table: &[Format], compares: bool) -> Result<Findings, String> {
    let toml = &generated.interface.spec_toml;
    let spec = Spec::from_toml(toml).map_err(|error| error.to_string())?;
    let table = FormatTable::new(table);
    let plain = BitTrue::new(&spec, &table);
    let mut plain = plain.map_err(|error| error.to_string())?;
    ledger::begin();
    let model = BitTrue::<Bounded>::over_words(&spec, &table);
    let mut model = model.map_err(|error| error.to_string())?;
    ledger::open();
    let names = model.state_names();
    let mut states = States::new(&spec, generated, &names, 1);
    let ranges = states.ranges().to_vec();
    let most_current = spec.inverter.max_current * 65_536.0;
    let most_speed = spec.inverter.omega_max * 60.0 / TAU * 65_536.0;
    let mut words = vec![0; names.len()];
    let mut both = [words.clone(), words.clone()];
    let [least, most] = STATES;
    let (mut settled, mut number) = (0, 0);
    while number < least + 2 * settled {
        // The first step has the initial set-point.
        if number > 0 {
            let (bus, speed) = (states.bus_counts(), states.set_point(most_speed));
            model.set_bus(bus);
            plain.set_bus(bus);
            model.set_speed(speed);
            plain.set_speed(speed);
            if number % 2 == 0 {
                let current = states.set_point(most_current);
                model.set_current(current);
                plain.set_current(current);
            } else {
                let torque = states.set_point(most_current * spec.motor.torque_constant);
                model.set_torque(torque);
                plain.set_torque(torque);
            }
        }
        let sample = states.fill(&mut words);
        model.set_state_within(&words, &ranges);
        plain.set_state_words(&words);
        let before = ledger::news();
        let legs = model.step(&sample);
        number += 1;
        if ledger::news() > before {
            settled = number;
        }
        if let Some(faults) = ledger::faults() {
            return Err(faults);
        }
        if compares {
            let expected = plain.step(&sample);
            model.state_words(&mut both[0]);
            plain.state_words(&mut both[1]);
            if legs != expected || both[0] != both[1] {
                return Err(format!("step {number} differs: {both:?}"));
            }
        }
        if number == most {
            return Err(format!(
                "something new in step {settled} still, {}",
                ledger::newest()
            ));
        }
    }
    Ok(ledger::findings())
}
