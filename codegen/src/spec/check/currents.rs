//! Trip level and largest set-point against each other, the ADC and the controller.

use super::inverter::{Adc, Inverter, usual_tolerance};
use super::motor::Motor;
use crate::diagnostics::catalogue::{self, Part, TripRoom};
use crate::diagnostics::{Collector, Diagnostic, at_least, at_most, engineering};
use crate::spec::health::{Drive, TRIP_AT_LEAST, TRIP_BY_DEFAULT};
use crate::spec::reader::{Given, Reader};
use crate::spec::{BusCurrents, ControllerSpec, EmfShape, Reference};

/// Margin of the default trip level above the currents that whole vectors reach.
const ROOM: f64 = 1.05;

/// Largest set-point over the rated current from which on a typing error is likelier than an overload.
const FAR_ABOVE: f64 = 5.0;

/// Minimum of the largest set-point, ADC counts: half a count is 5 % of it.
const LEAST_COUNTS: f64 = 10.0;

/// The field of what the supply takes back.
const RETURNED: &str = "return_current_limit";

/// Trip level and largest set-point, ampere.
#[derive(Clone, Copy, Debug)]
pub(super) struct Currents {
    pub trip: f64,
    pub max: f64,
    /// Greatest phase current at the largest set-point.
    peak: f64,
    /// Least trip level that leaves room above it.
    needed: f64,
}

/// Trip current and largest set-point.
pub(super) fn finish(
    reader: &Reader,
    inverter: &Inverter,
    adc: &Adc,
    motor: &Motor,
    controller: Option<&ControllerSpec>,
    errors: &mut Collector,
    warnings: &mut Vec<Diagnostic>,
) -> Option<Currents> {
    let rated = motor.rated_current.as_ref()?;
    let given = inverter.trip_current.as_ref();
    let drive = drive(inverter, motor, controller, rated.si);
    if let Some(error) = beyond_sensors(inverter, adc, drive.as_ref(), rated) {
        errors.push(error);
        return None;
    }
    if rated.si < LEAST_COUNTS * adc.gain * (1.0 - 1e-9) {
        let (current, gain) = (&rated.part, adc.gain);
        let is_thousandth = 1e3 * rated.si <= adc.reach;
        let error = if is_thousandth {
            catalogue::thousandth_of_current(current, &adc.part, rated.si, gain)
        } else {
            catalogue::current_below_counts(current, &adc.part, rated.si, gain, LEAST_COUNTS)
        };
        errors.push(error);
        return None;
    }
    let drive = drive?;
    if let Some(error) = too_few_counts(reader, adc, drive.max_current) {
        errors.push(error);
        return None;
    }
    let trip = given.map_or_else(|| default_trip(&drive, adc), |given| given.si);
    let room = TripRoom {
        max: reader.part("max_current", || engineering(drive.max_current, "A")),
        level: reader.part("trip_current", || engineering(trip, "A")),
        range: adc.bound.clone(),
        peak: drive.peak(),
        trip,
        needed: TRIP_AT_LEAST * drive.peak(),
        shown: shown(adc),
        most: drive.largest_below(greatest_trip(inverter, adc)),
    };
    check_health(&drive, rated.si, &room, errors);
    if let Some(max) = &inverter.max_current
        && max.si >= FAR_ABOVE * rated.si * (1.0 - 1e-9)
    {
        let times = max.si / rated.si;
        warnings.push(catalogue::current_far_above_rated(
            &max.part,
            &rated.part,
            times,
        ));
    }
    if (drive.peak()..room.needed * (1.0 - 1e-9)).contains(&trip) {
        warnings.push(catalogue::trip_near_set_point(&room));
    }
    Some(Currents {
        trip: whole_counts(trip, adc.gain, f64::floor),
        max: drive.max_current,
        peak: room.peak,
        needed: room.needed,
    })
}

/// The values that the currents depend on, as far as they are stated.
fn drive<'a>(
    inverter: &Inverter,
    motor: &Motor,
    controller: Option<&'a ControllerSpec>,
    rated: f64,
) -> Option<Drive<'a>> {
    let controller = controller?;
    Some(Drive {
        controller,
        emf_shape: motor.emf_shape?,
        resistance: motor.resistance?,
        inductance: motor.inductance?,
        v_bus: inverter.v_bus.as_ref()?.si,
        t_s: inverter.t_s?,
        max_current: inverter
            .max_current
            .as_ref()
            .map_or_else(|| default_max(motor, controller, rated), |given| given.si),
    })
}

/// A trip level or a rated current that the sensors do not show.
fn beyond_sensors(
    inverter: &Inverter,
    adc: &Adc,
    drive: Option<&Drive>,
    rated: &Given,
) -> Option<Diagnostic> {
    let shown = shown(adc);
    if let Some(trip) = &inverter.trip_current
        && trip.si > shown * (1.0 + 1e-9)
    {
        return Some(catalogue::trip_above_adc_range(
            &trip.part, &adc.bound, shown,
        ));
    }
    (inverter.max_current.is_none() && adc.reach < rated.si).then(|| {
        // Whole vectors and bands need more than the reference's peak.
        let modulated = drive.filter(|drive| drive.reach() <= drive.peak());
        let most = modulated.map(|drive| drive.largest_below(greatest_trip(inverter, adc)));
        catalogue::adc_range_too_small(&adc.bound, (&rated.part, rated.si), adc.reach, most)
    })
}

/// A largest set-point of a few counts.
fn too_few_counts(reader: &Reader, adc: &Adc, max: f64) -> Option<Diagnostic> {
    (max < LEAST_COUNTS * adc.gain * (1.0 - 1e-9)).then(|| {
        let part = reader.part("max_current", || engineering(max, "A"));
        catalogue::current_below_counts(&part, &adc.part, max, adc.gain, LEAST_COUNTS)
    })
}

/// The trip level as stated, or the greatest by default, ampere.
fn greatest_trip(inverter: &Inverter, adc: &Adc) -> f64 {
    let given = inverter.trip_current.as_ref();
    given.map_or_else(|| usually_shown(adc), |given| given.si)
}

/// Greatest trip level that may be stated, ampere: a count less than the ADC shows.
fn shown(adc: &Adc) -> f64 {
    adc.reach - adc.gain
}

/// Greatest trip level by default, ampere: what a saturated ADC shows with the usual offset tolerance.
fn usually_shown(adc: &Adc) -> f64 {
    let counts = f64::from(1_u32 << adc.bits) / 2.0 - usual_tolerance(1 << adc.bits) - 1.0;
    adc.reach.min(counts * adc.gain) - adc.gain
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
        let low = format!("{}, {counts},", engineering(at_least(least), "A"));
        let high = format!("{}, the trip level", engineering(at_most(trip), "A"));
        let error = match part.field {
            RETURNED if current < least => catalogue::return_current_outside(part, &low, &high),
            field => catalogue::out_of_limits(&part.location, field, &part.given, &low, &high),
        };
        errors.push(error);
    }
}

/// Limits of the bus current, which is at most that of a phase.
pub(super) fn bus(inverter: &Inverter, currents: Currents, errors: &mut Collector) -> BusCurrents {
    let least = LEAST_COUNTS * inverter.adc.as_ref().map_or(0.0, |adc| adc.gain);
    let Currents {
        trip, peak, needed, ..
    } = currents;
    let is_too_low = |level: f64| trip < level * (1.0 - 1e-9);
    let [drawn, returned] = inverter.bus_currents.each_ref().map(|given| {
        let given = given.as_ref()?;
        let (part, current) = (&given.part, given.si);
        let fits_needed = current <= needed * (1.0 + 1e-9);
        if is_too_low(peak) && fits_needed {
            // Told of the trip level, which is raised anyway.
        } else if is_too_low(needed) && fits_needed && current > trip * (1.0 + 1e-9) {
            errors.push(catalogue::bus_current_above_trip(part, trip, needed));
        } else {
            check_within(part, current, (least, "ten ADC counts"), trip, errors);
        }
        Some(current)
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

/// Twice the largest set-point, or more where whole vectors need it. At most what the ADC usually
/// shows, but not below what the drive reaches without a fault.
fn default_trip(drive: &Drive, adc: &Adc) -> f64 {
    let (peak, reach) = (drive.peak(), drive.reach());
    let vectors = if reach > peak {
        ROOM * reach.max(drive.swing())
    } else {
        0.0
    };
    let most = usually_shown(adc).max(reach.min(shown(adc)));
    let trip = (TRIP_BY_DEFAULT * drive.max_current).max(vectors).min(most);
    whole_counts(trip, adc.gain, f64::ceil).min(shown(adc))
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
fn check_health(drive: &Drive, rated: f64, room: &TripRoom, errors: &mut Collector) {
    if room.peak > room.trip * (1.0 + 1e-9) {
        errors.push(catalogue::max_current_above_trip(room));
    } else if drive.stride(1.0) < rated
        && drive.reach() > room.trip * (1.0 + 1e-9)
        && let Some(error) = drive
            .controller
            .refuse_trip(drive, rated, [&room.max, &room.level])
    {
        errors.push(error);
    }
}
