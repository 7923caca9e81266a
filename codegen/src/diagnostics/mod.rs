//! Diagnostics: what is wrong with a specification, where, and what to change.
//!
//! Stages push into a [`Collector`] and turn it into a `Result` at their barrier; forgetting that
//! panics in debug builds. Every text is built by a constructor of [`catalogue`], every kind of
//! error has one [`Code`]. Rendering goes to text (`file:line:col: error[HX0203]: …`) and to
//! `compile_error!` tokens with the spans of all fields involved.

pub mod catalogue;
mod code;
mod collector;
mod explanation;
mod location;
mod number;
mod render;
mod similar;

pub use code::Code;
pub use collector::{Collector, Diagnostics};
pub use explanation::Explanation;
pub use location::Location;
pub use number::{
    at_least, at_most, engineering, enumerated, frequency, list, percent, rpm, rpm_at_least,
    rpm_at_most, significant,
};
pub use render::Anchors;
pub use similar::{did_you_mean_one, nearest, similar};

/// One error or warning: kind, text and the places involved.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    /// The kind of error.
    pub code: Code,
    /// Quantity, given value with unit, limit, what to change; one sentence or two, no full stop.
    pub message: String,
    /// Where the error is reported.
    pub location: Location,
    /// Further places involved, each with a short text.
    pub notes: Vec<Note>,
}

/// A further place involved in an error.
#[derive(Clone, Debug)]
pub struct Note {
    /// What stands there, e.g. ``first `resistance` ``.
    pub message: String,
    /// Where.
    pub location: Location,
}

impl Diagnostic {
    /// A diagnostic without notes. Texts come from [`catalogue`] only.
    pub(crate) fn new(code: Code, location: &Location, message: impl Into<String>) -> Self {
        Self {
            code,
            message: location.in_its_words(&message.into()),
            location: location.clone(),
            notes: Vec::new(),
        }
    }

    /// Adds a place involved.
    #[must_use]
    pub(crate) fn with_note(mut self, location: &Location, message: impl Into<String>) -> Self {
        self.notes.push(Note {
            message: location.in_its_words(&message.into()),
            location: location.clone(),
        });
        self
    }
}
