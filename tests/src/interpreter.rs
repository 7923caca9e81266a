//! The IR interpreter as a subject of the bit-for-bit test.

use crate::cases::{self, Case, Record};
use hexagen::arith::Word;
use hexagen::{Fault, Format, LegState, Legs, Rounding, Sample};
use hexagen_codegen::InterpretedDrive;
use hexagen_codegen::interface::{self, Interface};
use hexagen_codegen::ir::{Escape, Machine, Program};
use hexagen_codegen::pipeline::Generated;
use hexagen_reference::verify::{Report, Subject, VerifyError, verify_subject};
use hexagen_reference::{BitTrue, Bus, FormatTable, Spec};
use std::cell::RefCell;
use std::collections::BTreeSet;

/// An interpreted drive. A step that fails (a value outside its proven interval) is kept and
/// answered with all legs off.
#[derive(Debug)]
pub struct Interpreted<'g> {
    drive: InterpretedDrive<'g>,
    escaped: &'g RefCell<Option<String>>,
}

impl<'g> Interpreted<'g> {
    /// The program at rest; what leaves its interval is told to `escaped`.
    pub fn new(
        program: &'g Program,
        interface: &Interface,
        escaped: &'g RefCell<Option<String>>,
    ) -> Self {
        Self {
            drive: InterpretedDrive::new(program, interface),
            escaped,
        }
    }

    fn set(&mut self, setter: &str, word: i32) {
        if let Err(escape) = self.drive.set(setter, word) {
            self.note(&escape);
        }
    }

    fn note(&self, escape: &Escape) {
        let mut escaped = self.escaped.borrow_mut();
        escaped.get_or_insert_with(|| format!("{} = {:?}", escape.place, escape.value));
    }
}

impl Subject for Interpreted<'_> {
    fn step(&mut self, sample: &Sample) -> Legs {
        let Sample {
            adc_a,
            adc_b,
            hall,
            hall_ticks,
        } = *sample;
        let words = [adc_a, adc_b, u16::from(hall), hall_ticks].map(i32::from);
        match self.drive.step(words) {
            Ok([compare, legs]) => Legs::new(
                compare.map(|word| word as u16),
                legs.map(|word| LegState::from_word(Word(word))),
            ),
            Err(escape) => {
                self.note(&escape);
                Legs::OFF
            }
        }
    }

    fn set_current(&mut self, bits: i32) {
        self.set("set_current", bits);
    }

    fn set_torque(&mut self, bits: i32) {
        self.set("set_torque", bits);
    }

    fn set_speed(&mut self, bits: i32) {
        self.set("set_speed", bits);
    }

    fn set_bus(&mut self, counts: u16) {
        self.set("set_bus", i32::from(counts));
    }

    fn reset(&mut self) {
        self.drive.reset();
    }

    fn calibrate(&mut self) {
        self.drive.calibrate();
    }

    fn precharge(&mut self) {
        self.drive.precharge();
    }

    fn fault(&self) -> Fault {
        Fault::from_word(Word(self.drive.fault()))
    }

    fn bus_is_stale(&self) -> bool {
        self.drive.bus_is_stale()
    }

    fn state_words(&self, words: &mut [i32]) {
        words.copy_from_slice(self.drive.state());
    }

    fn set_state_words(&mut self, words: &[i32]) {
        self.drive.state_mut().copy_from_slice(words);
    }
}

/// Cases of `steps` steps from arbitrary states, with the model's answers.
///
/// # Errors
/// When no model can be built.
pub fn record_states(generated: &Generated, steps: u64, seed: u64) -> Result<Record, String> {
    let interface = &generated.interface;
    let program = generated.graph.program();
    let formats = formats(&interface.formats);
    cases::record(&interface.spec_toml, &formats, program, steps, seed)
}

/// As [`compare`], from arbitrary states.
///
/// # Errors
/// What differs, or which value left its proven interval.
pub fn compare_states(
    generated: &Generated,
    program: &Program,
    steps: u64,
    seed: u64,
) -> Result<(), String> {
    let record = record_states(generated, steps, seed)?;
    compare_record(generated, program, &record)
}

/// Compares the interpreted `program` with what was recorded.
///
/// # Errors
/// What differs, or which value left its proven interval.
pub fn compare_record(
    generated: &Generated,
    program: &Program,
    record: &Record,
) -> Result<(), String> {
    compare_set_points(program, &record.cases)?;
    let escaped = RefCell::new(None);
    let subject = Interpreted::new(program, &generated.interface, &escaped);
    let result = cases::replay(record, &names(program), subject);
    match (escaped.into_inner(), result) {
        (Some(place), result) => Err(format!(
            "left its interval: {place}\n{}",
            result.err().unwrap_or_default()
        )),
        (None, result) => result,
    }
}

/// Compares the words that the setters make of every input: of all set-points up to the greatest and a
/// few beyond, and of all bus voltages.
///
/// # Errors
/// What differs, or which value left its proven interval.
pub fn compare_all_set_points(generated: &Generated, program: &Program) -> Result<(), String> {
    let interface = &generated.interface;
    let spec = Spec::from_toml(&interface.spec_toml).map_err(|error| error.to_string())?;
    let table = formats(&interface.formats);
    let mut model =
        BitTrue::new(&spec, &FormatTable::new(&table)).map_err(|error| error.to_string())?;
    let mut machine = Machine::of_program(program);
    let most = spec.inverter.max_current * 65_536.0;
    let set_points = [
        ("set_current", most),
        ("set_torque", most * spec.motor.torque_constant),
    ];
    for (setter, most) in set_points {
        let most = most as i32 + 2;
        for bits in (-most..=most).chain([i32::MIN, i32::MAX]) {
            if setter == "set_current" {
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
            compare_setter(&mut machine, "set_bus", counts.into(), &model)?;
        }
    }
    Ok(())
}

/// Calls a setter and compares all set-point words with the model's.
fn compare_setter(
    machine: &mut Machine<'_>,
    setter: &str,
    word: i32,
    model: &BitTrue,
) -> Result<(), String> {
    let escape = |escape: Escape| format!("left its interval: {}", escape.place);
    machine.set(setter, &[word]).map_err(escape)?;
    let expected = model.set_point_words().map(|word| word as i32);
    // The current's word comes first, then those of a measured bus, as far as they are needed.
    if machine.params[..] == expected[..machine.params.len()] {
        return Ok(());
    }
    let found = &machine.params;
    Err(format!("{setter}({word}): {found:?}, {expected:?} (model)"))
}

/// The words that the setters make, which steps show only through their effects.
fn compare_set_points(program: &Program, cases: &[Case]) -> Result<(), String> {
    let mut machine = Machine::of_program(program);
    for Case {
        set,
        set_point_words: [current, bus, reciprocal, speed],
        ..
    } in cases
    {
        let mut call = |name, word| {
            let escape = |escape: Escape| format!("left its interval: {}", escape.place);
            machine.set(name, &[word]).map_err(escape)
        };
        if let Some(counts) = set.bus {
            call("set_bus", counts.into())?;
        }
        if let Some(bits) = set.speed {
            call("set_speed", bits)?;
        }
        if set.is_torque {
            call("set_torque", set.bits)?;
        } else {
            call("set_current", set.bits)?;
        }
        for (word, found) in program.params.iter().zip(&machine.params) {
            let expected = match word.name.as_str() {
                "j" => current,
                "v_bus" => bus,
                "ratio" => reciprocal,
                "speed_ref" => speed,
                _ => continue,
            };
            if found != expected {
                let name = &word.name;
                return Err(format!("{set:?}: {name} = {found}, {expected} (model)"));
            }
        }
    }
    Ok(())
}

/// Names of the state words.
fn names(program: &Program) -> Vec<&str> {
    let words = program.states.iter();
    words.map(|word| word.name.as_str()).collect()
}

/// The format table in the types of the hardware boundary.
///
/// # Panics
/// When a width or shift is out of the table's range.
pub fn formats(table: &[interface::FormatEntry]) -> Vec<Format> {
    let convert = |entry: &interface::FormatEntry| Format {
        name: interned(&entry.name),
        storage_bits: u8::try_from(entry.storage_bits).expect("a word length"),
        frac_bits: i8::try_from(entry.frac_bits).expect("fraction bits"),
        rounding: match entry.rounding {
            interface::Rounding::Floor => Rounding::Floor,
            interface::Rounding::RoundHalfUp => Rounding::RoundHalfUp,
        },
        segments: entry.segments.map_or(0, |segments| {
            u8::try_from(segments).expect("a table's segments")
        }),
    };
    table.iter().map(convert).collect()
}

/// Format names are few; each is kept once for the life of the test.
fn interned(name: &str) -> &'static str {
    use std::sync::{Mutex, PoisonError};
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name) {
        return known;
    }
    let kept: &'static str = Box::leak(name.to_owned().into_boxed_str());
    names.insert(kept);
    kept
}

/// Compares the interpreter with the bit-true model; `program` may be another one than the
/// generated, to see whether the comparison notices.
///
/// # Errors
/// What differs, or which value left its proven interval.
pub fn compare(
    generated: &Generated,
    program: &Program,
    steps: u64,
    seed: u64,
) -> Result<Report, String> {
    let interface = &generated.interface;
    let escaped = RefCell::new(None);
    let result = verify_subject(
        &interface.spec_toml,
        &formats(&interface.formats),
        &names(program),
        || Interpreted::new(program, interface, &escaped),
        steps,
        seed,
    )
    .map_err(|error: VerifyError| error.to_string());
    match (escaped.into_inner(), result) {
        (Some(place), result) => Err(format!(
            "left its interval: {place}{}",
            result
                .err()
                .map(|error| format!("\n{error}"))
                .unwrap_or_default()
        )),
        (None, result) => result,
    }
}
