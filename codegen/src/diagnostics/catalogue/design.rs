//! Texts of the design, scaling and verification stages.

use crate::diagnostics::{Code, Diagnostic, Location, percent, significant};

/// The inductance may leave the range in which the loop is stable.
///
/// `given`: the tolerance as written (or `10 % (default)`); `low`, `high`: ratios L_true/L_model
/// between which the loop is stable.
pub fn inductance_outside_stable_range(
    at: &Location,
    given: &str,
    low: f64,
    high: f64,
) -> Diagnostic {
    Diagnostic::new(
        Code::InductanceOutsideStableRange,
        at,
        format!(
            "`inductance_tolerance`: {given}, but with `emf: estimated` the loop is stable only \
             while the true inductance is {} to {} of the stated one; choose `emf: model`, add an \
             `emf_filter` below 1, or narrow the tolerance to {}",
            percent(low),
            percent(high),
            percent(narrowest(low, high)),
        ),
    )
}

/// The resistance may leave the range in which the loop is stable; arguments as for the
/// inductance.
pub fn resistance_outside_stable_range(
    at: &Location,
    given: &str,
    low: f64,
    high: f64,
) -> Diagnostic {
    Diagnostic::new(
        Code::ResistanceOutsideStableRange,
        at,
        format!(
            "`resistance_tolerance`: {given}, but the loop is stable only while the true \
             resistance is {} to {} of the stated one; choose `emf: model`, shorten the control \
             period, or narrow the tolerance to {}",
            percent(low),
            percent(high),
            percent(narrowest(low, high)),
        ),
    )
}

/// Whole percent, rounded down so that the advice holds.
fn narrowest(low: f64, high: f64) -> f64 {
    ((1.0 - low).min(high - 1.0) * 100.0).floor().max(0.0) / 100.0
}

/// The loop is unstable even with the motor exactly as stated; `radius`: largest pole's magnitude.
pub fn unstable_loop(at: &Location, field: &str, given: &str, radius: f64) -> Diagnostic {
    Diagnostic::new(
        Code::Unstable,
        at,
        format!(
            "`{field}`: {given} makes the current loop unstable with the motor as stated (largest \
             pole {}, must be below 1); choose another value or `emf: model`",
            significant(radius),
        ),
    )
}

/// A signal needs more bits than the word has.
///
/// `signal`: its name with the quantity, e.g. ``voltage `u_a` ``; `needed`: bits it needs.
pub fn word_too_narrow(at: &Location, signal: &str, needed: u32, word: u32) -> Diagnostic {
    let remedy = if word < 32 {
        "choose `word: 32`, or lower `adc_bits`"
    } else {
        "lower `adc_bits`, the timer's period or the ADC range"
    };
    Diagnostic::new(
        Code::WordTooNarrow,
        at,
        format!("`word`: {word} bits, but {signal} needs {needed} bits; {remedy}"),
    )
}

/// A coefficient cannot be held in the word with useful precision.
///
/// `error`: relative error it would get; `limit`: the greatest one allowed.
pub fn coefficient_out_of_range(
    at: &Location,
    coefficient: &str,
    value: f64,
    word: u32,
    error: f64,
    limit: f64,
) -> Diagnostic {
    Diagnostic::new(
        Code::CoefficientOutOfRange,
        at,
        format!(
            "`word`: {word} bits hold the coefficient `{coefficient}` = {} with an error of {}, \
             but at most {} is allowed; choose `word: 32`, or change the control period",
            significant(value),
            percent(error),
            percent(limit),
        ),
    )
}

/// The generator broke one of its own invariants: a bug, reported without a panic.
pub fn internal(at: &Location, what: &str) -> Diagnostic {
    Diagnostic::new(
        Code::Internal,
        at,
        format!(
            "the generator broke its own invariant: {what}; this is a bug of hexagen, please report it with the specification"
        ),
    )
}
