//! The bit-for-bit test from arbitrary states: states with the model's answers, recorded once and
//! compared with any number of subjects.

use crate::set::Set;
use crate::states::States;
use hexagen::{Fault, Sample};
use hexagen_codegen::pipeline::Generated;
use hexagen_lab::formats;
use hexagen_reference::verify::Subject;
use hexagen_reference::{AnyCommand, BitTrue, Bus, FormatTable, Spec};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Steps from one arbitrary state; the first one matters most.
const STEPS_PER_STATE: usize = 2;

/// A state with its calls and sample, and the model's answers.
#[derive(Clone, Debug)]
pub struct Case {
    /// Calls before the first step.
    pub set: Set,
    /// The model's set-point words: current, bus voltage, its reciprocal, speed.
    pub set_point_words: [i32; 4],
    /// The state.
    pub words: Vec<i32>,
    sample: Sample,
    answers: [Answer; STEPS_PER_STATE],
}

/// Result of a step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Answer {
    command: AnyCommand,
    fault: Option<Fault>,
    words: Vec<i32>,
}

/// Recorded answers of a drive's model: at the start, and from arbitrary states.
#[derive(Clone, Debug)]
pub struct Record {
    /// Words of the initial state.
    initial: Vec<i32>,
    /// States with the answers to them.
    pub cases: Vec<Case>,
}

impl Record {
    /// Only the first cases, this many.
    #[must_use]
    pub fn first(&self, cases: usize) -> Self {
        Self {
            initial: self.initial.clone(),
            cases: self.cases.iter().take(cases).cloned().collect(),
        }
    }
}

/// The cases of `steps` steps from arbitrary states of a drive, for any number of subjects.
///
/// # Errors
/// If no model can be built.
pub fn record(generated: &Generated, steps: u64, seed: u64) -> Result<Record, String> {
    let interface = &generated.interface;
    let spec = Spec::from_toml(&interface.spec_toml).map_err(|error| error.to_string())?;
    let formats = FormatTable::new(&formats(&interface.formats));
    let mut model = BitTrue::new(&spec, &formats).map_err(|error| error.to_string())?;
    let names = model.state_names();
    let mut states = States::new(&spec, generated, &names, seed);
    let most_current = spec.inverter.max_current * 65_536.0;
    let most_speed = spec.inverter.omega_max * 60.0 / TAU * 65_536.0;
    let most_torque = most_current * spec.motor.torque_constant;
    let mut initial = vec![0; names.len()];
    model.state_words(&mut initial);
    let mut cases = vec![];
    for number in 0..steps.div_ceil(STEPS_PER_STATE as u64) {
        let is_torque = number % 2 == 1;
        let most = if is_torque { most_torque } else { most_current };
        let mut set = Set {
            bits: states.set_point(most),
            is_torque,
            bus: (spec.inverter.bus == Bus::Measured).then(|| states.bus_counts()),
            speed: spec
                .loop_options()
                .has_speed_loop()
                .then(|| states.set_point(most_speed)),
        };
        set.tell(&mut model);
        let mut words = vec![0; names.len()];
        let mut sample = states.fill(&mut words);
        states.seek_edge(&mut model, &mut words, sample, (&mut set, most as i32));
        model.set_state_words(&words);
        // A torque is scaled by the constant that the state has learnt.
        set.tell(&mut model);
        let mut case = Case {
            set,
            set_point_words: model.set_point_words().map(|word| word as i32),
            words,
            sample,
            answers: Default::default(),
        };
        for answer in &mut case.answers {
            *answer = Answer {
                command: model.step(&sample),
                fault: model.fault(),
                words: vec![0; names.len()],
            };
            model.state_words(&mut answer.words);
            sample = next(sample);
        }
        cases.push(case);
    }
    Ok(Record { initial, cases })
}

/// The sample of the next period.
fn next(sample: Sample) -> Sample {
    sample.hall_ticks(sample.ticks().saturating_add(1))
}

/// Compares a new subject with the record; `names` are those of the state words.
///
/// # Errors
/// The difference.
pub fn replay<S: Subject>(record: &Record, names: &[&str], mut subject: S) -> Result<(), String> {
    let mut found = Answer::default();
    found.words.resize(names.len(), 0);
    subject.state_words(&mut found.words);
    if let Some(place) = (0..names.len()).find(|&word| found.words[word] != record.initial[word]) {
        let (name, is, should) = (names[place], found.words[place], record.initial[place]);
        return Err(format!(
            "{name} is {is} at the start, {should} in the model"
        ));
    }
    for (number, case) in record.cases.iter().enumerate() {
        subject.set_state_words(&case.words);
        case.set.apply(&mut subject);
        let mut sample = case.sample;
        for answer in &case.answers {
            found.command = subject.step(&sample);
            found.fault = subject.fault();
            subject.state_words(&mut found.words);
            if found != *answer {
                return Err(difference(number, case, names, sample, &found, answer));
            }
            sample = next(sample);
        }
    }
    Ok(())
}

fn difference(
    number: usize,
    case: &Case,
    names: &[&str],
    sample: Sample,
    found: &Answer,
    expected: &Answer,
) -> String {
    let mut text = format!(
        "state {number}, {sample:?}\n  {:?} {:?}\n  {:?} {:?} (model)\n",
        found.command, found.fault, expected.command, expected.fault
    );
    for (index, name) in names.iter().enumerate() {
        let (from, is, should) = (case.words[index], found.words[index], expected.words[index]);
        let mark = if is == should { "" } else { "  <--" };
        writeln!(text, "  {name:<16} {from:>12} {is:>12} {should:>12}{mark}")
            .expect("a string takes all");
    }
    text
}
