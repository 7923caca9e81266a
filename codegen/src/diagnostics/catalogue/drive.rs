//! Texts about motor and inverter values that do not fit together.

use super::internal;
use crate::diagnostics::{
    Code, Diagnostic, Location, at_least, at_most, engineering, frequency, percent, rpm_at_least,
    rpm_at_most, significant,
};

/// A field involved in a contradiction: name, value and place.
#[derive(Clone, Debug)]
pub struct Part {
    /// The field's name.
    pub field: &'static str,
    /// The value as written, or as it results from the default.
    pub given: String,
    /// Where it was written.
    pub location: Location,
}

impl Part {
    fn quoted(&self) -> String {
        format!("`{}` {}", self.field, self.given)
    }
}

fn with_parts(mut error: Diagnostic, parts: &[&Part]) -> Diagnostic {
    for part in parts {
        error = error.with_note(&part.location, part.quoted());
    }
    error
}

/// A bus voltage on the far side, `below` or `above`, of a board's limit.
pub fn outside_of_board(given: &Part, side: &str, limit: &Part) -> Diagnostic {
    let error = Diagnostic::new(
        Code::OutsideOfBoard,
        &given.location,
        format!(
            "`{}`: {} is {side} the board's `{}` of {}; give the voltage of its supply or take another board",
            given.field, given.given, limit.field, limit.given
        ),
    );
    with_parts(error, &[limit])
}

/// The EMF constant is far from that of any motor; `phase`, `low`, `high`: peak phase EMF over
/// mechanical speed, V s/rad.
pub fn implausible_emf(stated: &Part, phase: f64, low: f64, high: f64) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        &stated.location,
        format!(
            "`{}`: {} is {} per phase, outside {} to {}; check the number and its unit",
            stated.field,
            stated.given,
            engineering(phase, "V/(rad/s)"),
            engineering(low, "V/(rad/s)"),
            engineering(high, "V/(rad/s)"),
        ),
    )
}

/// R Ts/L exceeds 0.5. `t_s` in second, `time_constant` = L/R in second, `longest`: the longest
/// period of whole timer counts that is accepted, second, and the frequency of its PWM, hertz.
pub fn period_too_long(
    period: &Part,
    resistance: &Part,
    inductance: &Part,
    t_s: f64,
    time_constant: f64,
    [longest, f_pwm]: [f64; 2],
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::PeriodTooLong,
            &period.location,
            format!(
                "`{}`: {} is a control period of {}, but L/R of the motor is {}: R Ts/L is {} and must not exceed 0.5; use a period of at most {} (`f_pwm` of at least {})",
                period.field,
                period.given,
                engineering(t_s, "s"),
                engineering(time_constant, "s"),
                significant(t_s / time_constant),
                engineering(at_most(longest), "s"),
                engineering(at_least(f_pwm), "Hz"),
            ),
        ),
        &[resistance, inductance],
    )
}

/// What the bus voltage allows where it is too low for the rating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BusRemedy {
    /// Speed reached at rated current, mechanical rad/s.
    Speed(f64),
    /// Current at standstill, ampere, below the rated current.
    Current(f64),
}

/// Below this share of the bus a resistive drop may be right; beyond this multiple of it an EMF is
/// one of another basis.
const LIKELY: [f64; 2] = [0.5, 1.5];

/// EMF and resistive drop of the rating exceed the bus. In volt: the bus; `emf`: line to line at
/// rated speed; `drop`: of rated current in two phases.
pub fn bus_too_low(
    bus: &Part,
    [speed, current, stated, resistance]: [&Part; 4],
    [volts, emf, drop]: [f64; 3],
    remedy: BusRemedy,
) -> Diagnostic {
    let remedy = match remedy {
        BusRemedy::Speed(reachable) => format!("lower `rated_speed` to {}", rpm_at_most(reachable)),
        BusRemedy::Current(reachable) => {
            format!(
                "lower `rated_current` below {}",
                engineering(at_most(reachable), "A")
            )
        }
    };
    let culprit = if drop > LIKELY[0] * volts {
        resistance
    } else if emf > LIKELY[1] * volts {
        stated
    } else {
        speed
    };
    let parts: Vec<&Part> = [bus, speed, current, stated, resistance]
        .into_iter()
        .filter(|part| part.field != culprit.field)
        .collect();
    with_parts(
        Diagnostic::new(
            Code::BusTooLow,
            &culprit.location,
            format!(
                "`{}`: {}: the rating, {} at {}, takes {} of the bus of {}: an EMF of {} line to line and 2 R I = {}; raise the bus to {}, {remedy}, or check the bases of `{}` ({}) and `resistance` ({})",
                culprit.field,
                culprit.given,
                current.quoted(),
                speed.quoted(),
                engineering(emf + drop, "V"),
                bus.given,
                engineering(emf, "V"),
                engineering(drop, "V"),
                engineering(at_least(emf + drop), "V"),
                stated.field,
                stated.given,
                resistance.given,
            ),
        ),
        &parts,
    )
}

/// A rating of which the bus leaves part of the current at rated speed. In volt: EMF line to line at
/// rated speed; drop of rated current in two phases. What is left at rated speed, ampere and
/// newton metres; the speed at rated current, mechanical rad/s.
pub fn rating_beyond_bus(
    bus: &Part,
    [speed, current]: [&Part; 2],
    [emf, drop]: [f64; 2],
    [left, torque, reached]: [f64; 3],
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::RatingBeyondBus,
            &speed.location,
            format!(
                "`{}`: {}: there the bus of {} leaves {} of {} in two phases, {} (the EMF is {} line to line, 2 R I {}); with the rated current it reaches {}; raise the bus to {}, or lower `{}`",
                speed.field,
                speed.given,
                bus.given,
                engineering(left, "A"),
                current.quoted(),
                engineering(torque, "Nm"),
                engineering(emf, "V"),
                engineering(drop, "V"),
                rpm_at_most(reached),
                engineering(at_least(emf + drop), "V"),
                speed.field,
            ),
        ),
        &[bus, current],
    )
}

/// What contradicts the EMF constant.
#[derive(Clone, Debug)]
pub struct Contradiction<'a> {
    /// The kind of claim.
    pub code: Code,
    /// The value that is most likely wrong.
    pub culprit: &'a Part,
    /// The value that is claimed, and what it refers to.
    pub claim: &'a [&'a Part],
    /// The EMF constant.
    pub stated: &'a Part,
    /// What follows from the constant, by the current's shape.
    pub expected: Vec<String>,
    /// The first of them, as a constant, over what is claimed.
    pub ratio: f64,
    /// The value falls as the constant rises.
    pub inverse: bool,
    /// All that take part.
    pub parts: &'a [&'a Part],
    /// Readings that fit, with what follows from them.
    pub fitting: &'a [(String, String)],
}

/// Rated torque, torque constant, speed constant or no-load speed against the EMF constant.
pub fn contradiction(of: &Contradiction) -> Diagnostic {
    let [claimed, reference @ ..] = of.claim else {
        return internal(&of.culprit.location, "a contradiction without a claim");
    };
    let references: Vec<String> = reference
        .iter()
        .map(|part| format!(" at {}", part.quoted()))
        .collect();
    let at = references.concat();
    let shapes = match of.expected.as_slice() {
        [block, sine] => format!("{block} with quasi-square and {sine} with sinusoidal current"),
        expected => expected.join(" or "),
    };
    let ratio = if of.inverse { 1.0 / of.ratio } else { of.ratio };
    let advice = if of.fitting.is_empty() {
        "no other basis or shape fits either, so check the numbers against the data sheet"
            .to_owned()
    } else {
        let fits: Vec<String> = of
            .fitting
            .iter()
            .map(|(change, value)| format!("{change} ({value})"))
            .collect();
        format!("it would fit with {}", fits.join(", or with "))
    };
    let gives = format!("{} gives {shapes}{at}", of.stated.quoted());
    let told = if of.culprit.field == claimed.field {
        format!("`{}`: {}, but {gives}", claimed.field, claimed.given)
    } else if of.culprit.field == of.stated.field {
        let given = &of.stated.given;
        format!(
            "`{}`: {given} gives {shapes}{at}, not {}",
            of.stated.field,
            claimed.quoted()
        )
    } else {
        let culprit = of.culprit;
        format!(
            "`{}`: {}: {gives}, not {}",
            culprit.field,
            culprit.given,
            claimed.quoted()
        )
    };
    let parts: Vec<&Part> = of
        .parts
        .iter()
        .copied()
        .filter(|part| part.field != of.culprit.field)
        .collect();
    with_parts(
        Diagnostic::new(
            of.code,
            &of.culprit.location,
            format!(
                "{told} ({}, at most 15 % are allowed); {advice}",
                deviation(ratio),
            ),
        ),
        &parts,
    )
}

fn deviation(ratio: f64) -> String {
    if ratio >= 1.0 {
        format!("{} more", percent(ratio - 1.0))
    } else {
        format!("{} less", percent(1.0 - ratio))
    }
}

/// EMF and torque constant are one number: `peak` as it was taken, and what it is if it is a mean,
/// V s/rad.
pub fn mean_for_peak(stated: &Part, torque: &Part, peak: f64, true_peak: f64) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::MeanForPeak,
            &stated.location,
            format!(
                "`{}`: {} and {} are one number, as those of a sinusoidal motor are where both are means over block commutation; if so, say `block_mean`: the line-to-line peak is then {} in place of {}",
                stated.field,
                stated.given,
                torque.quoted(),
                engineering(true_peak, "V/(rad/s)"),
                engineering(peak, "V/(rad/s)"),
            ),
        ),
        &[torque],
    )
}

/// The current sensors do not reach the rated current; `range` in ampere.
pub fn adc_range_too_small(range: &Part, rated: &Part, reach: f64) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::AdcRangeTooSmall,
            &range.location,
            format!(
                "`{}`: {} measures up to {}, below the rated current of {}; widen the range or lower `rated_current`",
                range.field,
                range.given,
                engineering(at_most(reach), "A"),
                rated.given,
            ),
        ),
        &[rated],
    )
}

/// The trip current cannot be measured; `reach` in ampere.
pub fn trip_above_adc_range(trip: &Part, range: &Part, reach: f64) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::TripAboveAdcRange,
            &trip.location,
            format!(
                "`trip_current`: {}, but the current sensors measure up to {} only; lower it or widen `{}`",
                trip.given,
                engineering(at_most(reach), "A"),
                range.field,
            ),
        ),
        &[range],
    )
}

/// The largest set-point reaches the trip current; `peak`: greatest phase current at that
/// set-point, ampere.
pub fn max_current_above_trip(max: &Part, trip: &Part, peak: f64) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::MaxCurrentAboveTrip,
            &max.location,
            format!(
                "`max_current`: {} gives phase currents of up to {}, above the trip current of {}; lower it, or raise `trip_current`",
                max.given,
                engineering(at_least(peak), "A"),
                trip.given,
            ),
        ),
        &[trip],
    )
}

/// Hysteresis control reaches the trip current without a fault. `reach`: greatest phase current;
/// `band`: half width of the bands; `stride`: greatest change of a current in `periods` periods;
/// all in ampere.
pub fn hysteresis_reaches_trip(
    max: &Part,
    trip: &Part,
    reach: f64,
    [band, stride]: [f64; 2],
    periods: u32,
) -> Diagnostic {
    let duration = if periods == 1 {
        "a period".to_owned()
    } else {
        format!("{periods} periods")
    };
    with_parts(
        Diagnostic::new(
            Code::MaxCurrentAboveTrip,
            &max.location,
            format!(
                "`max_current`: {} gives phase currents of up to {} with phcc (with a band of {} and a change of {} by one vector in {duration}), above the trip current of {}; lower it, shorten the control period, or raise `trip_current` within `adc_range`",
                max.given,
                engineering(at_least(reach), "A"),
                engineering(band, "A"),
                engineering(stride, "A"),
                trip.given,
            ),
        ),
        &[trip],
    )
}

/// The largest set-point is too few ADC counts; `given`, `count` (one of them) in ampere.
pub fn max_current_below_counts(
    max: &Part,
    range: &Part,
    given: f64,
    count: f64,
    least: f64,
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::AdcTooCoarse,
            &max.location,
            format!(
                "`max_current`: {} is {} ADC counts of {}, below the minimum of {least} (an error of 5 % by half a count); narrow `{}`, raise `adc_bits`, or give at least {}",
                max.given,
                significant(given / count),
                engineering(count, "A"),
                range.field,
                engineering(at_least(least * count), "A"),
            ),
        ),
        &[range],
    )
}

/// A count of the bus ADC is too coarse. `count` in volt, its `share` of the nominal voltage and
/// the greatest share allowed, `most`; `widest`: widest accepted range with these `bits`, volt.
pub fn bus_resolution(
    range: &Part,
    nominal: &Part,
    [count, share, most]: [f64; 3],
    widest: f64,
    bits: u32,
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::AdcTooCoarse,
            &range.location,
            format!(
                "`bus_adc_range`: {} in {bits} bits is {} per count, {} of `bus_voltage` {}, above the {} allowed; narrow the range to {} or raise `bus_adc_bits`",
                range.given,
                engineering(count, "V"),
                percent(share),
                nominal.given,
                percent(most),
                engineering(at_most(widest), "V"),
            ),
        ),
        &[nominal],
    )
}

/// The trip current is `times` the `peak` current of the largest set-point, ampere. `given`: as
/// written or by default; `remedy`: a clause.
pub fn trip_far_above(
    at: &Location,
    given: &str,
    times: f64,
    peak: f64,
    remedy: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::TripFarAbove,
        at,
        format!(
            "`trip_current`: {given} is {} times the {} of the largest set-point, and a fault reaches it before the drive trips; {remedy}",
            significant(times),
            engineering(peak, "A"),
        ),
    )
}

/// PHCC reaches the trip current in commutations at low speed. `swing`: the current reached,
/// ampere; `trip`: the trip current, ampere.
pub fn swing_above_trip(at: &Location, max: &str, [swing, trip]: [f64; 2]) -> Diagnostic {
    Diagnostic::new(
        Code::SwingAboveTrip,
        at,
        format!(
            "`max_current`: {max} gives peaks of about {} with phcc in commutations at low speed, above the trip current of {}, so the drive may trip without a fault; lower `max_current` or widen `adc_range`",
            engineering(swing, "A"),
            engineering(trip, "A"),
        ),
    )
}

/// Of three current sensors two are read.
pub fn unread_sensor(at: &Location) -> Diagnostic {
    Diagnostic::new(
        Code::UnreadSensor,
        at,
        "`sensed_phases`: of three current sensors this version reads those of phases a and b; `bc` or `ca` names another pair"
            .to_owned(),
    )
}

/// The residual watch allows for `allowed` volts at standstill with the largest set-point, as written or
/// by default; `bus`, volt.
pub fn watch_is_blind(
    at: &Location,
    given: &str,
    max: &str,
    [allowed, bus]: [f64; 2],
) -> Diagnostic {
    Diagnostic::new(
        Code::WatchIsBlind,
        at,
        format!(
            "`residual_timeout`: {given}: with `max_current` of {max} the watch allows for {} of deviation at standstill, more than half the bus of {}, and notices little; lower `max_current`, or leave the watch out",
            engineering(allowed, "V"),
            engineering(bus, "V"),
        ),
    )
}

/// The timer period, `counts`, is outside 100 to 65535; `clock`, `f_pwm` in hertz.
pub fn timer_period(
    timer: &Part,
    period: &Part,
    counts: f64,
    clock: f64,
    f_pwm: f64,
) -> Diagnostic {
    let whole = counts.round().clamp(100.0, 65535.0);
    let problem = if counts < whole {
        "below 100, where rounding to whole counts may change the frequency by more than 0.5 %"
    } else {
        "above 65535, the limit of a 16-bit timer"
    };
    with_parts(
        Diagnostic::new(
            Code::TimerPeriod,
            &timer.location,
            format!(
                "`{}`: {} gives a centre-aligned timer period of clock/(2 f_pwm) = {} counts at {}, {problem}; {} counts need an `f_pwm` of {} or a `timer_clock` of {}",
                timer.field,
                timer.given,
                significant(counts),
                engineering(f_pwm, "Hz"),
                significant(whole),
                frequency(clock / (2.0 * whole)),
                frequency(2.0 * f_pwm * whole),
            ),
        ),
        &[period],
    )
}

/// The Hall capture timer's ticks per control period lie outside 2 to 65535.
pub fn hall_timer(clock: &Part, period: &Part, ticks: f64, t_s: f64) -> Diagnostic {
    let (problem, limit) = if ticks < 2.0 {
        ("below 2", 2.0)
    } else {
        ("above 65535", 65535.0)
    };
    with_parts(
        Diagnostic::new(
            Code::HallTimer,
            &clock.location,
            format!(
                "`hall_timer_clock`: {} counts {} ticks in a control period of {}, {problem}; use {}",
                clock.given,
                significant(ticks),
                engineering(t_s, "s"),
                frequency(limit / t_s),
            ),
        ),
        &[period],
    )
}

/// A sector at the minimum speed lasts longer than the Hall timer counts. `ticks`: its length;
/// `least`: the lowest accepted speed, rad/s; `clock`: the fastest accepted capture clock, hertz
/// (none when edges are sampled).
pub fn minimum_speed(speed: &Part, ticks: f64, least: f64, clock: Option<f64>) -> Diagnostic {
    let slower = clock.map_or_else(
        || ", or lengthen the control period".to_owned(),
        |clock| {
            format!(
                ", or lower `hall_timer_clock` to {}",
                engineering(at_most(clock), "Hz")
            )
        },
    );
    Diagnostic::new(
        Code::MinimumSpeed,
        &speed.location,
        format!(
            "`minimum_speed`: {}, where 60 electrical degrees last {} ticks of the Hall timer, above its limit of 65000; raise the speed to {}{slower}",
            speed.given,
            significant(ticks.round()),
            rpm_at_least(least),
        ),
    )
}

/// A speed on the wrong side of another; `relation`: the required one, `below` or `at least`.
pub fn speed_order(speed: &Part, relation: &str, other: &Part) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::SpeedOrder,
            &speed.location,
            format!(
                "`{}`: {} is not {relation} `{}` {}; change one of the two",
                speed.field, speed.given, other.field, other.given
            ),
        ),
        &[other],
    )
}

/// Too few control periods per electrical turn at the maximum speed. `fastest`: speed with six
/// periods, rad/s; `f_pwm`: frequency with six periods, hertz.
pub fn too_few_periods(
    speed: &Part,
    period: &Part,
    periods: f64,
    fastest: f64,
    f_pwm: f64,
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::TooFewPeriods,
            &speed.location,
            format!(
                "`maximum_speed`: {} leaves {} control periods per electrical turn, below 6; lower it to {} or raise `f_pwm` to {}",
                speed.given,
                significant(periods),
                rpm_at_most(fastest),
                engineering(at_least(f_pwm), "Hz"),
            ),
        ),
        &[period],
    )
}

/// A limit of the measured bus on the wrong side of the nominal voltage or the ADC range.
pub fn bus_measurement(limit: &Part, relation: &str, other: &Part) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::BusMeasurement,
            &limit.location,
            format!(
                "`{}`: {} is not {relation} `{}` {}; change one of the two",
                limit.field, limit.given, other.field, other.given
            ),
        ),
        &[other],
    )
}

/// The commutation threshold is at least the rated current.
pub fn threshold_above_rated(threshold: &Part, rated: &Part) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::CommutationThreshold,
            &threshold.location,
            format!(
                "`commutation_threshold`: {} is not below the rated current of {}, so a commutation would end at once; lower it to a tenth of the rated current or less",
                threshold.given, rated.given
            ),
        ),
        &[rated],
    )
}

/// The commutation threshold is below the ADC's resolution; `count` in ampere.
pub fn threshold_below_count(threshold: &Part, count: f64) -> Diagnostic {
    Diagnostic::new(
        Code::CommutationThreshold,
        &threshold.location,
        format!(
            "`commutation_threshold`: {} is below one ADC count of {}; raise it above the noise of the current measurement",
            threshold.given,
            engineering(at_least(count), "A"),
        ),
    )
}

/// The dead time exceeds a tenth of the control period.
pub fn dead_time(dead_time: &Part, t_s: f64) -> Diagnostic {
    Diagnostic::new(
        Code::DeadTime,
        &dead_time.location,
        format!(
            "`dead_time`: {} exceeds a tenth of the control period of {}; shorten it to {} or lengthen the period",
            dead_time.given,
            engineering(t_s, "s"),
            engineering(at_most(t_s / 10.0), "s"),
        ),
    )
}

/// The ADC offset is outside the middle half of the ADC range; `full`: 2^bits.
pub fn adc_offset(offset: &Part, full: u32) -> Diagnostic {
    Diagnostic::new(
        Code::AdcOffset,
        &offset.location,
        format!(
            "`adc_offset`: {} lies outside {} to {}, the middle half of the ADC's {full} counts; move it there, so that both signs of the current fit",
            offset.given,
            full / 4,
            full - full / 4,
        ),
    )
}

/// The window in which a leg must be low to be sampled takes too much of the PWM period. `needed`: before and behind
/// the turning point, second; `most`: what either may take, second, and the least duty that it leaves; `f_pwm`: the
/// greatest PWM frequency that leaves so much, hertz.
pub fn sensing_window(
    parts: &[Part],
    period: &Part,
    [before, after]: [f64; 2],
    [most, duty]: [f64; 2],
    f_pwm: f64,
) -> Diagnostic {
    let remedy = if before >= after {
        "shorten `settling_time`, `dead_time` or `sampling_lead`"
    } else {
        "shorten `aperture_time` or `conversion_time`, or raise `sampling_lead`"
    };
    let at = parts
        .first()
        .map_or(&period.location, |part| &part.location);
    let error = Diagnostic::new(
        Code::SensingWindow,
        at,
        format!(
            "`current_sensing`: to be sampled a leg must be low for {} before the timer's turning point and {} behind it, of which either may be {} at most, so that a duty of {} can be read; {remedy}, or lower `f_pwm` to {}",
            engineering(before, "s"),
            engineering(after, "s"),
            engineering(at_most(most), "s"),
            percent(duty),
            engineering(at_most(f_pwm), "Hz"),
        ),
    );
    let parts: Vec<&Part> = parts.iter().chain([period]).collect();
    with_parts(error, &parts)
}

/// The least low time takes too much of the PWM period; `most` of it, second; `limits`: the least duty that must be left,
/// and the PWM period, second.
pub fn minimum_low_time(
    time: &Part,
    period: &Part,
    most: f64,
    [duty, pwm_period]: [f64; 2],
) -> Diagnostic {
    let error = Diagnostic::new(
        Code::MinimumLowTime,
        &time.location,
        format!(
            "`minimum_low_time`: {} leaves a duty below {} of the PWM period of {}; shorten it to {} or lower `f_pwm`",
            time.given,
            percent(duty),
            engineering(pwm_period, "s"),
            engineering(at_most(most), "s"),
        ),
    );
    with_parts(error, &[period])
}

/// A list of `given` values where there are so many sensed phases.
pub fn not_of_each_phase(list: &Part, phases: &Part, given: usize, wanted: usize) -> Diagnostic {
    let error = Diagnostic::new(
        Code::SensedPhases,
        &list.location,
        format!(
            "`{}`: {} holds {given} values, but `sensed_phases` {} are {wanted}; give one value for all, or {wanted}",
            list.field, list.given, phases.given,
        ),
    );
    with_parts(error, &[phases])
}

/// A controller that turns legs off where only two low legs have sensors: its option, the value that
/// does so, and the setting in place of it.
pub fn unreadable_leg(
    at: &Location,
    [option, value, instead]: [&str; 3],
    place: &Part,
    phases: &Part,
) -> Diagnostic {
    let error = Diagnostic::new(
        Code::UnreadableLeg,
        at,
        format!(
            "`{}`: {} turns legs off, and the current of an off leg whose upper diode conducts does not flow through a sensor in its low leg: with two of them (`sensed_phases` {}) it cannot be known; choose `{}`, or a board with `current_sensing: in_phase`",
            option, value, phases.given, instead,
        ),
    );
    with_parts(error, &[place, phases])
}

/// Legs must be low for a while in every period, and this controller holds them high.
pub fn legs_held_high(at: &Location, name: &str, given: &str, kind: &str) -> Diagnostic {
    Diagnostic::new(
        Code::LegsHeldHigh,
        at,
        format!(
            "`{name}`: {given} needs legs that are low for a while in every period, but `{kind}` with these options holds legs high for whole periods; choose three pulsed legs: `pdcc` with `modulation: three_phase`, `pi-pwm` with `six_step: off`, or `p-pwm`"
        ),
    )
}
