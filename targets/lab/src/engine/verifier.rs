//! The bit-for-bit test of one drive, by the best available engine of its fixed-point program.

use super::external::{Binding, BuildError, External, Terms, compile, compile_c99, verify};
use super::{AnySubject, BuiltIn, EngineKind, Prepared};
use crate::standalone::derived;
use hexagen_codegen::emit::c99::emit_c99;
use hexagen_codegen::emit::rust::{Surface, emit_rust, format_rust};
use hexagen_codegen::ir::Demand;
use hexagen_reference::verify::{Report, verify_subject};

/// A drive and its engine.
#[derive(Debug)]
pub struct Verifier<'p> {
    drive: &'p Prepared,
    runner: Runner,
}

#[derive(Debug)]
enum Runner {
    BuiltIn(&'static BuiltIn),
    External(External),
    Interpreter(BuildError),
}

impl<'p> Verifier<'p> {
    /// Uses the compiled drive, else compiles it, else uses the interpreter.
    pub(super) fn new(drive: &'p Prepared) -> Self {
        let runner = drive.built_in().map_or_else(
            || match compile_emitted(drive) {
                Ok(external) => Runner::External(external),
                Err(error) => Runner::Interpreter(error),
            },
            Runner::BuiltIn,
        );
        Self { drive, runner }
    }

    /// Compiles the drive's C, by `CC` with these flags after strict ones.
    ///
    /// # Errors
    /// No C compiler, or its messages.
    pub fn of_c99(drive: &'p Prepared, flags: &str) -> Result<Self, BuildError> {
        let generated = &drive.generated;
        let (interface, program) = (&generated.interface, generated.graph.program());
        let sources = emit_c99(&generated.graph, interface, &interface.type_name);
        let binding = Binding {
            state_words: drive.state_names().len(),
            has_bus: interface.bus_periods.is_some(),
            has_speed: program.param(Demand::Speed).is_some(),
            has_intervals: program.has_intervals(),
        };
        let external = compile_c99(&sources, &binding, flags)?;
        Ok(Self {
            drive,
            runner: Runner::External(external),
        })
    }

    /// The engine.
    pub fn kind(&self) -> EngineKind {
        match self.runner {
            Runner::BuiltIn(_) | Runner::External(_) => EngineKind::Compiled,
            Runner::Interpreter(_) => EngineKind::Interpreter,
        }
    }

    /// Why no compiled code runs, if so.
    pub fn why_interpreted(&self) -> Option<&BuildError> {
        match &self.runner {
            Runner::Interpreter(error) => Some(error),
            _ => None,
        }
    }

    /// Compares with the bit-true model over `steps` steps.
    ///
    /// # Errors
    /// The differences, as a table.
    pub fn verify(&self, steps: u64, seed: u64) -> Result<Report, String> {
        let Self { drive, runner } = self;
        let spec = &drive.generated.interface.spec_toml;
        let names = drive.state_names();
        match runner {
            Runner::BuiltIn(built_in) => verify_subject(
                built_in.spec,
                built_in.formats,
                &(built_in.state_names)(),
                || AnySubject((built_in.new)()),
                steps,
                seed,
            )
            .map_err(|error| error.to_string()),
            Runner::External(external) => {
                let terms = Terms {
                    spec,
                    formats: &drive.formats,
                    state_names: &names,
                    model: &drive.bit_true(),
                };
                verify(external, terms, steps, seed).map_err(|error| error.to_string())
            }
            Runner::Interpreter(_) => {
                let new = || drive.interpreted();
                verify_subject(spec, &drive.formats, &names, new, steps, seed)
                    .map_err(|error| error.to_string())
            }
        }
    }
}

fn compile_emitted(drive: &Prepared) -> Result<External, BuildError> {
    let generated = &drive.generated;
    let name = &generated.interface.type_name;
    let surface = Surface::public(name);
    let tokens = emit_rust(&generated.graph, &generated.interface, &surface);
    compile(&format_rust(&derived(tokens)), name)
}
