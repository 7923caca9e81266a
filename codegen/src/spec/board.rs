//! A board under the inverter's own fields.
//!
//! A board is a layer of its own. Its fields stand directly under those of the place that names it:
//! under a motor file's own where that names the board, over them where the call does.

use super::ast::{Board, Field, Name, Section, SpecAst, Value};
use crate::diagnostics::Diagnostic;
use crate::diagnostics::catalogue::{self, Part};

/// Fields that a board has and a drive with another setting does without.
const OF_SETTINGS: [(&str, &str, &[&str]); 3] = [
    (
        "v_bus",
        "measured",
        &["bus_adc_bits", "bus_adc_range", "bus_min", "bus_max"],
    ),
    (
        "current_sensing",
        "low_side",
        &[
            "settling_time",
            "aperture_time",
            "conversion_time",
            "current_adcs",
            "sampling_lead",
        ],
    ),
    (
        "sensed_phases",
        "abc",
        &["current_sum_tolerance", "current_sum_samples"],
    ),
];

impl SpecAst {
    /// Replaces the board, and the inverter's own fields that the new one has.
    pub fn put_on(&mut self, board: Board) {
        let over = Self {
            board: Some(board),
            ..Self::new(self.name.clone())
        };
        self.overlay(over);
    }

    /// The inverter with its board's fields under its own, and what is wrong between the two.
    pub(super) fn whole_inverter(&self) -> (Section, Vec<Diagnostic>) {
        let mut errors = vec![];
        let Some(board) = &self.board else {
            return (self.inverter.clone(), errors);
        };
        let Some(file) = &board.file else {
            let Name { text, location } = &board.name;
            errors.push(catalogue::unreadable_board_file(
                location,
                text,
                "it was not looked for",
            ));
            return (self.inverter.clone(), errors);
        };
        errors.extend(file.malformed.iter().cloned());
        let mut whole = file.inverter.clone();
        whole.location = None;
        let location = self.inverter.location.clone();
        whole.overlay(self.inverter.clone());
        whole.location = location.or_else(|| Some(board.name.location.clone()));
        errors.extend(outside_of_board(&whole, &file.inverter));
        errors.extend(sensors_not_there(&whole, &file.inverter));
        for (setting, wanted, fields) in OF_SETTINGS {
            let is_set =
                |field: &Field| matches!(&field.value, Value::Word(word) if word == wanted);
            if !whole.field(setting).is_some_and(is_set) {
                let own = |name: &str| self.inverter.field(name).is_some();
                let name = |field: &Field| fields.contains(&field.name.as_str());
                whole
                    .fields
                    .retain(|field| !name(field) || own(&field.name));
            }
        }
        (whole, errors)
    }
}

/// Current sensors that the board does not have: three of two, or sensors in the phases of a board with some
/// in the low legs. Which two phases have one is a question of names.
fn sensors_not_there(whole: &Section, board: &Section) -> Option<Diagnostic> {
    const MORE: [(&str, &str); 2] = [("sensed_phases", "abc"), ("current_sensing", "in_phase")];
    MORE.into_iter().find_map(|(name, more)| {
        let (given, own) = (whole.field(name)?, board.field(name)?);
        let is_more = |field: &Field| matches!(&field.value, Value::Word(word) if word == more);
        (is_more(given) && !is_more(own))
            .then(|| catalogue::sensors_not_there(&part(name, given), &part(name, own)))
    })
}

fn part(field: &'static str, written: &Field) -> Part {
    Part {
        field,
        given: written.value.to_string(),
        location: written.location.clone(),
    }
}

/// A bus voltage that is not the board's, or limits that leave none.
fn outside_of_board(whole: &Section, board: &Section) -> Option<Diagnostic> {
    let number = |field: Option<&Field>| match field.map(|field| &field.value) {
        Some(Value::Number(number)) => Some(number.si()),
        _ => None,
    };
    let (low, high) = (board.field("bus_min"), board.field("bus_max"));
    if let (Some(least), Some(most)) = (low, high)
        && number(low) > number(high)
    {
        let limits = [part("bus_min", least), part("bus_max", most)];
        return Some(catalogue::bus_limits_exchanged(&limits[0], &limits[1]));
    }
    let given = whole.field("bus_voltage")?;
    let voltage = number(Some(given))?;
    let (side, name, limit) = match (number(low), number(high)) {
        (Some(least), _) if voltage < least => ("below", "bus_min", low),
        (_, Some(most)) if voltage > most => ("above", "bus_max", high),
        _ => return None,
    };
    Some(catalogue::outside_of_board(
        &part("bus_voltage", given),
        side,
        &part(name, limit?),
    ))
}
