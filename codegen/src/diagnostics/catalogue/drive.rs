//! Texts about motor and inverter values that do not fit together.

use crate::diagnostics::{Code, Diagnostic, Location, engineering, percent, rpm, significant};

/// A field that takes part in a contradiction: where it stands and how it was written.
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

/// The EMF constant is far from that of any motor; `phase`, `low`, `high`: peak phase EMF over
/// mechanical speed, V s/rad.
pub fn implausible_emf(at: &Location, given: &str, phase: f64, low: f64, high: f64) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`back_emf`: {given} is {} per phase, outside {} to {}; check the number and its unit",
            engineering(phase, "V/(rad/s)"),
            engineering(low, "V/(rad/s)"),
            engineering(high, "V/(rad/s)"),
        ),
    )
}

/// R Ts/L exceeds 0.5. `t_s` in second, `time_constant` = L/R in second.
pub fn period_too_long(
    period: &Part,
    resistance: &Part,
    inductance: &Part,
    t_s: f64,
    time_constant: f64,
) -> Diagnostic {
    let longest = 0.5 * time_constant;
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
                engineering(longest, "s"),
                engineering(1.0 / longest, "Hz"),
            ),
        ),
        &[resistance, inductance],
    )
}

/// What a bus that is too low for the rating allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BusRemedy {
    /// This mechanical speed in rad/s at rated current.
    Speed(f64),
    /// No speed at rated current, and less than this current in ampere at standstill.
    Current(f64),
}

/// EMF and resistive drop of the rating exceed the bus. `emf`: line to line at rated speed, volt;
/// `drop`: of rated current in two phases, volt.
pub fn bus_too_low(
    bus: &Part,
    [speed, current, back_emf, resistance]: [&Part; 4],
    emf: f64,
    drop: f64,
    remedy: BusRemedy,
) -> Diagnostic {
    let remedy = match remedy {
        BusRemedy::Speed(reachable) => format!("lower `rated_speed` below {}", rpm(reachable)),
        BusRemedy::Current(reachable) => {
            format!(
                "lower `rated_current` below {}",
                engineering(reachable, "A")
            )
        }
    };
    with_parts(
        Diagnostic::new(
            Code::BusTooLow,
            &bus.location,
            format!(
                "`bus_voltage`: {}, but {} at {} take {}: an EMF of {} line to line and 2 R I = {}; raise the bus above {}, {remedy}, or check the bases of `back_emf` ({}) and `resistance` ({})",
                bus.given,
                current.quoted(),
                speed.quoted(),
                engineering(emf + drop, "V"),
                engineering(emf, "V"),
                engineering(drop, "V"),
                engineering(emf + drop, "V"),
                back_emf.given,
                resistance.given,
            ),
        ),
        &[speed, current, back_emf, resistance],
    )
}

/// Rated torque against EMF constant and rated current; `expected` in Nm. `fitting`: what would
/// fit, with the torque it gives.
pub fn torque_contradiction(
    torque: &Part,
    current: &Part,
    back_emf: &Part,
    given: f64,
    expected: f64,
    fitting: &[(String, f64)],
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::TorqueContradiction,
            &torque.location,
            format!(
                "`rated_torque`: {}, but `back_emf` {} at `rated_current` {} gives {} ({}, at most 15 % are allowed); {}",
                torque.given,
                back_emf.given,
                current.given,
                engineering(expected, "Nm"),
                deviation(expected, given),
                advice(fitting, "Nm"),
            ),
        ),
        &[current, back_emf],
    )
}

/// Torque constant against EMF constant; `quasi_square`, `sinusoidal`: what the EMF constant
/// gives per peak ampere of either current shape, Nm/A.
pub fn torque_constant_contradiction(
    constant: &Part,
    back_emf: &Part,
    given: f64,
    quasi_square: f64,
    sinusoidal: f64,
    fitting: &[(String, f64)],
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::TorqueConstantContradiction,
            &constant.location,
            format!(
                "`torque_constant`: {}, but `back_emf` {} gives {} with quasi-square current and {} with sinusoidal current per peak ampere ({}, at most 15 % are allowed); {}",
                constant.given,
                back_emf.given,
                engineering(quasi_square, "Nm/A"),
                engineering(sinusoidal, "Nm/A"),
                deviation(quasi_square, given),
                advice(fitting, "Nm/A"),
            ),
        ),
        &[back_emf],
    )
}

fn deviation(expected: f64, given: f64) -> String {
    let ratio = expected / given;
    if ratio >= 1.0 {
        format!("{} more", percent(ratio - 1.0))
    } else {
        format!("{} less", percent(1.0 - ratio))
    }
}

fn advice(fitting: &[(String, f64)], unit: &str) -> String {
    if fitting.is_empty() {
        return "no other basis or shape fits either, so check the numbers against the data sheet"
            .to_owned();
    }
    let fits: Vec<String> = fitting
        .iter()
        .map(|(what, value)| format!("{what} ({})", engineering(*value, unit)))
        .collect();
    format!("it would fit with {}", fits.join(", or with "))
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
                engineering(reach, "A"),
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
                engineering(reach, "A"),
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
                "`max_current`: {} makes phase currents of up to {}, above the trip current of {}; lower it, or raise `trip_current`",
                max.given,
                engineering(peak, "A"),
                trip.given,
            ),
        ),
        &[trip],
    )
}

/// Timer clock and PWM frequency give no timer period from 100 to 65535; `counts` is what they
/// give; `clock`, `f_pwm` in hertz.
pub fn timer_period(
    timer: &Part,
    period: &Part,
    counts: f64,
    clock: f64,
    f_pwm: f64,
) -> Diagnostic {
    let whole = counts.round().clamp(100.0, 65535.0);
    let problem = if counts < 99.5 {
        "below 100, too coarse"
    } else if counts > 65535.5 {
        "above 65535, the end of a 16-bit timer"
    } else {
        "not a whole number"
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
                exact(clock / (2.0 * whole)),
                exact(2.0 * f_pwm * whole),
            ),
        ),
        &[period],
    )
}

/// Nine digits, so that the advice can be followed literally.
fn exact(frequency: f64) -> String {
    let (scale, unit) = match frequency {
        f if f >= 1e9 => (1e9, "GHz"),
        f if f >= 1e6 => (1e6, "MHz"),
        f if f >= 1e3 => (1e3, "kHz"),
        _ => (1.0, "Hz"),
    };
    let scaled = frequency / scale;
    let digits = 8 - scaled.log10().floor().clamp(0.0, 8.0) as usize;
    let text = format!("{scaled:.digits$}");
    let text = if digits > 0 {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    format!("{text} {unit}")
}

/// The Hall capture timer's ticks per control period are no whole number from 2 to 65535.
pub fn hall_timer(clock: &Part, period: &Part, ticks: f64, t_s: f64) -> Diagnostic {
    let whole = ticks.round().clamp(2.0, 65535.0);
    let problem = if ticks < 1.5 {
        "below 2"
    } else if ticks > 65535.5 {
        "above 65535"
    } else {
        "not a whole number"
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
                exact(whole / t_s),
            ),
        ),
        &[period],
    )
}

/// A sector at the least speed lasts longer than the Hall timer counts. `ticks`: its length;
/// `least`: the least speed that fits, rad/s; `clock`: the fastest capture clock that fits, hertz
/// (none when edges are sampled).
pub fn minimum_speed(speed: &Part, ticks: f64, least: f64, clock: Option<f64>) -> Diagnostic {
    let slower = clock.map_or_else(
        || ", or lengthen the control period".to_owned(),
        |clock| {
            format!(
                ", or lower `hall_timer_clock` below {}",
                engineering(clock, "Hz")
            )
        },
    );
    Diagnostic::new(
        Code::MinimumSpeed,
        &speed.location,
        format!(
            "`minimum_speed`: {}, where 60 electrical degrees last {} ticks of the Hall timer, above its limit of 65000; raise the speed above {}{slower}",
            speed.given,
            significant(ticks.round()),
            rpm(least),
        ),
    )
}

/// A speed on the wrong side of another one; `relation`: what it should be, `below` or `at least`.
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

/// Too few control periods per electrical turn at the greatest speed; `fastest`: the speed with
/// six of them, rad/s; `f_pwm`: the frequency that gives six, hertz.
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
                "`maximum_speed`: {} leaves {} control periods in an electrical turn, below 6; lower it to {} or raise `f_pwm` to {}",
                speed.given,
                significant(periods),
                rpm(fastest),
                engineering(f_pwm, "Hz"),
            ),
        ),
        &[period],
    )
}

/// A limit of the measured bus on the wrong side of the nominal voltage or the converter.
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
                "`commutation_threshold`: {} is not below the rated current of {}, so that a commutation would end at once; lower it to a tenth of the rated current or less",
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
            engineering(count, "A"),
        ),
    )
}

/// The dead time exceeds a tenth of the control period.
pub fn dead_time(dead_time: &Part, t_s: f64) -> Diagnostic {
    Diagnostic::new(
        Code::DeadTime,
        &dead_time.location,
        format!(
            "`dead_time`: {} exceeds a tenth of the control period of {}; shorten it below {} or lengthen the period",
            dead_time.given,
            engineering(t_s, "s"),
            engineering(t_s / 10.0, "s"),
        ),
    )
}

/// The ADC offset lies outside the middle half of the converter's range; `full`: 2^bits.
pub fn adc_offset(offset: &Part, full: u32) -> Diagnostic {
    Diagnostic::new(
        Code::AdcOffset,
        &offset.location,
        format!(
            "`adc_offset`: {} lies outside {} to {}, the middle half of the converter's {full} counts; both signs of the current need room",
            offset.given,
            full / 4,
            full - full / 4,
        ),
    )
}
