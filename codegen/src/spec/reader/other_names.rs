//! Names of data sheets for what a field takes in its own way. Spelling says nothing about them:
//! a speed constant is nearer to `torque_constant` by its letters, and its reciprocal by its sense.

use crate::spec::ast::{Field, Value};
use crate::spec::units::Dimension;

const POLES: [&str; 4] = [
    "pole_count",
    "pole_number",
    "number_of_poles",
    "magnet_poles",
];

const SPEED_CONSTANT: [&str; 4] = ["velocity_constant", "kv", "k_v", "kv_rating"];

const TORQUE_CONSTANT: [&str; 4] = ["kt", "k_t", "km", "k_m"];

const EMF_CONSTANT: [&str; 7] = [
    "emf_constant",
    "bemf_constant",
    "bemf",
    "voltage_constant",
    "generator_constant",
    "ke",
    "k_e",
];

/// Ratings as data sheets call them.
const RATINGS: [(&str, &str); 6] = [
    ("nominal_speed", "rated_speed"),
    ("nominal_torque", "rated_torque"),
    ("nominal_current", "rated_current"),
    ("continuous_current", "rated_current"),
    ("continuous_torque", "rated_torque"),
    ("max_continuous_current", "rated_current"),
];

/// Words of data sheets and files for those that fields take.
const WORDS: [(&str, &str); 6] = [
    ("wye", "star"),
    ("y", "star"),
    ("sine", "sinusoidal"),
    ("trapezoid", "trapezoidal"),
    ("true", "on"),
    ("false", "off"),
];

/// The word that another one stands for.
pub(super) fn word(given: &str) -> Option<&'static str> {
    let row = WORDS.iter().find(|(other, _)| *other == given)?;
    Some(row.1)
}

/// The field that takes what the name stands for.
pub(super) fn meant(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let is_in = |names: &[&str]| names.contains(&name.as_str());
    if is_in(&POLES) {
        Some("poles")
    } else if is_in(&SPEED_CONSTANT) {
        Some("speed_constant")
    } else if is_in(&TORQUE_CONSTANT) {
        Some("torque_constant")
    } else if is_in(&EMF_CONSTANT) {
        Some("back_emf")
    } else {
        let rating = RATINGS.iter().find(|(other, _)| *other == name);
        rating.map(|(_, meant)| *meant)
    }
}

/// What to write in the field `meant` for the value of another one, a clause.
pub(super) fn remedy(meant: &str, field: &Field) -> String {
    let Value::Number(number) = &field.value else {
        return format!("did you mean `{meant}`?");
    };
    let dimension = number.unit.as_ref().map(|unit| unit.dimension);
    match meant {
        "poles" => format!("write `poles: {number}`"),
        "speed_constant" if dimension == Some(Dimension::SpeedConstant) => {
            format!("write `speed_constant: {number}`")
        }
        "speed_constant" => "write `speed_constant` with the unit `rpm/V`".to_owned(),
        _ => format!("did you mean `{meant}`?"),
    }
}
