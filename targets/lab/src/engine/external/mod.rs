//! Emitted code that is not built in, in Rust or C: compiled and run as a process.
//!
//! The runtime's sources are part of this program, so only a compiler is needed. Emitted code and
//! runtime use only type names, `from_bits` and `to_bits` of the `fixed` crate, which a stand-in
//! provides; it changes no arithmetic.

mod build;
mod link;

pub use build::{Binding, BuildError, External, compile, compile_c99};

use hexagen::{Fault, Format, LegState, Legs, Sample};
use hexagen_reference::verify::{Report, Subject, VerifyError, verify_subject};
use hexagen_reference::{AnyCommand, BitTrue, Stop};
use link::{Call, Link, LinkError};
use std::cell::RefCell;

/// Inputs of a bit-for-bit test besides the process.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms<'a> {
    pub spec: &'a str,
    pub formats: &'a [Format],
    pub state_names: &'a [&'a str],
    pub model: &'a BitTrue,
}

/// Failure of the test of an external program.
#[derive(Debug, thiserror::Error)]
pub enum ExternalError {
    /// It differs.
    #[error(transparent)]
    Verify(#[from] VerifyError),
    /// The process stopped.
    #[error("the compiled program stopped: {0}")]
    Link(#[from] LinkError),
    /// It differs in a batch, but not step by step: an error of the link.
    #[error("step {0} differs in a batch of steps only")]
    Batch(u64),
}

/// Compares an external program with the bit-true model. Calls are sent in batches, and a second
/// model predicts the answers; only if a batch differs is the run repeated step by step, to find
/// the difference.
pub(super) fn verify(
    external: &External,
    terms: Terms<'_>,
    steps: u64,
    seed: u64,
) -> Result<Report, ExternalError> {
    let run = |steps: u64, link: &RefCell<Link>, is_batched: bool| {
        let new = || {
            link.borrow_mut().send(Call::New);
            Remote {
                link,
                model: is_batched.then(|| terms.model.clone()),
                words: vec![0; terms.state_names.len()],
                fault: None,
                bus_is_stale: false,
            }
        };
        verify_subject(
            terms.spec,
            terms.formats,
            terms.state_names,
            new,
            steps,
            seed,
        )
    };
    let link = RefCell::new(Link::open(external, &terms)?);
    let report = run(steps, &link, true)?;
    let Some(step) = link.into_inner().close()? else {
        return Ok(report);
    };
    let link = RefCell::new(Link::open(external, &terms)?);
    run(step + 1, &link, false)?;
    link.into_inner().close()?;
    Err(ExternalError::Batch(step))
}

/// The external program as the test's subject: with a model, the model answers and the program's
/// answers are compared later; without one, every step waits for the program.
struct Remote<'l> {
    link: &'l RefCell<Link>,
    model: Option<BitTrue>,
    words: Vec<i32>,
    fault: Option<Fault>,
    bus_is_stale: bool,
}

impl Remote<'_> {
    fn call(&mut self, call: Call, on_model: impl FnOnce(&mut BitTrue)) {
        self.link.borrow_mut().send(call);
        if let Some(model) = &mut self.model {
            on_model(model);
        }
    }
}

impl Subject for Remote<'_> {
    fn step(&mut self, sample: &Sample) -> AnyCommand {
        let mut link = self.link.borrow_mut();
        match &mut self.model {
            Some(model) => {
                let command = model.step(sample);
                model.state_words(&mut self.words);
                self.fault = model.fault();
                self.bus_is_stale = model.bus_is_stale();
                let status = (self.fault, self.bus_is_stale);
                link.step(*sample, command, status, &self.words);
                command
            }
            None => match link.step_and_wait(*sample, &mut self.words) {
                Some((command, fault, bus_is_stale)) => {
                    self.fault = fault;
                    self.bus_is_stale = bus_is_stale;
                    command
                }
                // After a broken pipe the answer is invalid; the link reports the cause.
                None => Legs::new([u16::MAX; 3], [LegState::Off; 3]).into(),
            },
        }
    }

    fn set_current(&mut self, bits: i32) {
        self.call(Call::SetCurrent(bits), |model| model.set_current(bits));
    }

    fn set_torque(&mut self, bits: i32) {
        self.call(Call::SetTorque(bits), |model| model.set_torque(bits));
    }

    fn set_speed(&mut self, bits: i32) {
        self.call(Call::SetSpeed(bits), |model| model.set_speed(bits));
    }

    fn set_bus(&mut self, counts: u16) {
        self.call(Call::SetBus(counts), |model| model.set_bus(counts));
    }

    fn reset(&mut self) {
        self.call(Call::Reset, BitTrue::reset);
    }

    fn calibrate(&mut self) {
        self.call(Call::Calibrate, BitTrue::calibrate);
    }

    fn precharge(&mut self) {
        self.call(Call::Precharge, BitTrue::precharge);
    }

    fn stop(&mut self, stop: Stop) {
        self.call(Call::Stop(stop), |model| model.stop(stop));
    }

    fn fault(&self) -> Option<Fault> {
        self.fault
    }

    fn bus_is_stale(&self) -> bool {
        self.bus_is_stale
    }

    fn state_words(&self, words: &mut [i32]) {
        words.copy_from_slice(&self.words);
    }

    fn set_state_words(&mut self, words: &[i32]) {
        self.call(Call::SetStateWords(words), |model| {
            model.set_state_words(words);
        });
    }
}
