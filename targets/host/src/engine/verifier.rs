//! The bit-for-bit test of one drive, with whatever runs its fixed-point program.

use super::{AnySubject, BuiltIn, EngineKind, Prepared};
use hexagen_reference::verify::{Report, verify_subject};

/// A drive and what runs it.
#[derive(Debug)]
pub struct Verifier<'p> {
    drive: &'p Prepared,
    runner: Runner,
}

#[derive(Debug)]
enum Runner {
    BuiltIn(&'static BuiltIn),
    Interpreter,
}

impl<'p> Verifier<'p> {
    pub(super) fn new(drive: &'p Prepared) -> Self {
        let runner = match drive.built_in() {
            Some(built_in) => Runner::BuiltIn(built_in),
            None => Runner::Interpreter,
        };
        Self { drive, runner }
    }

    /// What runs.
    pub fn kind(&self) -> EngineKind {
        match self.runner {
            Runner::BuiltIn(_) => EngineKind::Compiled,
            Runner::Interpreter => EngineKind::Interpreter,
        }
    }

    /// Compares with the bit-true model over `steps` steps.
    ///
    /// # Errors
    /// What differs, as a table.
    pub fn verify(&self, steps: u64, seed: u64) -> Result<Report, String> {
        let interface = &self.drive.generated.interface;
        match &self.runner {
            Runner::BuiltIn(drive) => verify_subject(
                drive.spec,
                drive.formats,
                drive.state_names,
                || AnySubject((drive.new)()),
                steps,
                seed,
            ),
            Runner::Interpreter => verify_subject(
                &interface.spec_toml,
                &self.drive.formats,
                &self.drive.state_names(),
                || self.drive.interpreted(),
                steps,
                seed,
            ),
        }
        .map_err(|error| error.to_string())
    }
}
