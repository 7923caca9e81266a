//! The bit-for-bit test: a drive and its bit-true model get the same inputs; every output and every
//! state word must be equal after every step.
//!
//! Each session begins with a calibration; then three kinds of input alternate: arbitrary words, a
//! crude motor in closed loop, and corner values. A seed determines the whole run.

mod mismatch;
mod report;
mod stimulus;
mod subject;
mod toy_motor;

pub use mismatch::{Difference, Mismatch, VerifyError};
pub use report::Report;
pub use stimulus::{Action, Context, Stimulus, Stream};
pub use subject::{Compiled, Subject};

use crate::{AnyCommand, BitTrue, FormatTable, Mode, Spec};
use hexagen::{Control, Drive, Fault, Format, Sample};

/// Steps that [`assert_bit_true`] runs.
pub const DEFAULT_STEPS: u64 = 500_000;

/// Steps after which drive and model are initialised again.
const SESSION: u64 = 1 << 16;

/// Compares a compiled drive with its bit-true model over `steps` steps.
///
/// # Errors
/// If they differ, or no model can be built from the drive's specification and formats.
pub fn verify<C: Control<Command: Into<AnyCommand>>>(
    steps: u64,
    seed: u64,
) -> Result<Report, VerifyError> {
    let names: Vec<_> = Drive::<C>::state_names().collect();
    let new = Compiled::<C>::new;
    verify_subject(C::SPEC, C::FORMATS, &names, new, steps, seed)
}

/// Runs the bit-for-bit test of a compiled drive and panics with a table of the differences.
///
/// # Panics
/// If drive and model differ, or no model can be built.
pub fn assert_bit_true<C: Control<Command: Into<AnyCommand>>>() {
    if let Err(error) = verify::<C>(DEFAULT_STEPS, 1) {
        panic!("{} is not bit-true: {error}", C::NAME);
    }
}

/// Like [`verify`], for any implementation of a drive's steps: `new` makes a subject in its initial
/// state, `spec` and `formats` are as in [`Control`]'s constants of these names, `names` those of
/// its state words.
///
/// # Errors
/// Like [`verify`].
pub fn verify_subject<S: Subject>(
    spec: &str,
    formats: &[Format],
    names: &[&str],
    new: impl Fn() -> S,
    steps: u64,
    seed: u64,
) -> Result<Report, VerifyError> {
    let spec = Spec::from_toml(spec)?;
    let fresh = BitTrue::new(&spec, &FormatTable::new(formats))?;
    let expected = fresh.state_names();
    if expected != names {
        return Err(VerifyError::StateNames {
            expected: expected.join(" "),
            found: names.join(" "),
        });
    }
    let mut stimulus = Stimulus::new(&spec, seed)?;
    let mut report = Report::default();
    let mut pair = Pair::new(&fresh, new());
    while report.steps < steps {
        if report.steps % SESSION == 0 {
            pair = Pair::new(&fresh, new());
            stimulus.restart();
        }
        let context = Context {
            offset: pair.model.offset_counts(),
            tripped: pair.model.mode() == Mode::Tripped,
        };
        let (action, sample) = stimulus.next(&context);
        if let Some(action) = action {
            pair.apply(action);
            report.actions += 1;
        }
        let mode = pair.model.mode();
        match pair.step(sample) {
            Ok(legs) => stimulus.respond(legs),
            Err(differences) => {
                return Err(VerifyError::Mismatch(Box::new(Mismatch {
                    step: report.steps,
                    seed,
                    stream: stimulus.stream(),
                    action,
                    sample,
                    differences,
                })));
            }
        }
        report.count(&pair.model, mode);
    }
    Ok(report)
}

/// A subject and its model in lockstep.
struct Pair<S> {
    subject: S,
    model: BitTrue,
    found: Vec<i32>,
    expected: Vec<i32>,
    before: Vec<i32>,
    remembered: Option<Vec<i32>>,
}

impl<S: Subject> Pair<S> {
    fn new(model: &BitTrue, subject: S) -> Self {
        let words = vec![0; model.state_names().len()];
        let mut pair = Self {
            subject,
            model: model.clone(),
            found: words.clone(),
            expected: words.clone(),
            before: words,
            remembered: None,
        };
        pair.model.state_words(&mut pair.expected);
        pair
    }

    fn apply(&mut self, action: Action) {
        match action {
            Action::SetCurrent(bits) => {
                self.subject.set_current(bits);
                self.model.set_current(bits);
            }
            Action::SetTorque(bits) => {
                self.subject.set_torque(bits);
                self.model.set_torque(bits);
            }
            Action::SetSpeed(bits) => {
                self.subject.set_speed(bits);
                self.model.set_speed(bits);
            }
            Action::SetBus(counts) => {
                self.subject.set_bus(counts);
                self.model.set_bus(counts);
            }
            Action::Reset => {
                self.subject.reset();
                self.model.reset();
            }
            Action::Calibrate => {
                self.subject.calibrate();
                self.model.calibrate();
            }
            Action::Precharge => {
                self.subject.precharge();
                self.model.precharge();
            }
            Action::Stop(stop) => {
                self.subject.stop(stop);
                self.model.stop(stop);
            }
            Action::Remember => self.remembered = Some(self.expected.clone()),
            Action::Recall => {
                if let Some(words) = &self.remembered {
                    self.subject.set_state_words(words);
                    self.model.set_state_words(words);
                }
            }
        }
        // The action's effect on the state is compared as part of the step.
        self.model.state_words(&mut self.expected);
    }

    /// One step of both; returns the differences, if any.
    #[inline]
    fn step(&mut self, sample: Sample) -> Result<AnyCommand, Vec<Difference>> {
        std::mem::swap(&mut self.before, &mut self.expected);
        let found = self.subject.step(&sample);
        let expected = self.model.step(&sample);
        self.subject.state_words(&mut self.found);
        self.model.state_words(&mut self.expected);
        if found == expected
            && self.found == self.expected
            && self.subject.fault() == self.model.fault()
            && self.subject.bus_is_stale() == self.model.bus_is_stale()
        {
            Ok(expected)
        } else {
            Err(self.differences(found, expected))
        }
    }

    #[cold]
    fn differences(&self, found: AnyCommand, expected: AnyCommand) -> Vec<Difference> {
        let mut differences = Vec::new();
        let mut note = |name: &str, before: Option<i32>, found: i32, expected: i32| {
            differences.push(Difference {
                name: name.to_owned(),
                before,
                found,
                expected,
            });
        };
        let words = found.named_words().into_iter().zip(expected.named_words());
        for ((name, found), (_, expected)) in words {
            note(name, None, found.into(), expected.into());
        }
        note(
            "fault()",
            None,
            word_of(self.subject.fault()),
            word_of(self.model.fault()),
        );
        note(
            "bus_is_stale",
            None,
            i32::from(self.subject.bus_is_stale()),
            i32::from(self.model.bus_is_stale()),
        );
        for (index, name) in self.model.state_names().into_iter().enumerate() {
            note(
                name,
                Some(self.before[index]),
                self.found[index],
                self.expected[index],
            );
        }
        differences
    }
}

fn word_of(fault: Option<Fault>) -> i32 {
    fault.map_or(0, |fault| fault as i32)
}
