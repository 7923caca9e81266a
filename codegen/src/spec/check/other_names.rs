//! Other names for fields, common in data sheets. Spelling cannot find them: `speed_constant` is
//! spelt like `torque_constant`, but means the reciprocal of `back_emf`.

use crate::spec::ast::{Field, Value};
use crate::spec::units::Dimension;

const POLES: [&str; 5] = [
    "poles",
    "pole_count",
    "pole_number",
    "number_of_poles",
    "magnet_poles",
];

const SPEED_CONSTANT: [&str; 5] = [
    "speed_constant",
    "velocity_constant",
    "kv",
    "k_v",
    "kv_rating",
];

const EMF_CONSTANT: [&str; 7] = [
    "emf_constant",
    "bemf_constant",
    "bemf",
    "voltage_constant",
    "generator_constant",
    "ke",
    "k_e",
];

/// The field that a name stands for.
pub(super) fn meant(name: &str) -> Option<&'static str> {
    let name = name.to_lowercase();
    let is_in = |names: &[&str]| names.contains(&name.as_str());
    if is_in(&POLES) {
        Some("pole_pairs")
    } else if is_in(&SPEED_CONSTANT) || is_in(&EMF_CONSTANT) {
        Some("back_emf")
    } else {
        None
    }
}

/// What to write in the field `meant` in place of `field`, a clause.
pub(super) fn remedy(meant: &str, field: &Field) -> String {
    let number = match &field.value {
        Value::Number(number) => Some(number),
        _ => None,
    };
    if meant == "pole_pairs" {
        let half = number.map(|number| number.si() / 2.0);
        return match half.filter(|half| half.fract() == 0.0 && *half > 0.0) {
            Some(half) => format!("write `pole_pairs: {half}`, half of the poles"),
            None => "write `pole_pairs`, half of the poles".to_owned(),
        };
    }
    if SPEED_CONSTANT.contains(&field.name.to_lowercase().as_str()) {
        let dimension = number.and_then(|number| Some(number.unit?.dimension));
        let setting = match number {
            Some(number) if dimension == Some(Dimension::SpeedConstant) => {
                format!("`back_emf: {number}`")
            }
            _ => "`back_emf` with the unit `rpm/V`".to_owned(),
        };
        return format!("write {setting}: speed over the line-to-line peak of the EMF");
    }
    "did you mean `back_emf`?".to_owned()
}
