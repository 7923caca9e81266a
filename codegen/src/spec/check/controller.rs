//! The choice of controller; its options are read by the controller's own folder.

use super::inverter::Inverter;
use super::motor::Motor;
use super::reader::Reader;
use crate::diagnostics::{Collector, Location, catalogue};
use crate::spec::ast::{Field, Section, Value};
use crate::spec::controller::common::{OPTIONS, Surroundings};
use crate::spec::controller::{fcs_mpc, pdcc, phcc, pi_pwm};
use crate::spec::{ControllerSpec, HallCapture, KINDS};
use std::f64::consts::TAU;

/// Options that are known and that this version does not have.
const PLANNED_OPTIONS: [&str; 1] = ["zero"];

/// The controller with its options, and how Hall edges reach it.
pub(super) fn read(
    section: &Section,
    fallback: &Location,
    motor: &Motor,
    inverter: &Inverter,
    errors: &mut Collector,
) -> (Option<ControllerSpec>, Option<HallCapture>) {
    let reader = Reader::new("controller", section, OPTIONS, fallback);
    if section.location.is_some() {
        reader.require(errors, &["kind"]);
    }
    let kind = match reader.field("kind") {
        None => "pdcc",
        Some(field) => match read_kind(field, errors) {
            Some(kind) => kind,
            // The options are those of another controller: nothing can be said about them.
            None => return (None, None),
        },
    };
    check_takers(section, kind, errors);
    reader.check_fields(errors, |field, errors| {
        let planned = PLANNED_OPTIONS.contains(&field.name.as_str());
        if planned {
            let at = &field.name_location;
            errors.push(catalogue::option_planned(at, &field.name));
        }
        planned
    });
    let surroundings = Surroundings {
        t_s: inverter.t_s,
        v_bus: inverter.v_bus.as_ref().map(|given| given.si),
        resistance: motor.resistance,
        inductance: motor.inductance,
        rated_current: motor
            .rated_current
            .as_ref()
            .map(|given| (given.si, given.part.clone())),
        dead_time: inverter.dead_time.as_ref().map_or(0.0, |given| given.si),
        inertia: motor.inertia,
        rated_frequency: match (motor.pole_pairs, &motor.rated_speed) {
            (Some(pairs), Some(speed)) => Some(f64::from(pairs) * speed.si / TAU),
            _ => None,
        },
        adc_gain: inverter.adc.as_ref().map(|adc| adc.gain),
    };
    let controller = match kind {
        "fcs-mpc" => {
            fcs_mpc::check_options(&reader, &surroundings, errors).map(ControllerSpec::FcsMpc)
        }
        "phcc" => phcc::check_options(&reader, &surroundings, errors).map(ControllerSpec::Phcc),
        "pi-pwm" => {
            pi_pwm::check_options(&reader, &surroundings, errors).map(ControllerSpec::PiPwm)
        }
        _ => pdcc::check_options(&reader, &surroundings, errors).map(ControllerSpec::Pdcc),
    };
    (controller, read_capture(&reader, inverter, errors))
}

/// Options of another kind than the chosen one.
fn check_takers(section: &Section, kind: &str, errors: &mut Collector) {
    for field in &section.fields {
        let takers: Vec<&str> = KINDS
            .iter()
            .filter(|(_, options)| options.contains(&field.name.as_str()))
            .map(|(kind, _)| *kind)
            .collect();
        if !takers.is_empty() && !takers.contains(&kind) {
            let at = &field.name_location;
            errors.push(catalogue::option_of_other_controller(
                at,
                &field.name,
                kind,
                &takers,
            ));
        }
    }
}

/// The name of an available controller, in the spelling of `KINDS`.
fn read_kind(field: &Field, errors: &mut Collector) -> Option<&'static str> {
    let given = match &field.value {
        Value::Malformed(error) => {
            errors.push((**error).clone());
            return None;
        }
        value => value.to_string(),
    };
    // In the macro `fcs_mpc` is as natural as `fcs-mpc`.
    let name = given.replace('_', "-");
    let known = KINDS
        .iter()
        .map(|(kind, _)| *kind)
        .find(|kind| *kind == name);
    if known.is_none() {
        let available = KINDS.map(|(kind, _)| kind);
        let at = &field.location;
        errors.push(catalogue::unknown_controller(at, &given, &available));
    }
    known
}

/// Sampled edges by default; a capture timer needs a clock of at least two ticks in a control
/// period.
fn read_capture(
    reader: &Reader,
    inverter: &Inverter,
    errors: &mut Collector,
) -> Option<HallCapture> {
    let timer = reader
        .word(
            errors,
            "hall_capture",
            &[("sampled", false), ("timer", true)],
        )
        .or_else(|| reader.field("hall_capture").is_none().then_some(false))?;
    if !timer {
        return Some(HallCapture::Sampled);
    }
    let Some(clock) = &inverter.hall_timer_clock else {
        if !inverter.hall_timer_clock_given {
            let at = reader
                .field("hall_capture")
                .map_or(reader.location(), |field| &field.location);
            let setting = "hall_capture: timer";
            errors.push(catalogue::needed_field(
                at,
                setting,
                "hall_timer_clock",
                "1 MHz",
            ));
        }
        return None;
    };
    let (t_s, period) = (inverter.t_s?, inverter.period.as_ref()?);
    let ticks = clock.si * t_s;
    // Whole but for the rounding of decimal units is whole.
    let is_whole = (ticks - ticks.round()).abs() <= 1e-6 * ticks.max(1.0);
    let ticks = if is_whole { ticks.round() } else { ticks };
    if (2.0..=65535.0).contains(&ticks) {
        return Some(HallCapture::Timer { ticks });
    }
    errors.push(catalogue::hall_timer(&clock.part, &period.part, ticks, t_s));
    None
}
