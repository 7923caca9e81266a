//! Errors of the laboratory.

use crate::counted::CountedError;
use crate::engine::SourceError;
use crate::plant::PlantError;
use hexagen_codegen::diagnostics::{Code, Diagnostics};

/// An error in a motor, a controller, a plant or an argument; its text is complete.
#[derive(Clone, Debug, thiserror::Error)]
pub enum LabError {
    /// The specification, motor file or variant is wrong: all diagnostics, rendered, and the first one's code.
    #[error("{text}")]
    Diagnostics {
        /// The diagnostics.
        text: String,
        /// Code of the first.
        code: Option<Code>,
    },
    /// What is wrong with a file or with a selection, rendered.
    #[error("{0}")]
    Specification(String),
    /// No such motor.
    #[error("error: {0}")]
    Motor(SourceError),
    /// A parameter of the plant is out of range.
    #[error("error: {0}")]
    Plant(#[from] PlantError),
    /// An argument is invalid.
    #[error("error: {0}")]
    Argument(String),
    /// A free shaft in a comparison of fixed speeds.
    #[error("error: the runs have fixed speeds; remove the inertia")]
    FreeShaft,
    /// A step has not been counted.
    #[error("error: {0}")]
    Counted(#[from] CountedError),
}

impl From<SourceError> for LabError {
    fn from(error: SourceError) -> Self {
        match error {
            SourceError::Encoding(diagnostic) => Self::Specification(diagnostic),
            unknown @ SourceError::Unknown { .. } => Self::Motor(unknown),
        }
    }
}

impl From<Diagnostics> for LabError {
    fn from(errors: Diagnostics) -> Self {
        Self::Diagnostics {
            text: errors.to_string(),
            code: errors.as_slice().first().map(|error| error.code),
        }
    }
}
