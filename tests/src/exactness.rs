//! The bit-true model over words with intervals: that every sum and product of it is exact.
//!
//! The model itself runs, over [`Bounded`] words in place of f64: state words are any of the intervals
//! that the verifier has proven, inputs any of their types. An operation of the text gets the union of what it may give
//! on all ways that have led to it, for all values, and has to fit 53 bits with it. Arbitrary states lead the program
//! on its ways; a proof ends when as many states again as it took to get there have added nothing to any operation. Every
//! value has to be what is known of it, and every step that of the plain model.

mod bounded;
pub mod ledger;

pub use bounded::Bounded;

use crate::states::States;
use hexagen::Format;
use hexagen_codegen::pipeline::Generated;
use hexagen_lab::formats;
use hexagen_reference::{BitTrue, FormatTable, Spec};
use ledger::Findings;
use std::f64::consts::TAU;

/// States that a proof takes at least, and at most.
const STATES: [usize; 2] = [1 << 10, 1 << 16];

/// Proves that a drive's bit-true model is exact.
///
/// # Errors
/// Where it may not be, or that the states did not suffice.
pub fn prove_exact(generated: &Generated) -> Result<Findings, String> {
    prove(generated, &formats(&generated.interface.formats), true)
}

/// As [`prove_exact`] for another format table, in the drive's own states. Steps are not compared with those of the
/// plain model, which stops where a number is too long.
///
/// # Errors
/// As [`prove_exact`].
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
        // The first step is one with the set-point of a drive at rest.
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
