//! Motor and inverter together: control period, bus voltage, speeds.

use super::inverter::Inverter;
use super::motor::Motor;
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Code, Collector, Diagnostic, at_least, engineering};
use crate::spec::ast::Basis;
use crate::spec::reader::Reader;
use crate::spec::{
    BusSource, ControllerSpec, CurrentSensing, Envelope, MotorSpec, Reference, RotorSensing,
};
use std::f64::consts::{FRAC_PI_3, TAU};

/// The most over `rated_speed` that the default of `minimum_speed` becomes for a fast Hall timer.
pub(super) const GREATEST_MINIMUM: f64 = 0.04;

/// Greatest R Ts/L: above it the current decays within a period, and prediction is useless.
const GREATEST_DECAY: f64 = 0.5;

/// Most ticks of the 16-bit Hall timer in 60 electrical degrees.
const GREATEST_AGE: f64 = 65_000.0;

/// Fewest control periods per electrical turn: one per sector.
const LEAST_PERIODS: f64 = 6.0;

/// The same with an angle sensor, also at the over-speed: differences of angles are believed up to 30 degrees, and
/// a quarter more than at the greatest speed must be seen.
const LEAST_WITH_ANGLE: f64 = 15.0;

/// Fewest control periods per electrical turn at the over-speed. More than one per sector: a rotor that
/// speeds up, or sensors out of place, must not skip a sector before seven edges have told the speed.
const LEAST_WATCHED: f64 = 8.0;

/// No motor's current decays so slowly, s.
const LONGEST_TIME_CONSTANT: f64 = 0.3;

/// No drive switches so fast: where only such a PWM frequency helped, resistance or inductance is wrong, hertz.
const ABSURD_PWM: f64 = 500e3;

/// What R Ts/L tells of the motor's data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decay {
    /// It is small, and R and L fit each other.
    Short,
    /// It is large, and the period may be.
    Long,
    /// R or L is wrong, and that has been told.
    Absurd,
    /// R is wrong: its drop alone exceeds the bus, which is still to be told.
    ByResistance,
}

/// Accepted: R Ts/L <= 0.5. Refused: a period that is long against L/R.
pub(super) fn check_period(
    reader: &Reader,
    motor: &Motor,
    inverter: &Inverter,
    errors: &mut Collector,
) -> Option<Decay> {
    let t_s = inverter.t_s?;
    let time_constant = motor.inductance? / motor.resistance?;
    let resistance = reader.part("resistance", String::new);
    let inductance = reader.part("inductance", String::new);
    let longest = inverter.period_within(GREATEST_DECAY * time_constant);
    let f_pwm = f64::from(inverter.pwm_per_control) / longest;
    let (current, bus) = (motor.rated_current.as_ref(), inverter.v_bus.as_ref());
    let drop = |impedance: f64| impedance * current.map_or(0.0, |given| given.si);
    let exceeds = |drop: f64, most: f64| bus.is_some_and(|bus| drop > most * bus.si);
    // Between two terminals, of a sinusoidal current.
    let is_beyond = exceeds(3.0_f64.sqrt() * drop(motor.resistance?), MOST_OF_BUS);
    let absurd = if time_constant > LONGEST_TIME_CONSTANT {
        // What the bus cannot drive through the inductance at rated speed is too much of it.
        let reactance = motor.rated_speed.as_ref().map_or(0.0, |speed| {
            speed.si * f64::from(motor.pole_pairs.unwrap_or(1)) * motor.inductance.unwrap_or(0.0)
        });
        Some(!exceeds(drop(reactance), 1.0))
    } else if t_s / time_constant <= GREATEST_DECAY * (1.0 + 1e-9) {
        return Some(Decay::Short);
    } else {
        (f_pwm > ABSURD_PWM).then_some(is_beyond)
    };
    if let Some(is_resistance) = absurd {
        let (likely, other) = if is_resistance {
            (resistance, inductance)
        } else {
            (inductance, resistance)
        };
        let error = catalogue::absurd_time_constant(&likely, &other, time_constant);
        errors.push(error);
        return Some(Decay::Absurd);
    }
    if is_beyond {
        return Some(Decay::ByResistance);
    }
    tell_long_period(reader, motor, inverter, errors);
    Some(Decay::Long)
}

/// Reports a period that is long against L/R.
pub(super) fn tell_long_period(
    reader: &Reader,
    motor: &Motor,
    inverter: &Inverter,
    errors: &mut Collector,
) -> Option<()> {
    let (period, t_s) = (inverter.period.as_ref()?, inverter.t_s?);
    let time_constant = motor.inductance? / motor.resistance?;
    let longest = inverter.period_within(GREATEST_DECAY * time_constant);
    let f_pwm = f64::from(inverter.pwm_per_control) / longest;
    errors.push(catalogue::period_too_long(
        &period.part,
        &reader.part("resistance", String::new),
        &reader.part("inductance", String::new),
        t_s,
        time_constant,
        [longest, f_pwm],
    ));
    Some(())
}

/// Most of the bus that EMF and resistive drop of a rating may take: beyond it a value is rather wrong.
const MOST_OF_BUS: f64 = 1.25;

/// Accepted: a bus that covers the line-to-line EMF at rated speed, and with what rated current drops
/// between two terminals misses that by a little. `board_bus`: the greatest bus voltage that the board states, volt. Refused: a rating far beyond, of which a value is wrong. An
/// accepted rating is not promised to be held: the envelope of the whole drive tells.
pub(super) fn check_bus(
    reader: &Reader,
    motor: &Motor,
    inverter: &Inverter,
    (controller, board_bus, decay): (Option<&ControllerSpec>, Option<f64>, Option<Decay>),
    errors: &mut Collector,
) -> Option<()> {
    let (bus, speed, current) = (
        inverter.v_bus.as_ref()?,
        motor.rated_speed.as_ref()?,
        motor.rated_current.as_ref()?,
    );
    let stated = &motor.emf.first()?.given;
    let whole = motor.finish()?;
    let envelope = envelope(&whole, inverter, controller?.common().reference)?;
    let set_point = current.si * whole.rated_torque_constant() / envelope.torque_constant();
    let voltages = envelope.voltages(speed.si, set_point);
    let [emf, drop, _] = voltages;
    let most = bus.si * (1.0 + 1e-9);
    if emf <= most && emf + drop <= MOST_OF_BUS * most {
        return Some(());
    }
    // With these the rating is not beyond the envelope either, which vectors of pairs make smaller.
    let envelope = Envelope {
        pairs: controller?.has_intervals(),
        ..envelope
    };
    let torque = whole
        .torque_rating()
        .max(set_point * envelope.torque_constant());
    let raised = envelope.bus_voltage(speed.si, torque / envelope.torque_constant());
    // Peaks of EMF and drop that do not coincide are told by their sum.
    let raised = raised.max(emf + drop);
    let [resistance, inductance] =
        ["resistance", "inductance"].map(|name| reader.part(name, String::new));
    let is_confirmed = motor.emf.len() > 1 || motor.rated_torque.is_some();
    // A resistance that fits the inductance is right, and the current is wrong.
    let of_drop = if decay == Some(Decay::Short) {
        &current.part
    } else {
        &resistance
    };
    let values = [&stated.part, of_drop, &inductance];
    let absurd = catalogue::most_of_absurd([bus.si, raised], voltages, values);
    // A rated speed up to the no-load speed is the shaft's.
    let is_of_shaft = (motor.no_load_speed.as_ref()).is_some_and(|no_load| speed.si <= no_load.si);
    let shaft_speed =
        shaft_speed(speed.si, whole.pole_pairs, [bus.si, emf, drop]).filter(|_| !is_of_shaft);
    // A constant that another field states, too, is right, and so it is where an electrical speed makes it too much.
    let is_right = is_confirmed || shaft_speed.is_some();
    if let Some(value) = absurd.filter(|value| value.field != stated.part.field || !is_right) {
        let error = catalogue::thousandfold(Code::BusTooLow, value, [bus.si, raised]);
        errors.push(error);
        return Some(());
    }
    errors.push(catalogue::bus_too_low(
        &bus.part,
        [&speed.part, &current.part, &stated.part, &resistance],
        [bus.si, emf, drop],
        catalogue::Stated {
            is_confirmed,
            is_peak: stated.basis.contains(&Basis::Peak),
            shaft_speed,
        },
        (
            Some(raised).filter(|raised| {
                let is_of_board = board_bus.is_none_or(|most| *raised <= most);
                is_of_board && inverter.bus.is_none_or(|bus| bus.takes(*raised))
            }),
            envelope.speed(torque).map_or(
                catalogue::BusRemedy::Current(current.si * bus.si / drop),
                |speed| match inverter.sensing.place {
                    Some(CurrentSensing::LowSide(_)) => catalogue::BusRemedy::BelowSpeed(speed),
                    _ => catalogue::BusRemedy::Speed(speed),
                },
            ),
        ),
    ));
    Some(())
}

/// Times from rest to rated speed with rated torque, second: a bare rotor takes more, a vehicle less.
const RUN_UP: [f64; 2] = [1e-3, 60.0];

/// Warns of an inertia whose unit is probably wrong.
pub(super) fn check_inertia(
    reader: &Reader,
    motor: &Motor,
    warnings: &mut Vec<Diagnostic>,
) -> Option<()> {
    let (inertia, whole) = (motor.inertia?, motor.finish()?);
    let torque = whole.torque_rating();
    let time = inertia * whole.rated_speed / torque;
    let [least, most] = RUN_UP;
    if !(least..=most).contains(&time) {
        let part = reader.part("inertia", String::new);
        warnings.push(catalogue::unlikely_inertia(&part, torque, time, RUN_UP));
    }
    Some(())
}

/// EMF of a rating over the bus from which on its speed may be an electrical one: below, it is rather a little too high.
const ELECTRICAL: f64 = 1.5;

/// Least part of the bus that a rating takes.
const LEAST_OF_BUS: f64 = 0.2;

/// The shaft's speed, if the stated one is an electrical speed and the rating fits the bus then; in volt: the bus, the EMF
/// at the stated speed, and the resistive drop.
fn shaft_speed(stated: f64, pole_pairs: u32, [bus, emf, drop]: [f64; 3]) -> Option<f64> {
    let pairs = f64::from(pole_pairs);
    let fits = (LEAST_OF_BUS..=1.0).contains(&((emf / pairs + drop) / bus));
    (pole_pairs > 1 && emf > ELECTRICAL * bus && fits).then_some(stated / pairs)
}

/// The envelope of a drive whose legs reach the whole bus: what windows of sensors take is not known yet.
fn envelope(motor: &MotorSpec, inverter: &Inverter, reference: Reference) -> Option<Envelope> {
    Some(Envelope {
        emf_shape: motor.emf_shape,
        reference,
        pole_pairs: f64::from(motor.pole_pairs),
        resistance: motor.resistance,
        inductance: motor.inductance,
        emf_constant: motor.emf_constant,
        t_s: inverter.t_s?,
        v_bus: inverter.v_bus.as_ref()?.si,
        reach: 1.0,
        pairs: false,
        max_current: f64::INFINITY,
        bus_current: None,
        weakening: None,
    })
}

/// Least speed that the Hall timer can measure, mechanical rad/s; none with an angle.
pub(super) fn slowest(
    inverter: &Inverter,
    motor: &Motor,
    capture: Option<RotorSensing>,
) -> Option<f64> {
    if matches!(capture?, RotorSensing::Angle(_)) {
        return None;
    }
    let per_second = capture?.ticks_per_period() / inverter.t_s?;
    let [_, widest] = motor.extreme_sectors();
    let sector = FRAC_PI_3 * widest;
    Some(per_second * sector / (GREATEST_AGE * f64::from(motor.pole_pairs?)))
}

/// Whether a Hall timer of this clock counts a control period, and a sector at the least speed, stated or by default; so
/// too where one of these is not known.
pub(super) fn counts_sectors(inverter: &Inverter, motor: &Motor, clock: f64) -> bool {
    let ticks = inverter.t_s.map_or(2.0, |t_s| clock * t_s);
    let slowest = slowest(inverter, motor, Some(RotorSensing::TimedHalls { ticks }));
    let rated = motor.rated_speed.as_ref().map(|rated| rated.si);
    let stated = inverter.minimum_speed.as_ref().map(|given| given.si);
    let most = stated.or(rated.map(|rated| GREATEST_MINIMUM * rated));
    let is_measured = slowest
        .zip(most)
        .is_none_or(|(slowest, most)| slowest <= most);
    (2.0..=65535.0).contains(&ticks) && is_measured
}

/// Minimum, rated and maximum speed in ascending order, within the Hall timer and the period.
pub(super) fn check_speeds(
    inverter: &Inverter,
    motor: &Motor,
    capture: Option<RotorSensing>,
    (minimum, minimum_part): (f64, &Part),
    (maximum, maximum_part): (f64, &Part),
    errors: &mut Collector,
) -> Option<()> {
    let rated = motor.rated_speed.as_ref()?;
    if minimum >= rated.si {
        errors.push(catalogue::speed_order(minimum_part, "below", &rated.part));
        return None;
    }
    if maximum < rated.si * (1.0 - 1e-9) {
        errors.push(catalogue::speed_order(
            maximum_part,
            "at least",
            &rated.part,
        ));
        return None;
    }
    let (t_s, period) = (inverter.t_s?, inverter.period.as_ref()?);
    let pole_pairs = f64::from(motor.pole_pairs?);
    // A sample in the narrowest sector.
    let [narrowest, widest] = motor.extreme_sectors();
    let periods = TAU / (maximum * pole_pairs * t_s) * narrowest;
    let least = if matches!(capture, Some(RotorSensing::Angle(_))) {
        LEAST_WITH_ANGLE
    } else {
        LEAST_PERIODS
    };
    // By default it follows from the rated speed, whose own error suffices.
    let is_stated = inverter.maximum_speed.is_some();
    if periods < least * (1.0 - 1e-9) && (is_stated || !errors.has(Code::BusTooLow)) {
        let fastest = maximum * periods / least;
        let f_pwm =
            f64::from(inverter.pwm_per_control) / inverter.period_within(t_s * periods / least);
        errors.push(catalogue::too_few_periods(
            maximum_part,
            &period.part,
            [periods, least],
            fastest,
            f_pwm,
        ));
    }
    let clocked = capture.filter(|sensing| !matches!(sensing, RotorSensing::Angle(_)))?;
    let per_second = clocked.ticks_per_period() / t_s;
    let ticks = per_second * FRAC_PI_3 * widest / (minimum * pole_pairs);
    if ticks > GREATEST_AGE * (1.0 + 1e-9) {
        let least = minimum * ticks / GREATEST_AGE;
        // As it is printed, to four digits, it must still be below the rated speed.
        let least = Some(least).filter(|least| *least < 0.999 * rated.si);
        let is_timed = matches!(clocked, RotorSensing::TimedHalls { .. });
        let clock = is_timed.then_some(per_second * GREATEST_AGE / ticks);
        let stated = inverter.hall_timer_clock.as_ref();
        let culprit = stated.filter(|_| is_timed && inverter.minimum_speed.is_none());
        let culprit = culprit.map(|clock| &clock.part);
        errors.push(catalogue::minimum_speed(
            minimum_part,
            ticks,
            least,
            clock,
            culprit,
        ));
    }
    Some(())
}

/// Accepted: a clamp above the bus; without one, field weakening up to the speed at which the EMF is the greatest
/// bus voltage.
pub(super) fn check_bus_clamp(
    reader: &Reader,
    inverter: &Inverter,
    motor: &Motor,
    (maximum, maximum_part): (f64, &Part),
    weakens: bool,
    errors: &mut Collector,
) -> Option<()> {
    let v_bus = inverter.v_bus.as_ref()?;
    let (field, volts) = match inverter.bus? {
        BusSource::Measured { max, .. } => ("bus_max", max),
        BusSource::Fixed => ("bus_voltage", v_bus.si),
    };
    let part = reader.part(field, || engineering(volts, "V"));
    if let Some(clamp) = &inverter.bus_clamp {
        if clamp.si < volts * (1.0 - 1e-9) {
            errors.push(catalogue::out_of_limits(
                &clamp.part.location,
                "bus_clamp",
                &clamp.part.given,
                &format!("{} (`{field}`)", engineering(at_least(volts), "V")),
                "4 kV",
            ));
        }
        return Some(());
    }
    let per_speed = motor.emf_constant? * motor.emf_shape?.line_to_line_peak();
    let emf = per_speed * maximum;
    if weakens && emf > volts * (1.0 + 1e-9) {
        errors.push(catalogue::emf_above_bus(
            maximum_part,
            emf,
            (&part, volts),
            volts / per_speed,
        ));
    }
    Some(())
}

/// Accepted: an over-speed that no run at rated speed reaches, although a turn is measured to a control
/// period, and whose sectors last long enough to be seen. Refused: any other.
pub(super) fn check_over_speed(
    inverter: &Inverter,
    motor: &Motor,
    errors: &mut Collector,
) -> Option<()> {
    let (given, rated) = (inverter.over_speed.as_ref()?, motor.rated_speed.as_ref()?);
    let (t_s, period) = (inverter.t_s?, inverter.period.as_ref()?);
    let pole_pairs = f64::from(motor.pole_pairs?);
    // The same of speeds and of control periods: the one of the other.
    let turn = |of: f64| TAU / (of * pole_pairs * t_s);
    let [narrowest, _] = motor.extreme_sectors();
    let watched = if motor.angle.is_some() {
        LEAST_WITH_ANGLE
    } else {
        LEAST_WATCHED
    };
    let fastest = turn(watched / narrowest);
    let least = turn((turn(rated.si) - 1.0).max(1.0));
    let is_within = least * (1.0 - 1e-9) <= given.si && given.si <= fastest * (1.0 + 1e-9);
    if !is_within {
        errors.push(catalogue::over_speed(
            &given.part,
            &rated.part,
            &period.part,
            [least, fastest],
        ));
    }
    Some(())
}
