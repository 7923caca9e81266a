//! Texts of the design, scaling and verification stages.

use crate::diagnostics::{Code, Diagnostic, Location, percent, significant};

/// The tolerance of a `quantity` leaves the range in which the loop is stable.
///
/// `given`: the tolerance as written (or `10 % (default)`); `low`, `high`: ratios of true to stated
/// value between which the loop is stable; `remedy`: a clause.
pub fn outside_stable_range(
    code: Code,
    at: &Location,
    quantity: &str,
    given: &str,
    (low, high): (f64, f64),
    remedy: &str,
) -> Diagnostic {
    Diagnostic::new(
        code,
        at,
        format!(
            "`{quantity}_tolerance`: {given}, but the loop is stable only while the true \
             {quantity} is {} of the stated one; {remedy} or narrow the tolerance to {}",
            ratios(low, high),
            percent(narrowest(low, high)),
        ),
    )
}

/// The range in words; its search ends at 0.1 and 10.
fn ratios(low: f64, high: f64) -> String {
    if high >= 10.0 {
        format!("at least {}", percent(low))
    } else if low <= 0.1 {
        format!("at most {}", percent(high))
    } else {
        format!("{} to {}", percent(low), percent(high))
    }
}

/// Whole percent, rounded down so that the advice holds.
fn narrowest(low: f64, high: f64) -> f64 {
    ((1.0 - low).min(high - 1.0) * 100.0 + 1e-6)
        .floor()
        .max(0.0)
        / 100.0
}

/// The loop is unstable with the nominal motor; `radius`: magnitude of the largest pole;
/// `remedy`: a clause.
pub fn unstable_loop(
    at: &Location,
    field: &str,
    given: &str,
    radius: f64,
    remedy: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::Unstable,
        at,
        format!(
            "`{field}`: {given} makes the current loop unstable with the motor as stated (largest \
             pole {}, must be below 1); {remedy}",
            significant(radius),
        ),
    )
}

/// A signal needs more bits than the word has.
///
/// `signal`: quantity and name, e.g. ``voltage `u_a` ``; `needed`: bits needed, where known.
pub fn word_too_narrow(at: &Location, signal: &str, needed: Option<u32>, word: u32) -> Diagnostic {
    let remedy = if word < 32 {
        "choose `word: 32`, or lower `adc_bits`"
    } else {
        "lower `adc_bits`, the timer's period or the ADC range"
    };
    let lack = match needed {
        Some(needed) => format!("{word} bits, but {needed} are needed for {signal}"),
        None => format!("{word} bits are too few for {signal}"),
    };
    Diagnostic::new(Code::WordTooNarrow, at, format!("`word`: {lack}; {remedy}"))
}

/// An internal error: a bug, reported without a panic.
pub fn internal(at: &Location, what: &str) -> Diagnostic {
    Diagnostic::new(
        Code::Internal,
        at,
        format!(
            "internal error of the generator: {what}; this is a bug in hexagen, please report it with the specification"
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_of_the_later_stages() {
        let at = Location::File {
            file: "m.toml".into(),
            line: 3,
            column: 5,
        };
        let cases = [
            (
                outside_stable_range(
                    Code::InductanceOutsideStableRange,
                    &at,
                    "inductance",
                    "30 %",
                    (0.83, 1.257),
                    "choose `emf: model`",
                ),
                "m.toml:3:5: error[HX0501]: `inductance_tolerance`: 30 %, but the loop is stable only while the true inductance is 83 % to 125.7 % of the stated one; choose `emf = \"model\"` or narrow the tolerance to 17 %",
            ),
            (
                outside_stable_range(
                    Code::ResistanceOutsideStableRange,
                    &at,
                    "resistance",
                    "30 % (default)",
                    (0.1, 1.2),
                    "lower `bandwidth`",
                ),
                "m.toml:3:5: error[HX0502]: `resistance_tolerance`: 30 % (default), but the loop is stable only while the true resistance is at most 120 % of the stated one; lower `bandwidth` or narrow the tolerance to 20 %",
            ),
            (
                unstable_loop(&at, "emf_filter", "0.001", 1.25, "choose `emf: model`"),
                "m.toml:3:5: error[HX0503]: `emf_filter`: 0.001 makes the current loop unstable with the motor as stated (largest pole 1.25, must be below 1); choose `emf = \"model\"`",
            ),
            (
                word_too_narrow(&at, "voltage `u_a`", Some(19), 16),
                "m.toml:3:5: error[HX0504]: `word`: 16 bits, but 19 are needed for voltage `u_a`; choose `word = 32`, or lower `adc_bits`",
            ),
            (
                word_too_narrow(&at, "coefficient `k_di`", None, 32),
                "m.toml:3:5: error[HX0504]: `word`: 32 bits are too few for coefficient `k_di`; lower `adc_bits`, the timer's period or the ADC range",
            ),
            (
                internal(&at, "node 7 has no interval"),
                "m.toml:3:5: error[HX0901]: internal error of the generator: node 7 has no interval; this is a bug in hexagen, please report it with the specification",
            ),
        ];
        for (error, text) in cases {
            assert_eq!(error.to_string(), text);
        }
    }
}
