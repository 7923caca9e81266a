//! Trip level and largest set-point against each other, the ADC and the controller.

use super::inverter::{Adc, Inverter, usual_tolerance};
use super::motor::Motor;
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, at_least, at_most, engineering};
use crate::spec::health::{Drive, TRIP_BY_DEFAULT};
use crate::spec::reader::Reader;
use crate::spec::{BusCurrents, ControllerSpec, EmfShape, Reference};

/// Margin of the default trip level above the currents that whole vectors reach.
const ROOM: f64 = 1.05;

/// Minimum of the largest set-point, ADC counts: half a count is 5 % of it.
const LEAST_COUNTS: f64 = 10.0;

/// The levels that are known without the controller's options, ampere.
struct Levels {
    /// Greatest current that the ADC can show.
    shown: f64,
    max: f64,
}

/// Trip current and largest set-point.
pub(super) fn finish(
    reader: &Reader,
    inverter: &Inverter,
    adc: &Adc,
    motor: &Motor,
    controller: Option<&ControllerSpec>,
    errors: &mut Collector,
) -> Option<(f64, f64)> {
    let controller = controller?;
    let levels = read(reader, inverter, adc, motor, controller, errors)?;
    let drive = Drive {
        controller,
        emf_shape: motor.emf_shape?,
        resistance: motor.resistance?,
        inductance: motor.inductance?,
        v_bus: inverter.v_bus.as_ref()?.si,
        t_s: inverter.t_s?,
        max_current: levels.max,
    };
    let trip = inverter
        .trip_current
        .as_ref()
        .map_or_else(|| default_trip(&drive, adc, levels.shown), |given| given.si);
    check_health(
        reader,
        &drive,
        motor.rated_current.as_ref()?.si,
        trip,
        errors,
    );
    Some((whole_counts(trip, adc.gain, f64::floor), levels.max))
}

/// Checks the largest set-point and the ADC range against the rating and a stated trip level.
fn read(
    reader: &Reader,
    inverter: &Inverter,
    adc: &Adc,
    motor: &Motor,
    controller: &ControllerSpec,
    errors: &mut Collector,
) -> Option<Levels> {
    let shown = adc.reach - adc.gain;
    if let Some(trip) = &inverter.trip_current
        && trip.si > shown * (1.0 + 1e-9)
    {
        errors.push(catalogue::trip_above_adc_range(
            &trip.part, &adc.part, shown,
        ));
        return None;
    }
    let rated = motor.rated_current.as_ref()?;
    if adc.reach < rated.si {
        errors.push(catalogue::adc_range_too_small(
            &adc.part,
            &rated.part,
            adc.reach,
        ));
        return None;
    }
    let max = inverter.max_current.as_ref().map_or_else(
        || default_max(motor, controller, rated.si),
        |given| given.si,
    );
    if max < LEAST_COUNTS * adc.gain * (1.0 - 1e-9) {
        let part = reader.part("max_current", || engineering(max, "A"));
        errors.push(catalogue::max_current_below_counts(
            &part,
            &adc.part,
            max,
            adc.gain,
            LEAST_COUNTS,
        ));
        return None;
    }
    Some(Levels { shown, max })
}

/// A current between some ADC counts, `least` ampere, and the trip level.
pub(super) fn check_within(
    part: &Part,
    current: f64,
    (least, counts): (f64, &str),
    trip: f64,
    errors: &mut Collector,
) {
    if current < least * (1.0 - 1e-9) || current > trip * (1.0 + 1e-9) {
        errors.push(catalogue::out_of_limits(
            &part.location,
            part.field,
            &part.given,
            &format!("{}, {counts},", engineering(at_least(least), "A")),
            &format!("{}, the trip level", engineering(at_most(trip), "A")),
        ));
    }
}

/// Limits of the bus current, which is at most that of a phase.
pub(super) fn bus(inverter: &Inverter, trip: f64, errors: &mut Collector) -> BusCurrents {
    let least = LEAST_COUNTS * inverter.adc.as_ref().map_or(0.0, |adc| adc.gain);
    let [drawn, returned] = inverter.bus_currents.each_ref().map(|given| {
        let given = given.as_ref()?;
        check_within(
            &given.part,
            given.si,
            (least, "ten ADC counts"),
            trip,
            errors,
        );
        Some(given.si)
    });
    BusCurrents { drawn, returned }
}

/// The `rated` current. The rated torque of a sinusoidal EMF may be that of a quasi-square current,
/// as in block commutation; a sine has up to 2/sqrt(3) of its peak without more heat.
fn default_max(motor: &Motor, controller: &ControllerSpec, rated: f64) -> f64 {
    let shape = motor.emf_shape.unwrap_or(EmfShape::Sinusoidal);
    let is_sine = !matches!(shape, EmfShape::Trapezoidal { .. })
        && controller.common().reference == Reference::Proportional;
    let per_ampere = motor
        .emf_constant
        .map(|constant| shape.proportional_factor() * constant);
    match (&motor.rated_torque, per_ampere) {
        (Some(torque), Some(per_ampere)) if is_sine => {
            (torque.si / per_ampere).clamp(rated, rated * 2.0 / 3.0_f64.sqrt())
        }
        _ => rated,
    }
}

/// Twice the largest set-point, or more where whole vectors need it. At most what a saturated ADC
/// shows with the usual offset tolerance, but not below what the drive reaches without a fault.
fn default_trip(drive: &Drive, adc: &Adc, shown: f64) -> f64 {
    let (peak, reach) = (drive.peak(), drive.reach());
    let vectors = if reach > peak {
        ROOM * reach.max(drive.swing())
    } else {
        0.0
    };
    let converter = f64::from(1_u32 << adc.bits) / 2.0 - usual_tolerance(1 << adc.bits) - 1.0;
    let ends = adc.reach.min(converter * adc.gain);
    let most = (ends - adc.gain).max(reach.min(shown));
    let trip = (TRIP_BY_DEFAULT * drive.max_current).max(vectors).min(most);
    whole_counts(trip, adc.gain, f64::ceil).min(shown)
}

/// A level rounded to whole ADC counts; binary rounding of a whole number is ignored.
fn whole_counts(current: f64, gain: f64, round: fn(f64) -> f64) -> f64 {
    let counts = current / gain;
    let whole = if (counts - counts.round()).abs() <= 1e-6 {
        counts.round()
    } else {
        round(counts)
    };
    whole * gain
}

/// Accepted: a trip level above what reference and vectors reach without a fault. A band or a
/// vector that exceeds the `rated` current is an error of its own.
fn check_health(reader: &Reader, drive: &Drive, rated: f64, trip: f64, errors: &mut Collector) {
    let (peak, reach) = (drive.peak(), drive.reach());
    let max_part = reader.part("max_current", || engineering(drive.max_current, "A"));
    let trip_part = reader.part("trip_current", || engineering(trip, "A"));
    if peak > trip * (1.0 + 1e-9) {
        errors.push(catalogue::max_current_above_trip(
            &max_part, &trip_part, peak,
        ));
    } else if drive.stride(1.0) < rated
        && reach > trip * (1.0 + 1e-9)
        && let Some(error) = drive
            .controller
            .refuse_trip(drive, rated, [&max_part, &trip_part])
    {
        errors.push(error);
    }
}
