//! Errors in the data of the reference models.

/// Error of building a reference model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The text is not a normalised specification.
    #[error("the specification does not read as normalised TOML: {0}")]
    Syntax(String),
    /// A field's value is invalid.
    #[error("specification field `{field}` is {value}: {expected}")]
    Field {
        /// Dotted name of the field.
        field: &'static str,
        /// The value given.
        value: String,
        /// Valid values.
        expected: &'static str,
    },
    /// A field required by other fields is missing.
    #[error("specification field `{field}` is missing: {reason}")]
    Missing {
        /// Dotted name of the field.
        field: &'static str,
        /// Reason of the requirement.
        reason: &'static str,
    },
    /// The format table has no entry of this name.
    #[error("the format table has no entry `{0}`")]
    NoFormat(&'static str),
    /// An entry of the format table is invalid.
    #[error("format `{name}` has frac_bits = {frac_bits}: {expected}")]
    Format {
        /// The entry's name.
        name: &'static str,
        /// Its fraction bits.
        frac_bits: i32,
        /// Valid values.
        expected: &'static str,
    },
    /// The number of segments of a table is invalid.
    #[error("table `{name}` has {segments} segments: expected 12, 24, 48 or 96")]
    Segments {
        /// The entry's name.
        name: &'static str,
        /// Its segments.
        segments: u8,
    },
    /// A coefficient does not fit its word.
    #[error("coefficient `{name}` is {raw}, wider than a 32-bit word")]
    Range {
        /// The coefficient's name.
        name: &'static str,
        /// Its value as a word.
        raw: f64,
    },
}
