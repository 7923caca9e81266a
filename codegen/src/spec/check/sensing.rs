//! The current sensors: where they are, and what a count of each is worth.

use crate::diagnostics::catalogue;
use crate::diagnostics::{Collector, Diagnostic};
use crate::spec::reader::Reader;
use crate::spec::sensing::SensingTimes;
use crate::spec::{CurrentSensing, SensedPhases};

/// What was read of the sensors' place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sensing {
    /// The phases that have a sensor.
    pub stated: SensedPhases,
    /// Those whose sensors are read: two of them.
    pub phases: SensedPhases,
    /// None together with an error.
    pub place: Option<CurrentSensing>,
    /// Second.
    pub minimum_low_time: f64,
}

impl Sensing {
    /// Whether legs must be low for a while in every period.
    pub fn must_be_low(&self) -> bool {
        matches!(self.place, Some(CurrentSensing::LowSide(_))) || self.minimum_low_time > 0.0
    }

    /// Whether all three currents are known while a leg is off: that of an off leg whose upper diode conducts does not
    /// flow through its low leg.
    pub fn reads_off_legs(&self) -> bool {
        !matches!(self.place, Some(CurrentSensing::LowSide(_)))
    }
}

const SENSED_PHASES: &str = "sensed_phases";

pub(super) fn read(reader: &Reader, errors: &mut Collector) -> Sensing {
    let stated = reader
        .choice(errors, SENSED_PHASES, &[])
        .unwrap_or(SensedPhases::Ab);
    Sensing {
        stated,
        phases: match stated {
            SensedPhases::Abc => SensedPhases::Ab,
            two => two,
        },
        place: read_place(reader, errors),
        minimum_low_time: time(reader, errors, "minimum_low_time").unwrap_or(0.0),
    }
}

fn time(reader: &Reader, errors: &mut Collector, name: &'static str) -> Option<f64> {
    reader.plain_quantity(errors, name).map(|given| given.si)
}

/// In the phase by default; sensors in the low leg need their times, others take none.
fn read_place(reader: &Reader, errors: &mut Collector) -> Option<CurrentSensing> {
    const FIELD: &str = "current_sensing";
    const NEEDED: [(&str, &str); 3] = [
        ("settling_time", "1 us"),
        ("aperture_time", "200 ns"),
        ("conversion_time", "0 us"),
    ];
    let [settling, aperture, conversion, lead] = [
        "settling_time",
        "aperture_time",
        "conversion_time",
        "sampling_lead",
    ]
    .map(|name| time(reader, errors, name));
    let is_low = reader
        .word(errors, FIELD, &[("in_phase", false), ("low_side", true)])
        .or_else(|| reader.field(FIELD).is_none().then_some(false))?;
    if !is_low {
        let names = NEEDED.map(|(name, _)| name);
        for name in names.into_iter().chain(["sampling_lead"]) {
            if let Some(field) = reader.field(name) {
                let (at, given) = (&field.location, field.value.to_string());
                let setting = "current_sensing: low_side";
                errors.push(catalogue::needless_field(at, name, &given, setting));
            }
        }
        return Some(CurrentSensing::InPhase);
    }
    for (name, example) in NEEDED {
        if reader.field(name).is_none() {
            let at = reader
                .field(FIELD)
                .map_or(reader.location(), |field| &field.location);
            let setting = "current_sensing: low_side";
            errors.push(catalogue::needed_field(at, setting, name, example));
        }
    }
    Some(CurrentSensing::LowSide(SensingTimes {
        settling: settling?,
        aperture: aperture?,
        conversion: conversion?,
        lead: lead.unwrap_or(0.0),
    }))
}

/// The warning that a sensor is not read, if one is not.
pub(super) fn unread(reader: &Reader, sensing: &Sensing) -> Option<Diagnostic> {
    let field = reader.field(SENSED_PHASES)?;
    (sensing.phases != sensing.stated).then(|| catalogue::unread_sensor(&field.location))
}

/// Values of a field that may hold one of each sensed phase: one for all, or as many as there are phases.
pub(super) fn of_each_phase<T: Clone>(
    reader: &Reader,
    name: &'static str,
    phases: SensedPhases,
    errors: &mut Collector,
    read: impl Fn(&Reader, &mut Collector) -> Option<T>,
) -> Option<Vec<T>> {
    let count = phases.phases().len();
    let values = reader.each(name, |one| read(one, errors))?;
    match values.as_slice() {
        [one] => Some(vec![one.clone(); count]),
        values if values.len() == count => Some(values.to_vec()),
        values => {
            let part = reader.part(name, String::new);
            let named = reader.part("sensed_phases", || "ab".to_owned());
            let given = values.len();
            errors.push(catalogue::not_of_each_phase(&part, &named, given, count));
            None
        }
    }
}
