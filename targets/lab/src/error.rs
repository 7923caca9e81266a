//! Why the laboratory cannot do what it is asked for.

use crate::counted::CountedError;
use crate::engine::SourceError;
use crate::plant::PlantError;
use hexagen_codegen::diagnostics::Diagnostics;

/// What is wrong with a motor, a controller, a plant or a question; the text is complete.
#[derive(Clone, Debug, thiserror::Error)]
pub enum LabError {
    /// The specification, motor file or variant is wrong: all diagnostics, rendered.
    #[error("{0}")]
    Specification(String),
    /// No such motor.
    #[error("error: {0}")]
    Motor(SourceError),
    /// A parameter of the plant is out of range.
    #[error("error: {0}")]
    Plant(#[from] PlantError),
    /// What is asked for makes no sense.
    #[error("error: {0}")]
    Argument(String),
    /// A free shaft where fixed speeds are compared.
    #[error("error: the sheet is about fixed speeds; leave the inertia out")]
    FreeShaft,
    /// There is no count of a step.
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
        Self::Specification(errors.to_string())
    }
}
