//! The choice of controller; its options are read by the controller's own folder.

use super::inverter::Inverter;
use super::motor::Motor;
use super::reader::Reader;
use crate::controllers::ControllerSpec;
use crate::controllers::pdcc;
use crate::diagnostics::{Collector, Location, catalogue};
use crate::spec::HallCapture;
use crate::spec::ast::{Field, Section, Value};

const AVAILABLE: [&str; 1] = ["pdcc"];
/// Known methods that this version does not have.
const PLANNED: [&str; 3] = ["fcs-mpc", "phcc", "pi-pwm"];

/// Options of the controllers that this version does not have.
const OTHER_OPTIONS: [(&str, &[&str]); 12] = [
    ("candidates", &["fcs-mpc"]),
    ("off_leg", &["fcs-mpc", "phcc"]),
    ("zero", &["pi-pwm"]),
    ("horizon", &["fcs-mpc"]),
    ("modulated", &["fcs-mpc"]),
    ("table", &["phcc"]),
    ("band", &["phcc"]),
    ("bandwidth", &["pi-pwm"]),
    ("integral_time", &["pi-pwm"]),
    ("feed_forward", &["pi-pwm"]),
    ("six_step", &["pi-pwm"]),
    ("integral", &["pi-pwm"]),
];

/// The controller with its options, and how Hall edges reach it.
pub(super) fn read(
    section: &Section,
    fallback: &Location,
    motor: &Motor,
    inverter: &Inverter,
    errors: &mut Collector,
) -> (Option<ControllerSpec>, Option<HallCapture>) {
    let reader = Reader::new("controller", section, pdcc::OPTIONS, fallback);
    if section.location.is_some() {
        reader.require(errors, &["kind"]);
    }
    if let Some(field) = reader.field("kind")
        && !is_available(field, errors)
    {
        // The options are those of another controller: nothing can be said about them.
        return (None, None);
    }
    reader.check_fields(errors, |field, errors| {
        let takers = OTHER_OPTIONS.iter().find(|(name, _)| *name == field.name);
        if let Some((name, takers)) = takers {
            let at = &field.name_location;
            errors.push(catalogue::option_of_other_controller(
                at, name, "pdcc", takers,
            ));
        }
        takers.is_some()
    });
    let surroundings = pdcc::Surroundings {
        t_s: inverter.t_s,
        v_bus: inverter.v_bus.as_ref().map(|given| given.si),
        inductance: motor.inductance,
        rated_current: motor
            .rated_current
            .as_ref()
            .map(|given| (given.si, given.part.clone())),
        adc_gain: inverter.adc.as_ref().map(|adc| adc.gain),
    };
    let options = pdcc::check_options(&reader, &surroundings, errors);
    (
        options.map(ControllerSpec::Pdcc),
        read_capture(&reader, inverter, errors),
    )
}

fn is_available(field: &Field, errors: &mut Collector) -> bool {
    let given = match &field.value {
        Value::Malformed(error) => {
            errors.push((**error).clone());
            return false;
        }
        value => value.to_string(),
    };
    let available = AVAILABLE.contains(&given.as_str());
    if !available {
        // In the macro `fcs_mpc` is as natural as `fcs-mpc`.
        let planned = PLANNED.contains(&given.replace('_', "-").as_str());
        let at = &field.location;
        errors.push(catalogue::controller_unavailable(
            at, &given, planned, &AVAILABLE,
        ));
    }
    available
}

/// Sampled edges by default; a capture timer needs a clock that divides the control period.
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
    let whole = (ticks - ticks.round()).abs() <= 1e-6 * ticks.max(1.0);
    if whole && (2.0..=65535.0).contains(&ticks.round()) {
        return Some(HallCapture::Timer {
            ticks: ticks.round() as u32,
        });
    }
    errors.push(catalogue::hall_timer(&clock.part, &period.part, ticks, t_s));
    None
}
