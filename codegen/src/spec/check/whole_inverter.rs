//! The checked inverter: defaults and checks that depend on motor and controller.

use super::inverter::{Adc, Inverter};
use super::motor::Motor;
use super::sensing::Sensing;
use super::{currents, relations};
use crate::diagnostics::{Collector, Diagnostic, at_most, catalogue, engineering, rpm};
use crate::spec::model::periods;
use crate::spec::reader::Reader;
use crate::spec::{ControllerSpec, CurrentSum, InverterSpec, RotorSensing, SensedPhases};
use std::f64::consts::FRAC_PI_3;

/// Default `minimum_speed` over `rated_speed`.
const MINIMUM_SPEED: f64 = 0.02;

/// Default pre-charge time, second.
const PRECHARGE: f64 = 1e-3;

/// Default stall time-out of a drive with a speed loop, second, and in sectors at `minimum_speed`:
/// the longer of both.
const STALL_TIMEOUT: f64 = 1.0;
const STALL_SECTORS: f64 = 5.0;

/// Fills in the defaults that depend on motor and controller, and checks them. None if something
/// is missing or in error.
pub(super) fn inverter(
    reader: &Reader,
    inverter: &Inverter,
    motor: &Motor,
    capture: Option<RotorSensing>,
    controller: Option<&ControllerSpec>,
    errors: &mut Collector,
    warnings: &mut Vec<Diagnostic>,
) -> Option<InverterSpec> {
    let adc = inverter.adc.as_ref();
    let rated = motor.rated_current.as_ref();
    let currents = adc.and_then(|adc| {
        currents::finish(reader, inverter, adc, motor, controller, errors, warnings)
    });
    let speeds = motor.rated_speed.as_ref().map(|rated| {
        let minimum = inverter.minimum_speed.as_ref().map_or_else(
            || minimum_speed(rated.si, relations::slowest(inverter, motor, capture)),
            |given| given.si,
        );
        let maximum = inverter
            .maximum_speed
            .as_ref()
            .map_or(1.5 * rated.si, |given| given.si);
        let minimum_part = reader.part("minimum_speed", || rpm(minimum));
        let maximum_part = reader.part("maximum_speed", || rpm(maximum));
        relations::check_speeds(
            inverter,
            motor,
            capture,
            (minimum, &minimum_part),
            (maximum, &maximum_part),
            errors,
        );
        relations::check_over_speed(inverter, motor, errors);
        let weakens = controller.is_some_and(|spec| spec.common().field_weakening);
        relations::check_bus_clamp(
            reader,
            inverter,
            motor,
            (maximum, &maximum_part),
            weakens,
            errors,
        );
        (minimum, maximum)
    });
    let (t_s, adc, currents, (minimum_speed, maximum_speed)) =
        (inverter.t_s?, adc?, currents?, speeds?);
    let (trip_current, max_current) = (currents.trip, currents.max);
    rated?;
    let (first, others) = adc.sensors.split_first()?;
    let dead_time = inverter.dead_time.as_ref().map_or(0.0, |given| given.si);
    if let Some((given, pwm_period)) = inverter.long_dead_time() {
        errors.push(catalogue::dead_time(&given.part, pwm_period));
    }
    Some(InverterSpec {
        v_bus: inverter.v_bus.as_ref()?.si,
        bus: inverter.bus?,
        t_s,
        pwm_per_control: inverter.pwm_per_control,
        timer_period: inverter.timer_period?,
        dead_time,
        adc_bits: adc.bits,
        adc_gain: first.gain,
        adc_offset: first.offset,
        other_sensors: others.to_vec(),
        amplifier_reach: adc.linear.is_finite().then_some(adc.linear),
        sensed_phases: inverter.sensing.phases,
        current_sensing: inverter.sensing.place?,
        current_sum: current_sum(reader, &inverter.sensing, adc, trip_current, errors),
        minimum_low_time: inverter.sensing.minimum_low_time,
        offset_tolerance: adc.offset_tolerance,
        trip_current,
        max_current,
        bus_clamp: inverter.bus_clamp.as_ref().map(|given| given.si),
        bus_currents: currents::bus(inverter, currents, errors),
        rotor_sensing: capture?,
        minimum_speed,
        maximum_speed,
        over_speed: inverter.over_speed.as_ref().map(|given| given.si),
        stall_periods: periods(
            stall_timeout(inverter, motor, controller, minimum_speed, errors),
            t_s,
        ),
        hall_glitches: hall_glitches(reader, inverter, motor, (t_s, maximum_speed), errors),
        calibration_log2: inverter.calibration_log2,
        precharge_periods: finish_precharge(reader, inverter, t_s, errors),
    })
}

/// Default tolerance of a sum of three currents, over the trip level: the gains of two sensors may differ by a few
/// percent, and their conversions by an instant.
const SUM_TOLERANCE: f64 = 0.1;

/// The least that it becomes, over the sensors' range: the zeros of three sensors drift by some thousandths of it.
const SUM_OF_RANGE: f64 = 0.02;

/// Default of the samples in a row with a larger sum that are a fault.
const SUM_SAMPLES: u32 = 20;

/// Least tolerance of a sum of three currents, ADC counts: each is off by up to half a count.
const LEAST_SUM: f64 = 2.0;

/// When three currents do not add up.
fn current_sum(
    reader: &Reader,
    sensing: &Sensing,
    adc: &Adc,
    trip_current: f64,
    errors: &mut Collector,
) -> Option<CurrentSum> {
    let gain = adc.gain;
    if let Some(tolerance) = sensing.sum_tolerance {
        let part = reader.part("current_sum_tolerance", String::new);
        let least = (LEAST_SUM * gain, "two ADC counts");
        currents::check_within(&part, tolerance, least, trip_current, errors);
    }
    let samples = sensing.sum_samples.unwrap_or(SUM_SAMPLES);
    let default = (SUM_TOLERANCE * trip_current).max(SUM_OF_RANGE * adc.reach);
    let default = (default / gain).ceil() * gain;
    let is_watched = sensing.phases == SensedPhases::Abc && samples > 0;
    is_watched.then_some(CurrentSum {
        tolerance: sensing.sum_tolerance.unwrap_or(default),
        samples,
    })
}

/// Default least speed with an angle: a small share of the rated one, or what the Hall timer measures
/// where that is no large one.
fn minimum_speed(rated: f64, slowest: Option<f64>) -> f64 {
    let default = MINIMUM_SPEED * rated;
    let slowest = slowest.filter(|slowest| *slowest <= relations::GREATEST_MINIMUM * rated);
    default.max(slowest.unwrap_or(0.0))
}

/// Time without a Hall edge that trips the drive, second. By default a drive with a speed loop has
/// one, which a rotor at the least speed with an angle does not reach.
fn stall_timeout(
    inverter: &Inverter,
    motor: &Motor,
    controller: Option<&ControllerSpec>,
    minimum_speed: f64,
    errors: &mut Collector,
) -> f64 {
    let given = inverter.stall_timeout.as_ref();
    let stated = given.map_or(0.0, |given| given.si);
    let speed = controller.and_then(|spec| spec.common().speed);
    let (Some(speed), Some(pole_pairs)) = (speed, motor.pole_pairs) else {
        return stated;
    };
    let [_, widest] = motor.extreme_sectors();
    let angle = FRAC_PI_3 * widest / f64::from(pole_pairs);
    // A ramp of the set-point may reverse within a sector: down to rest and up again.
    let reversal = |limit: f64| 2.0 * (2.0 * angle / limit).sqrt();
    let Some(given) = given else {
        let reversal = speed.acceleration_limit.map_or(0.0, reversal);
        return STALL_TIMEOUT.max(STALL_SECTORS * (angle / minimum_speed).max(reversal));
    };
    if let Some(limit) = speed.acceleration_limit
        && stated > 0.0
        && stated < reversal(limit)
    {
        let error = catalogue::stall_timeout(&given.part, limit, reversal(limit));
        errors.push(error);
    }
    stated
}

/// Samples with a disturbed Hall code that are bridged. The rotor must not leave the next sector
/// meanwhile: the first sound code behind the gap would seem disturbed, too.
fn hall_glitches(
    reader: &Reader,
    inverter: &Inverter,
    motor: &Motor,
    (t_s, maximum_speed): (f64, f64),
    errors: &mut Collector,
) -> u32 {
    let Some(pole_pairs) = motor.pole_pairs.filter(|_| inverter.hall_glitches > 0) else {
        return inverter.hall_glitches;
    };
    let [narrowest, _] = motor.extreme_sectors();
    let sector = FRAC_PI_3 * narrowest / (maximum_speed * f64::from(pole_pairs));
    let most = (sector / t_s - 1.0).floor();
    if f64::from(inverter.hall_glitches) > most {
        let part = reader.part("hall_glitches", String::new);
        errors.push(catalogue::hall_glitches(
            &part.location,
            &part.given,
            most.max(0.0) as u32,
            &rpm(maximum_speed),
        ));
    }
    inverter.hall_glitches
}

fn finish_precharge(reader: &Reader, inverter: &Inverter, t_s: f64, errors: &mut Collector) -> u32 {
    let time = inverter
        .precharge
        .as_ref()
        .map_or(PRECHARGE, |given| given.si);
    let count = periods(time, t_s);
    if count > 65535 {
        let part = reader.part("precharge", || engineering(time, "s"));
        let longest = engineering(at_most(65535.0 * t_s), "s");
        errors.push(catalogue::out_of_limits(
            &part.location,
            "precharge",
            &part.given,
            "0 s",
            &longest,
        ));
    }
    count
}
