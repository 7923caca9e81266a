//! Texts about single values: spelling, unit, basis, limits.

use super::structure::did_you_mean;
use crate::diagnostics::{Code, Diagnostic, Location, list};

/// A value that cannot be read.
pub fn malformed_value(at: &Location, field: &str, given: &str, example: &str) -> Diagnostic {
    Diagnostic::new(
        Code::MalformedValue,
        at,
        format!("`{field}`: cannot read `{given}`; write it like `{example}`"),
    )
}

/// A unit that does not exist.
pub fn unknown_unit(
    at: &Location,
    field: &str,
    given: &str,
    unit: &str,
    nearest: Option<&str>,
    example: &str,
) -> Diagnostic {
    let advice = nearest.map_or_else(
        || format!("write it like `{example}`"),
        |symbol| format!("did you mean `{symbol}`?"),
    );
    Diagnostic::new(
        Code::UnknownUnit,
        at,
        format!("`{field}`: {given} has the unknown unit `{unit}`; {advice}"),
    )
}

/// A unit of another quantity.
pub fn wrong_dimension(
    at: &Location,
    field: &str,
    given: &str,
    got: &str,
    wanted: &str,
    example: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::WrongDimension,
        at,
        format!("`{field}`: {given} is {got}, but {wanted} is wanted; write it like `{example}`"),
    )
}

/// A number without unit.
pub fn missing_unit(at: &Location, field: &str, given: &str, example: &str) -> Diagnostic {
    Diagnostic::new(
        Code::MissingUnit,
        at,
        format!("`{field}`: {given} has no unit; write it like `{example}`"),
    )
}

/// A unit or basis on a plain number.
pub fn unwanted_unit(at: &Location, field: &str, given: &str, plain: &str) -> Diagnostic {
    Diagnostic::new(
        Code::UnwantedUnit,
        at,
        format!("`{field}`: {given} has a unit, but a plain number is wanted; write `{plain}`"),
    )
}

/// A value without its basis; `wanted` names the words, `example` shows them with the value.
pub fn missing_basis(
    at: &Location,
    field: &str,
    given: &str,
    wanted: &[&str],
    example: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::MissingBasis,
        at,
        format!(
            "`{field}`: {given} does not say its basis; add {}, for example `{example}`",
            list(wanted, "or"),
        ),
    )
}

/// A basis that the value cannot have; `remedy` is a clause.
pub fn wrong_basis(
    at: &Location,
    field: &str,
    given: &str,
    basis: &str,
    remedy: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::WrongBasis,
        at,
        format!("`{field}`: {given} cannot be taken as `{basis}`; {remedy}"),
    )
}

/// A word that the field does not take.
pub fn unknown_word(at: &Location, field: &str, given: &str, known: &[&str]) -> Diagnostic {
    Diagnostic::new(
        Code::UnknownWord,
        at,
        format!(
            "`{field}`: unknown word `{given}`; it takes {}{}",
            list(known, "or"),
            did_you_mean(given, known)
        ),
    )
}

/// A value of the wrong kind; `wanted` with article, e.g. `a number with a unit`.
pub fn wrong_kind(
    at: &Location,
    field: &str,
    given: &str,
    wanted: &str,
    example: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::WrongKind,
        at,
        format!("`{field}`: {given}, but {wanted} is wanted; write it like `{example}`"),
    )
}

/// Zero or negative where a positive value is wanted; `low`, `high`: plausible limits.
pub fn not_positive(at: &Location, field: &str, given: &str, low: &str, high: &str) -> Diagnostic {
    Diagnostic::new(
        Code::NotPositive,
        at,
        format!("`{field}`: {given} is not above zero; give a value from {low} to {high}"),
    )
}

/// Zero or negative where a positive value is wanted, without stated limits.
pub fn not_above_zero(at: &Location, field: &str, given: &str, example: &str) -> Diagnostic {
    Diagnostic::new(
        Code::NotPositive,
        at,
        format!("`{field}`: {given} is not above zero; write it like `{example}`"),
    )
}

/// A value outside its plausible or possible limits.
pub fn out_of_range(at: &Location, field: &str, given: &str, low: &str, high: &str) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!("`{field}`: {given} lies outside {low} to {high}; check the number and its unit"),
    )
}

/// A plain number outside its possible limits.
pub fn out_of_limits(at: &Location, field: &str, given: &str, low: &str, high: &str) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!("`{field}`: {given} lies outside {low} to {high}; give a value within"),
    )
}

/// A plain number that is not one of the few that are possible.
pub fn not_one_of(at: &Location, field: &str, given: &str, choices: &[&str]) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`{field}`: {given} is not possible; give {}",
            list(choices, "or")
        ),
    )
}

/// A count that is no power of two.
pub fn not_a_power_of_two(
    at: &Location,
    field: &str,
    given: &str,
    below: u32,
    above: u32,
) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!("`{field}`: {given} is not a power of two; give {below} or {above}"),
    )
}

/// Hall codes that are no Hall sequence; `why` is a clause.
pub fn hall_codes(at: &Location, given: &str, why: &str) -> Diagnostic {
    Diagnostic::new(
        Code::HallCodes,
        at,
        format!(
            "`hall_codes`: {given}: {why}; give the codes of sectors 1 to 6, each of 1 to 6 once and one bit apart, for example `[1, 5, 4, 6, 2, 3]`"
        ),
    )
}
