//! Sensors and pulses together: when a leg can be read.

use super::inverter::Inverter;
use crate::diagnostics::{Collector, catalogue, engineering};
use crate::spec::ast::Section;
use crate::spec::reader::Reader;
use crate::spec::{ControllerSpec, CurrentSensing, SensedPhases};
use std::ops::RangeInclusive;

/// Least share of the period that a leg may be high: below it not even the zero voltage of centred pulses, half the
/// period each, could be read.
const LEAST_DUTY: f64 = 0.5;

/// PWM frequencies that a remedy may offer, Hz: boards switch no faster, and below them the current is not smooth.
const F_PWM: RangeInclusive<f64> = 2e3..=100e3;

/// Accepted: a window and a least low time that leave half of the PWM period, and legs of which no off one need be read.
pub(super) fn check(
    reader: &Reader,
    inverter: &Inverter,
    (controller, options): (Option<&ControllerSpec>, &Section),
    errors: &mut Collector,
) -> Option<()> {
    let pwm_period = inverter.t_s? / f64::from(inverter.pwm_per_control);
    let half_low = pwm_period * (1.0 - LEAST_DUTY) / 2.0;
    let sensing = &inverter.sensing;
    let period = &inverter.period.as_ref()?.part;
    if sensing.minimum_low_time > 2.0 * half_low * (1.0 + 1e-9) {
        let part = reader.part("minimum_low_time", String::new);
        errors.push(catalogue::minimum_low_time(
            &part,
            period,
            2.0 * half_low,
            [LEAST_DUTY, pwm_period],
        ));
    }
    let CurrentSensing::LowSide(times) = sensing.place? else {
        return None;
    };
    let dead_time = inverter.dead_time.as_ref().map_or(0.0, |given| given.si);
    let window = times.window(dead_time, sensing.phases.phases().len());
    let needed = window.before.max(window.after);
    // A dead time that is too long by itself is told of once.
    let is_told = inverter.long_dead_time().is_some();
    if needed > half_low * (1.0 + 1e-9) && !is_told {
        let default = |time: f64| move || engineering(time, "s");
        let is_before = window.before >= window.after;
        let mut parts = [
            ("settling_time", times.settling, true),
            ("dead_time", dead_time, true),
            ("sampling_lead", times.lead.abs(), times.lead >= 0.0),
            ("aperture_time", times.aperture, false),
            ("conversion_time", times.conversion, false),
        ];
        // The longest time of the longer side first: the error points at it.
        let weight = |time: f64, before: bool| if before == is_before { time } else { 0.0 };
        parts.sort_by(|(_, one, one_before), (_, other, other_before)| {
            weight(*other, *other_before).total_cmp(&weight(*one, *one_before))
        });
        let parts = parts.map(|(name, time, _)| reader.part(name, default(time)));
        let f_pwm = ((1.0 - LEAST_DUTY) / 2.0 / needed).min(*F_PWM.end());
        errors.push(catalogue::sensing_window(
            &parts,
            (period, times.lead > 0.0),
            [window.before, window.after],
            [half_low, LEAST_DUTY],
            Some(f_pwm).filter(|f_pwm| F_PWM.contains(f_pwm)),
        ));
    }
    // Intervals are refused on low-side sensors of any number.
    let turns_off = controller.filter(|controller| !controller.has_intervals());
    let turns_off = turns_off.and_then(ControllerSpec::turns_off);
    if let Some(off) = turns_off.filter(|_| !sensing.reads_off_legs()) {
        let place = reader.part("current_sensing", String::new);
        let phases = reader.part("sensed_phases", || "ab".to_owned());
        let at = options
            .field(off.option)
            .map_or(&place.location, |field| &field.location);
        let setting = [off.option, off.value, off.instead];
        errors.push(if sensing.phases == SensedPhases::Abc {
            let lead = reader.part("sampling_lead", || engineering(times.lead, "s"));
            catalogue::leg_turned_off_early(at, setting, &lead, times.lead + window.after)
        } else {
            catalogue::unreadable_leg(at, setting, &place, &phases)
        });
    }
    Some(())
}
