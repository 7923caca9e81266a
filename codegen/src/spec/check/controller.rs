//! The choice of controller; its options are read by the controller's own folder.

use super::angle;
use super::inverter::Inverter;
use super::motor::Motor;
use super::relations;
use crate::diagnostics::catalogue::Part;
use crate::diagnostics::{Collector, Location, catalogue, engineering};
use crate::spec::ast::{Field, Section, Value};
use crate::spec::controller::common::{
    FIELD_WEAKENING, HALL_LEARNING, HallEdges, Surroundings, TORQUE_LEARNING, refuse,
};
use crate::spec::controller::{self, KINDS, Kind};
use crate::spec::fields;
use crate::spec::reader::Reader;
use crate::spec::words::Words as _;
use crate::spec::{BusSource, ControllerSpec, RotorSensing, RotorSource, TABLE2, ZeroVector};
use std::f64::consts::TAU;

/// The default controller.
const DEFAULT_KIND: &str = "pdcc";

/// The controller with its options, and what tells the rotor's position. `in_error`: fields of motor and inverter whose
/// error has been told.
pub(super) fn read(
    section: &Section,
    fallback: &Location,
    (motor, inverter): (&Motor, &Inverter),
    in_error: Vec<&'static str>,
    errors: &mut Collector,
) -> (Option<ControllerSpec>, Option<RotorSensing>) {
    let any = Reader::new("controller", section, controller::rules(), fallback);
    if section.location.is_some() {
        any.require(errors, &["kind"]);
    }
    let kind = match any.field("kind") {
        None => KINDS.iter().find(|kind| kind.name == DEFAULT_KIND),
        Some(field) => read_kind(field, errors),
    };
    // Options cannot be checked without a kind.
    let Some(kind) = kind else {
        return (None, None);
    };
    let section = &of_kind(section, kind, errors);
    // Own rules first; the names of others' options are known as well.
    let rules = kind.rules().into_iter().chain(controller::rules());
    let reader = Reader::new("controller", section, rules, fallback);
    reader.check_fields(errors, |field, errors| {
        fields::misplaced("controller", field, errors)
    });
    let rated_frequency = match (motor.pole_pairs, &motor.rated_speed) {
        (Some(pairs), Some(speed)) => Some(f64::from(pairs) * speed.si / TAU),
        _ => None,
    };
    let speed_filter = match (motor.angle, rated_frequency, inverter.t_s) {
        (Some(sensor), Some(frequency), Some(t_s)) => Some(sensor.filter_time(frequency, t_s)),
        _ => None,
    };
    let surroundings = Surroundings {
        t_s: inverter.t_s,
        v_bus: inverter.v_bus.as_ref().map(|given| given.si),
        timer_period: inverter.timer_period,
        resistance: motor.resistance,
        inductance: motor.inductance,
        rated_current: motor
            .rated_current
            .as_ref()
            .map(|given| (given.si, given.part.clone())),
        dead_time: inverter.dead_time.as_ref().map_or(0.0, |given| given.si),
        pwm_per_control: inverter.pwm_per_control,
        in_error,
        must_be_low: inverter.sensing.must_be_low(),
        reads_off_legs: inverter.sensing.reads_off_legs(),
        inertia: motor.inertia,
        torque_per_speed: motor
            .finish()
            .map(|motor| motor.torque_rating() / motor.rated_speed),
        rated_frequency,
        speed_filter,
        adc_gain: inverter.adc.as_ref().map(|adc| adc.gain),
    };
    let controller = (kind.read)(&reader, &surroundings, errors);
    if let Some(spec) = &controller
        && spec.common().learning.torque
    {
        check_torque_learning(&reader, inverter, spec.common().field_weakening, errors);
    }
    if controller
        .as_ref()
        .is_some_and(ControllerSpec::has_intervals)
    {
        check_intervals(&reader, inverter, errors);
    }
    let learns = reader.field(HALL_LEARNING);
    let learns = learns.is_some_and(|field| field.value.to_string() != "off");
    let of_halls: &[&str] = if learns {
        &["hall_capture", HALL_LEARNING]
    } else {
        &["hall_capture"]
    };
    angle::refuse_halls(&reader, motor.rotor, of_halls, errors);
    let sensing = match motor.rotor {
        Some(RotorSource::Halls) => {
            let capture = read_capture(&reader, (inverter, motor), errors);
            let learning = controller.as_ref().map(|spec| spec.common().learning);
            let learning = learning.unwrap_or_default();
            for (option, learns) in [
                (HALL_LEARNING, learning.halls),
                (TORQUE_LEARNING, learning.torque),
            ] {
                if learns && capture == Some(RotorSensing::SampledHalls) {
                    refuse_sampled(&reader, (option, inverter, motor), errors);
                }
            }
            capture
        }
        Some(RotorSource::Angle) | None => motor.angle.map(RotorSensing::Angle),
    };
    (controller, sensing)
}

/// The places of Hall sensors are learnt from the times between their edges, and the torque constant from the speed,
/// which must not lag.
fn refuse_sampled(
    reader: &Reader,
    (option, inverter, motor): (&'static str, &Inverter, &Motor),
    errors: &mut Collector,
) {
    if reader.field("hall_capture").is_none() {
        let clock = valid_clock(inverter, motor);
        let clock = [("hall_timer_clock", clock.as_str())];
        reader.require_beside(errors, [option, "on"], ("inverter", &clock));
        return;
    }
    let why = "the time between two edges is known to a control period only";
    refuse(reader, option, ["hall_capture", "sampled"], why, errors);
}

/// Clocks of a capture timer that a remedy names, hertz.
const CLOCKS: [f64; 7] = [1e6, 5e5, 2e5, 1e5, 5e4, 2e4, 1e4];

/// The fastest of them with which the timer counts a sector at the least speed.
fn valid_clock(inverter: &Inverter, motor: &Motor) -> String {
    let mut clocks = CLOCKS.into_iter();
    let clock = clocks.find(|clock| relations::counts_sectors(inverter, motor, *clock));
    engineering(clock.unwrap_or(CLOCKS[0]), "Hz")
}

/// The EMF tells the torque constant where the bus is known, and no current is sent against the field.
fn check_torque_learning(
    reader: &Reader,
    inverter: &Inverter,
    weakens: bool,
    errors: &mut Collector,
) {
    if inverter.bus == Some(BusSource::Fixed) {
        let why = "a bus that is off its stated voltage would be taken for another torque constant";
        errors.push(catalogue::option_without_effect(
            &reader.part(TORQUE_LEARNING, String::new),
            ["v_bus", "fixed"],
            inverter.bus_at.as_ref(),
            why,
        ));
    }
    if weakens {
        let why = "its current against the field looks like another torque constant";
        refuse(
            reader,
            TORQUE_LEARNING,
            [FIELD_WEAKENING, "on"],
            why,
            errors,
        );
    }
}

/// What a command of intervals asks of the board.
fn check_intervals(reader: &Reader, inverter: &Inverter, errors: &mut Collector) {
    let modulation = reader.part("modulation", || TABLE2.to_owned());
    let zero = reader.field("zero").map(|field| field.value.to_string());
    let mut refuse = |cause: &Part, why: &str, remedy: &str| {
        errors.push(catalogue::intervals_unavailable(
            &modulation,
            cause,
            why,
            remedy,
        ));
    };
    if let Some(enables) = &inverter.slow_enables {
        let why = "which this board states that it cannot";
        let remedy = "choose `modulation: pair`, or `leg_enables: within_period` if a compare event of its timer can load the output enables";
        refuse(enables, why, remedy);
    }
    if let Some(place) = &inverter.sensing.low_side {
        let why = "and a sensor in a low leg shows its current only while the leg has been low for a while";
        refuse(
            place,
            why,
            "choose `modulation: three_phase`, or a board with sensors in the phases",
        );
    }
    if let Some(time) = &inverter.sensing.low_time
        && zero.as_deref() == Some(ZeroVector::PairLow.word())
    {
        let why = "and with `zero: pair_low` the third leg may switch without being low";
        refuse(time, why, "choose `zero: all_low`, or leave the time out");
    }
    for limit in inverter.bus_currents.iter().flatten() {
        let why = "and the bus current of such a period is not computed";
        let remedy = format!(
            "remove `{}`, or choose `modulation: three_phase`",
            limit.part.field
        );
        refuse(&limit.part, why, &remedy);
    }
}

/// The section without options of other kinds than the chosen one, which are reported.
fn of_kind(section: &Section, chosen: &Kind, errors: &mut Collector) -> Section {
    let mut own = section.clone();
    own.fields.retain(|field| {
        let takes = |kind: &Kind| kind.rules().iter().any(|rule| rule.name == field.name);
        let takers = KINDS.iter().filter(|kind| takes(kind));
        let takers: Vec<&str> = takers.map(|kind| kind.name).collect();
        let is_foreign = !takers.is_empty() && !takers.contains(&chosen.name);
        if is_foreign {
            let at = &field.name_location;
            errors.push(catalogue::option_of_other_controller(
                at,
                &field.name,
                chosen.name,
                &takers,
            ));
        }
        !is_foreign
    });
    own
}

/// An available controller.
fn read_kind(field: &Field, errors: &mut Collector) -> Option<&'static Kind> {
    let given = match &field.value {
        Value::Malformed(error) => {
            errors.push((**error).clone());
            return None;
        }
        value => value.to_string(),
    };
    // In the macro `fcs_mpc` is as natural as `fcs-mpc`.
    let name = given.replace('_', "-");
    let known = KINDS.iter().find(|kind| kind.name == name);
    if known.is_none() {
        let available = KINDS.map(|kind| kind.name);
        let at = &field.location;
        errors.push(catalogue::unknown_controller(at, &given, &available));
    }
    known
}

/// The edges of a capture timer where one is stated, with at least two ticks per control period, else
/// sampled ones.
fn read_capture(
    reader: &Reader,
    (inverter, motor): (&Inverter, &Motor),
    errors: &mut Collector,
) -> Option<RotorSensing> {
    let by_default = if inverter.hall_timer_clock_given {
        HallEdges::Timer
    } else {
        HallEdges::Sampled
    };
    let edges = reader
        .choice(errors, "hall_capture", &[])
        .unwrap_or(by_default);
    if edges == HallEdges::Sampled {
        return Some(RotorSensing::SampledHalls);
    }
    let Some(clock) = &inverter.hall_timer_clock else {
        if !inverter.hall_timer_clock_given {
            let clock = valid_clock(inverter, motor);
            let clock = [("hall_timer_clock", clock.as_str())];
            reader.require_beside(errors, ["hall_capture", "timer"], ("inverter", &clock));
        }
        return None;
    };
    let (t_s, period) = (inverter.t_s?, inverter.period.as_ref()?);
    let ticks = clock.si * t_s;
    // Decimal units may round a whole number.
    let is_whole = (ticks - ticks.round()).abs() <= 1e-6 * ticks.max(1.0);
    let ticks = if is_whole { ticks.round() } else { ticks };
    if (2.0..=65535.0).contains(&ticks) {
        return Some(RotorSensing::TimedHalls { ticks });
    }
    errors.push(catalogue::hall_timer(&clock.part, &period.part, ticks, t_s));
    None
}
