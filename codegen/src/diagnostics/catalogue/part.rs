//! A field of a diagnostic about several.

use crate::diagnostics::{Diagnostic, Location};

/// A field involved in a contradiction: name, value and place.
#[derive(Clone, Debug)]
pub struct Part {
    /// The field's name.
    pub field: &'static str,
    /// The value as written, or as it results from the default.
    pub given: String,
    /// Where it was written.
    pub location: Location,
}

impl Part {
    pub(super) fn quoted(&self) -> String {
        format!("`{}` {}", self.field, self.given)
    }
}

/// An error with notes at the other fields.
pub(super) fn with_parts(mut error: Diagnostic, parts: &[&Part]) -> Diagnostic {
    for part in parts {
        error = error.with_note(&part.location, part.quoted());
    }
    error
}
