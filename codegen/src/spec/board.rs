//! A board under the inverter's own fields.
//!
//! A board is a layer of its own. Its fields stand directly under those of the place that names it:
//! under a motor file's own where that names the board, over them where the call does.

use super::ast::{Board, Field, Name, OF_CORE, Section, SpecAst, TARGET, Value};
use super::fields;
use super::reader::Reader;
use super::sensing::{IN_PHASE, LOW_SIDE};
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, Diagnostic, Location};

/// Fields that a board has and a drive with another setting does without.
const OF_SETTINGS: [(&str, &str, &[&str]); 3] = [
    (
        "v_bus",
        "measured",
        &["bus_adc_bits", "bus_adc_range", "bus_min", "bus_max"],
    ),
    (
        "current_sensing",
        LOW_SIDE,
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

    /// Refuses controller options that are not those of a board's core.
    pub(super) fn refuse_all_but_core(&mut self) {
        let foreign = self.controller.fields.iter();
        let foreign = foreign.filter(|field| !OF_CORE.contains(&field.name.as_str()));
        let errors = foreign
            .map(|field| catalogue::option_of_board(&field.name_location, &field.name, &OF_CORE));
        self.malformed.extend(errors.collect::<Vec<_>>());
    }

    /// The controller, with its board's core where it names none itself. A clock of its own replaces the board's.
    pub(super) fn whole_controller(&self) -> Section {
        let mut whole = self.controller.clone();
        let file = self.board.as_ref().and_then(|board| board.file.as_ref());
        if whole.field(TARGET).is_none() {
            let of_board = file.into_iter().flat_map(|file| &file.core.fields);
            let lacking = of_board.filter(|field| self.controller.field(&field.name).is_none());
            whole.fields.extend(lacking.cloned());
        }
        whole
    }

    /// Greatest bus voltage that the board states and no field of the drive's own replaces, volt.
    pub(super) fn board_bus(&self) -> Option<f64> {
        let board = self.board.as_ref()?;
        let of_board = &board.file.as_ref()?.inverter;
        let (most, _) = limit_of_board(&self.inverter, of_board, "bus_max", &board.name.location)?;
        Some(most)
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
            // What the board would state is not reported as missing.
            let mut own = self.inverter.clone();
            own.incomplete = true;
            return (own, errors);
        };
        errors.extend(file.malformed.iter().cloned());
        let mut whole = file.inverter.clone();
        whole.location = None;
        let location = self.inverter.location.clone();
        whole.overlay(self.inverter.clone());
        whole.location = location.or_else(|| Some(board.name.location.clone()));
        let sections = [&whole, &self.inverter, &file.inverter];
        errors.extend(outside_of_board(sections, &board.name.location));
        errors.extend(sensors_not_there(&whole, &file.inverter));
        for (setting, wanted, fields) in OF_SETTINGS {
            let is_set =
                |field: &Field| matches!(&field.value, Value::Word(word) if word == wanted);
            if !whole.field(setting).is_some_and(is_set) {
                let is_of_board = |field: &Field| {
                    let is_needless = fields.contains(&field.name.as_str());
                    is_needless && self.inverter.field(&field.name).is_none()
                };
                errors.extend(unreadable(&whole, is_of_board, &board.name.location));
                whole.fields.retain(|field| !is_of_board(field));
            }
        }
        (whole, errors)
    }
}

/// Wrong values among fields that nobody reads later.
fn unreadable(
    whole: &Section,
    is_chosen: impl Fn(&Field) -> bool,
    at: &Location,
) -> Vec<Diagnostic> {
    let mut errors = Collector::new();
    let reader = Reader::new("inverter", whole, fields::INVERTER, at);
    for field in whole.fields.iter().filter(|field| is_chosen(field)) {
        let rule = fields::INVERTER.iter().find(|rule| rule.name == field.name);
        match (&field.value, rule) {
            (Value::Malformed(error), _) => errors.push((**error).clone()),
            (_, Some(rule)) => reader.read_number(&mut errors, rule),
            (_, None) => {}
        }
    }
    errors.finish().into_iter().flatten().collect()
}

/// Current sensors that the board does not have: three of two, or sensors in another place. Which two phases have one
/// is a question of names.
fn sensors_not_there(whole: &Section, board: &Section) -> Option<Diagnostic> {
    // The words of sensors that a board may lack; what cannot be read is told of elsewhere.
    let of_sensors = [
        ("sensed_phases", &["abc"][..]),
        ("current_sensing", &[IN_PHASE, LOW_SIDE]),
    ];
    of_sensors.into_iter().find_map(|(name, words)| {
        let (given, own) = (whole.field(name)?, board.field(name)?);
        let Value::Word(word) = &given.value else {
            return None;
        };
        let is_lacking = words.contains(&word.as_str()) && own.value.to_string() != *word;
        is_lacking.then(|| catalogue::sensors_not_there(&part(name, given), &part(name, own)))
    })
}

fn part(field: &'static str, written: &Field) -> Part {
    Part {
        field,
        given: written.value.to_string(),
        location: written.location.clone(),
    }
}

/// A voltage of a section, volt, and as written; none where it cannot be read.
fn volts(section: &Section, name: &'static str, at: &Location) -> Option<(f64, Part)> {
    let reader = Reader::new("inverter", section, fields::INVERTER, at);
    let mut untold = Collector::new();
    let given = reader.plain_quantity(&mut untold, name);
    let is_right = untold.finish().is_none();
    let given = given.filter(|_| is_right)?;
    Some((given.si, given.part))
}

/// A limit of the board, as [`volts`]; none where the drive states its own, which replaces it.
fn limit_of_board(
    own: &Section,
    board: &Section,
    name: &'static str,
    at: &Location,
) -> Option<(f64, Part)> {
    let is_own = own.field(name).is_some();
    volts(board, name, at).filter(|_| !is_own)
}

/// Voltages that are not the board's, or limits that leave none. Values that cannot be read are told of elsewhere.
/// Sections: the whole inverter, the drive's own fields of it, and the board's.
fn outside_of_board([whole, own, board]: [&Section; 3], at: &Location) -> Option<Diagnostic> {
    let volts = |section: &Section, name: &'static str| volts(section, name, at);
    if let (Some((least, low)), Some((most, high))) =
        (volts(board, "bus_min"), volts(board, "bus_max"))
        && least > most
    {
        return Some(catalogue::bus_limits_exchanged(&low, &high));
    }
    let limit = |name: &'static str| limit_of_board(own, board, name, at);
    let (low, high) = (limit("bus_min"), limit("bus_max"));
    ["bus_voltage", "over_voltage"]
        .into_iter()
        .find_map(|name| {
            let (given, part) = volts(whole, name)?;
            // A level of 0 trips nowhere.
            let is_below = |(least, _): &&(f64, Part)| name == "bus_voltage" && given < *least;
            let below = low.as_ref().filter(is_below).map(|limit| ("below", limit));
            let above = high.as_ref().filter(|(most, _)| given > *most);
            let (side, (_, limit)) = below.or(above.map(|limit| ("above", limit)))?;
            Some(catalogue::outside_of_board(&part, side, limit))
        })
}
