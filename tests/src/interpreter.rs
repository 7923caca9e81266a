//! The IR interpreter as a subject of the bit-for-bit test.

use crate::cases::{self, Case, Record};
use hexagen::arith::{Word, scaled_torque};
use hexagen_codegen::interface::Interface;
use hexagen_codegen::ir::{Demand, Escape, Machine, Program, Setter};
use hexagen_codegen::pipeline::Generated;
use hexagen_lab::{Interpreted, formats, state_names};
use hexagen_reference::verify::{Report, VerifyError, verify_subject};
use hexagen_reference::{BitTrue, Bus, FormatTable, Spec};
use std::sync::{Arc, OnceLock};

/// Cases of `steps` steps from arbitrary states, with the model's answers.
///
/// # Errors
/// If no model can be built.
pub fn record_states(generated: &Generated, steps: u64, seed: u64) -> Result<Record, String> {
    cases::record(generated, steps, seed)
}

/// Like [`compare`], from arbitrary states.
///
/// # Errors
/// The difference, or the value that left its proven interval.
pub fn compare_states(
    generated: &Generated,
    program: &Program,
    steps: u64,
    seed: u64,
) -> Result<(), String> {
    let record = record_states(generated, steps, seed)?;
    compare_record(generated, program, &record)
}

/// Compares the interpreted `program` with the record.
///
/// # Errors
/// The difference, or the value that left its proven interval.
pub fn compare_record(
    generated: &Generated,
    program: &Program,
    record: &Record,
) -> Result<(), String> {
    compare_set_points(program, &record.cases)?;
    let escaped = Arc::default();
    let subject = Interpreted::new(program, &generated.interface).telling(&escaped);
    let result = cases::replay(record, &state_names(program), subject);
    unless_escaped(&escaped, result)
}

/// The result, unless a value left its interval on the way.
fn unless_escaped<T>(escaped: &OnceLock<Escape>, result: Result<T, String>) -> Result<T, String> {
    match escaped.get() {
        None => result,
        Some(Escape { place, value }) => Err(format!(
            "left its interval: {place} = {value:?}\n{}",
            result.err().unwrap_or_default()
        )),
    }
}

/// Compares the setters' words for every input: all set-points up to slightly above the greatest,
/// and all bus voltages.
///
/// # Errors
/// The difference, or the value that left its proven interval.
pub fn compare_all_set_points(generated: &Generated, program: &Program) -> Result<(), String> {
    let interface = &generated.interface;
    let spec = Spec::from_toml(&interface.spec_toml).map_err(|error| error.to_string())?;
    let table = formats(&interface.formats);
    let mut model =
        BitTrue::new(&spec, &FormatTable::new(&table)).map_err(|error| error.to_string())?;
    let mut machine = Machine::of_program(program);
    let most = spec.inverter.max_current * 65_536.0;
    let set_points = [
        (Setter::Current, most),
        (Setter::Torque, most * spec.motor.torque_constant),
    ];
    for (setter, most) in set_points {
        let most = most as i32 + 2;
        for bits in (-most..=most).chain([i32::MIN, i32::MAX]) {
            if setter == Setter::Current {
                model.set_current(bits);
            } else {
                model.set_torque(bits);
            }
            compare_setter(&mut machine, setter, bits, &model)?;
        }
    }
    if spec.inverter.bus == Bus::Measured {
        for counts in 0..=u16::MAX {
            model.set_bus(counts);
            compare_setter(&mut machine, Setter::Bus, counts.into(), &model)?;
        }
    }
    Ok(())
}

/// Calls a setter and compares all set-point words with the model's.
fn compare_setter(
    machine: &mut Machine<'_>,
    setter: Setter,
    word: i32,
    model: &BitTrue,
) -> Result<(), String> {
    let escape = |escape: Escape| format!("left its interval: {}", escape.place);
    machine.set(setter, &[word]).map_err(escape)?;
    let expected = model.set_point_words().map(|word| word as i32);
    // The current's word comes first, then those of a measured bus, if needed.
    if machine.params[..] == expected[..machine.params.len()] {
        return Ok(());
    }
    let found = &machine.params;
    Err(format!(
        "{}({word}): {found:?}, {expected:?} (model)",
        setter.name()
    ))
}

/// The setters' words, which steps show only through their effects.
fn compare_set_points(program: &Program, cases: &[Case]) -> Result<(), String> {
    let mut machine = Machine::of_program(program);
    let names = state_names(program);
    let learnt = names.iter().position(|name| *name == "torque_ratio");
    for Case {
        set,
        set_point_words: [current, bus, reciprocal, speed],
        words,
        ..
    } in cases
    {
        let mut call = |setter, word| {
            let escape = |escape: Escape| format!("left its interval: {}", escape.place);
            machine.set(setter, &[word]).map_err(escape)
        };
        if let Some(counts) = set.bus {
            call(Setter::Bus, counts.into())?;
        }
        if let Some(bits) = set.speed {
            call(Setter::Speed, bits)?;
        }
        if set.is_torque {
            let ratio = learnt.map(|place| Word(words[place]));
            let scaled = ratio.map(|ratio| scaled_torque(Word(set.bits), ratio).0);
            call(Setter::Torque, scaled.unwrap_or(set.bits))?;
        } else {
            call(Setter::Current, set.bits)?;
        }
        for ((demand, word), found) in program.params.iter().zip(&machine.params) {
            let expected = match demand {
                Demand::Current => current,
                Demand::Bus => bus,
                Demand::BusRatio => reciprocal,
                Demand::Speed => speed,
                // No setter's.
                Demand::BusIsFresh => &0,
            };
            if found != expected {
                let name = &word.name;
                return Err(format!("{set:?}: {name} = {found}, {expected} (model)"));
            }
        }
    }
    Ok(())
}

/// Compares the interpreter with the bit-true model; `program` may be faulty, to test the
/// comparison.
///
/// # Errors
/// The difference, or the value that left its proven interval.
pub fn compare(
    generated: &Generated,
    program: &Program,
    steps: u64,
    seed: u64,
) -> Result<Report, String> {
    let interface: &Interface = &generated.interface;
    let escaped = Arc::default();
    let result = verify_subject(
        &interface.spec_toml,
        &formats(&interface.formats),
        &state_names(program),
        || Interpreted::new(program, interface).telling(&escaped),
        steps,
        seed,
    );
    let result = result.map_err(|error: VerifyError| error.to_string());
    unless_escaped(&escaped, result)
}
