//! The current sensors: where they are, and what a count of each is worth.

use super::inverter::Inverter;
use super::motor::Motor;
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, engineering};
use crate::spec::reader::Reader;
use crate::spec::sensing::{IN_PHASE, LOW_SIDE, SensingTimes};
use crate::spec::{ControllerSpec, CurrentSensing, SensedPhases};

/// What was read of the sensors' place.
#[derive(Clone, Debug)]
pub(super) struct Sensing {
    /// The phases that have a sensor.
    pub phases: SensedPhases,
    /// When the currents of three sensors do not add up; None for what is as by default.
    pub sum_tolerance: Option<f64>,
    pub sum_samples: Option<u32>,
    /// None together with an error.
    pub place: Option<CurrentSensing>,
    /// `current_sensing`, if that is `low_side`.
    pub low_side: Option<Part>,
    /// Second.
    pub minimum_low_time: f64,
    /// `minimum_low_time`, if that is above 0.
    pub low_time: Option<Part>,
}

impl Sensing {
    /// Whether legs must be low for a while in every period.
    pub fn must_be_low(&self) -> bool {
        matches!(self.place, Some(CurrentSensing::LowSide(_))) || self.minimum_low_time > 0.0
    }

    /// Whether all three currents are known while a leg is off: that of an off leg whose upper diode conducts does not
    /// flow through its low leg. Of three sensors the other two show it, if they are read before the next command may
    /// turn one of their legs off.
    pub fn reads_off_legs(&self) -> bool {
        match self.place {
            Some(CurrentSensing::LowSide(times)) => {
                let is_early = times.window(0.0, self.phases.phases().len()).after <= 1e-12;
                self.phases == SensedPhases::Abc && is_early
            }
            _ => true,
        }
    }
}

const SENSED_PHASES: &str = "sensed_phases";

const LEAD: &str = "sampling_lead";

/// Share of the rated current from which on it is felt that currents are sampled before the middle of pulses which the
/// dead time delays.
const FELT_DELAY: f64 = 0.005;

/// The sampling instant of sensors in the low legs, which depends on motor and controller. By default it is the turning
/// point, at which the timer's update triggers. Where the current moves too far until the middle of the delayed pulses,
/// it is so much later that the mean of all conversions comes there. It stays at the turning point for a command
/// without computation delay, which acts from there on; for a leg that is turned off, which has to be read before that;
/// and where the window would become longer behind the turning point than before it, which would take voltage.
pub(super) fn place_instant(
    reader: &Reader,
    inverter: &mut Inverter,
    motor: &Motor,
    controller: Option<&ControllerSpec>,
    errors: &mut Collector,
) -> Option<()> {
    let controller = controller?;
    let delay = controller.common().delay;
    let phases = inverter.sensing.phases.phases().len();
    let CurrentSensing::LowSide(times) = inverter.sensing.place.as_mut()? else {
        return None;
    };
    if let Some(field) = reader.field(LEAD) {
        if delay == 0 && times.lead < 0.0 {
            errors.push(catalogue::out_of_limits(
                &field.location,
                LEAD,
                &engineering(times.lead, "s"),
                "0 s (with a `delay` of 0 the command acts from the turning point on; 1 allows it)",
                "100 us",
            ));
        }
        return None;
    }
    let dead_time = inverter.dead_time.as_ref()?.si;
    let late = dead_time / 2.0 - times.mean_of_conversions(phases);
    let emf = motor.emf_constant? * motor.rated_speed.as_ref()?.si;
    let moved = emf * late / motor.inductance?;
    let is_felt = moved > FELT_DELAY * motor.rated_current.as_ref()?.si;
    let placed = SensingTimes {
        lead: -late,
        ..*times
    };
    let window = placed.window(dead_time, phases);
    if delay > 0 && is_felt && controller.turns_off().is_none() && window.after <= window.before {
        *times = placed;
    }
    Some(())
}

pub(super) fn read(reader: &Reader, errors: &mut Collector) -> Sensing {
    let phases = reader
        .choice(errors, SENSED_PHASES, &[])
        .unwrap_or(SensedPhases::Ab);
    if phases != SensedPhases::Abc {
        let names = ["current_sum_tolerance", "current_sum_samples"];
        reader.refuse_without(errors, "sensed_phases: abc", &names);
    }
    let place = read_place(reader, errors);
    let minimum_low_time = time(reader, errors, "minimum_low_time").unwrap_or(0.0);
    let is_low = matches!(place, Some(CurrentSensing::LowSide(_)));
    Sensing {
        phases,
        sum_tolerance: reader
            .plain_quantity(errors, "current_sum_tolerance")
            .map(|given| given.si),
        sum_samples: reader.integer(errors, "current_sum_samples"),
        place,
        low_side: is_low.then(|| reader.part("current_sensing", String::new)),
        minimum_low_time,
        low_time: (minimum_low_time > 0.0).then(|| reader.part("minimum_low_time", String::new)),
    }
}

fn time(reader: &Reader, errors: &mut Collector, name: &'static str) -> Option<f64> {
    reader.plain_quantity(errors, name).map(|given| given.si)
}

/// Where the sensors are has no default: a low leg's sensor read as one in the phase shows a wrong current. Sensors in
/// the low legs need their times, others take none.
fn read_place(reader: &Reader, errors: &mut Collector) -> Option<CurrentSensing> {
    const FIELD: &str = "current_sensing";
    const NEEDED: [(&str, &str); 3] = [
        ("settling_time", "1 us"),
        ("aperture_time", "200 ns"),
        ("conversion_time", "400 ns"),
    ];
    let [settling, aperture, conversion, lead] =
        ["settling_time", "aperture_time", "conversion_time", LEAD]
            .map(|name| time(reader, errors, name));
    let converters = reader.integer(errors, "current_adcs");
    let places = [
        (
            IN_PHASE,
            "between the legs and the motor, as Hall-effect sensors are",
        ),
        (LOW_SIDE, "shunts between the low switches and ground"),
    ];
    reader.require_choice(errors, FIELD, &places);
    let is_low = reader.word(errors, FIELD, &[(IN_PHASE, false), (LOW_SIDE, true)])?;
    if !is_low {
        let [settling, aperture, conversion] = NEEDED.map(|(name, _)| name);
        let names = [settling, aperture, conversion, "current_adcs", LEAD];
        reader.refuse_without(errors, "current_sensing: low_side", &names);
        return Some(CurrentSensing::InPhase);
    }
    reader.require_beside(errors, [FIELD, LOW_SIDE], ("inverter", &NEEDED));
    if let (Some(conversion), Some(shared @ 2..)) = (conversion, converters)
        && conversion == 0.0
        && reader
            .field("sensed_phases")
            .is_some_and(|field| field.value.to_string() == "abc")
        && shared < 3
    {
        errors.push(catalogue::shared_converter(
            &reader.part("conversion_time", String::new),
            shared,
        ));
    }
    Some(CurrentSensing::LowSide(SensingTimes {
        settling: settling?,
        aperture: aperture?,
        conversion: conversion?,
        converters: converters.unwrap_or(1),
        lead: lead.unwrap_or(0.0),
    }))
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
