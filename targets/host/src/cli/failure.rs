//! Why a command did not succeed.

use crate::checker::Missing;
use crate::render::RenderError;
use hexagen_lab::LabError;
use hexagen_lab::closed_loop::Trip;
use hexagen_lab::engine::BuildError;
use hexagen_lab::plant::PlantError;
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// The JSON object of a command that has no result.
#[derive(Clone, Debug, Serialize)]
pub struct ErrorAlone {
    /// The message.
    pub error: String,
}

/// A command's failure; the text is complete, the kind gives the exit code.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A check failed; its result is already on stdout. The text is for stderr.
    #[error("{0}")]
    Check(String),
    /// An error of the laboratory.
    #[error(transparent)]
    Lab(#[from] LabError),
    /// An argument that contradicts the others.
    #[error("error: {0}")]
    Argument(String),
    /// A file cannot be written.
    #[error("error: cannot write {}: {reason}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        reason: String,
    },
    /// The proof checker is missing.
    #[error("error: {0}")]
    Checker(#[from] Missing),
    /// Emitted code cannot be compiled.
    #[error("error: {0}")]
    Compiler(#[from] BuildError),
    /// The report's page cannot be written.
    #[error("error: {0}")]
    Report(#[from] RenderError),
}

impl From<PlantError> for Failure {
    fn from(error: PlantError) -> Self {
        Self::Lab(error.into())
    }
}

impl Failure {
    /// A failed check where a drive tripped.
    ///
    /// # Errors
    /// The trip.
    pub fn of_trip(trip: Option<Trip>) -> Result<(), Self> {
        trip.map_or(Ok(()), |trip| Err(Self::Check(format!("error: {trip}"))))
    }

    /// Prints the failure on stderr.
    pub fn print(&self) {
        super::note(&self.to_string());
    }

    /// What takes the place of a result; none where the result is on stdout already.
    pub fn without_result(&self) -> Option<ErrorAlone> {
        let text = self.to_string();
        let error = text.strip_prefix("error: ").unwrap_or(&text).to_owned();
        (!matches!(self, Self::Check(_))).then_some(ErrorAlone { error })
    }

    /// 1 for a failed check, 2 for bad input.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Check(_) => ExitCode::from(1),
            _ => ExitCode::from(2),
        }
    }
}
