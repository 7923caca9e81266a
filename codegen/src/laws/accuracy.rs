//! Accuracy in the type's documentation and data sheet: bounds on the distance from the ideal
//! controller.

use super::constants::fraction_bits;
use crate::diagnostics::significant;
use crate::interface::{PublicConstant, PublicValue};
use crate::ir::{Program, StatedError, stated_errors};
use crate::spec::InverterSpec;
use crate::stopwatch::Part;

/// A number, rounded up.
fn rounded_up(value: f64) -> PublicValue {
    let frac_bits = fraction_bits(value);
    let bits = (value * f64::from(frac_bits).exp2()).ceil() as i32;
    PublicValue::Fixed { bits, frac_bits }
}

/// A bound as a constant, rounded up.
fn bound(name: &str, value: f64, words: f64, unit: &str, meaning: &str) -> PublicConstant {
    PublicConstant {
        name: name.to_owned(),
        value: rounded_up(value),
        doc: vec![format!(
            "{meaning}: at most {} {unit} from the ideal controller, {} units of the last place.",
            significant(value),
            significant(words)
        )],
    }
}

/// Tie band of a decision: twice the error of a score, since both candidates are off; or the error
/// of a current plus that of the band's word.
fn tie_band(stated: &StatedError) -> Option<PublicConstant> {
    let error = stated.rare_bound().unwrap_or(0.0);
    let error = error.max(stated.normal_bound());
    let limit = |value: f64| {
        let words = significant(value / stated.word.value());
        format!(
            "{} {}, {words} units of the last place",
            significant(value),
            stated.unit
        )
    };
    let (value, doc) = match stated.name.as_str() {
        "score" => {
            let value = 2.0 * error;
            let doc = format!(
                "Tie band of the vector choice: the applied vector's ideal score exceeds the least by at most {}, twice the error of a score.",
                limit(value)
            );
            (value, doc)
        }
        "current" => {
            let value = error + stated.word.value();
            let doc = format!(
                "Tie band of the hysteresis: the decision may differ from the ideal one within {} of a band's edge, the error of the current and of the band's word.",
                limit(value)
            );
            (value, doc)
        }
        _ => return None,
    };
    Some(PublicConstant {
        name: "TIE_BAND".to_owned(),
        value: rounded_up(value),
        doc: vec![doc],
    })
}

/// Error bounds such as `DUTY_ERROR`, `DUTY_ERROR_LIMITED` where a limit acts, and `TIE_BAND` of
/// scores and hysteresis. A bound no closer than the inverter's range has no constant.
pub fn accuracy_constants(program: &Program, inverter: &InverterSpec) -> Vec<PublicConstant> {
    let widest = |unit: &str| match unit {
        "V" => inverter.greatest_bus(),
        "V^2" => inverter.greatest_bus().powi(2),
        "A" => inverter.max_current,
        _ => f64::from(inverter.timer_period),
    };
    let mut constants = vec![];
    for stated in Part::ProofRanges.timed(|| stated_errors(program)) {
        let StatedError {
            name,
            doc,
            unit,
            normal,
            rare,
            ..
        } = &stated;
        let name = format!("{}_ERROR", name.to_uppercase());
        let limited = stated.rare_bound().filter(|_| *rare != Some(*normal));
        if stated.normal_bound() < widest(unit) {
            let (value, words) = (stated.normal_bound(), normal.magnitude());
            let meaning = match limited {
                None => doc.clone(),
                Some(limited) if limited < widest(unit) => format!("{doc}, while no limit acts"),
                Some(_) => format!(
                    "{doc}, while no limit acts (at a limit no bound closer than the whole range is known)"
                ),
            };
            constants.push(bound(&name, value, words, unit, &meaning));
        }
        if let (Some(value), Some(rare)) = (limited, rare)
            && value < widest(unit)
        {
            let name = format!("{name}_LIMITED");
            let meaning = format!("{doc}, where a limit acts");
            constants.push(bound(&name, value, rare.magnitude(), unit, &meaning));
        }
        constants.extend(tie_band(&stated));
    }
    constants
}

/// Meaning of the bounds, for the type's documentation.
pub fn accuracy_notes() -> Vec<String> {
    [
        "Constants that end in `_ERROR` bound the distance of one step from the ideal one, which has exact coefficients,",
        "rounds nothing and takes the same decisions (`hexagen::conventions`).",
    ]
    .map(str::to_owned)
    .to_vec()
}
