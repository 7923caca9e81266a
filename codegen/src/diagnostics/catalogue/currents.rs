//! Texts about current sensors, trip level and largest current.

use super::part::{Part, with_parts};
use crate::diagnostics::{
    Code, Diagnostic, Location, at_least, at_most, engineering, percent, significant,
};

/// The clause by which current sensors reach farther.
fn widen(range: &Part) -> String {
    match range.field {
        "shunt" => "take a smaller `shunt` or `amplifier_gain`".to_owned(),
        "adc_gain" => "take less sensitive sensors (more ampere to a count of `adc_gain`)".to_owned(),
        "amplifier_swing" => {
            "raise `amplifier_swing` if the amplifier's output follows farther, or take a smaller `shunt` or `amplifier_gain`, or less sensitive sensors"
                .to_owned()
        }
        field => format!("widen `{field}`"),
    }
}

/// The clause by which a count is a smaller current.
fn narrow(range: &Part) -> String {
    match range.field {
        "shunt" => "take a larger `shunt` or `amplifier_gain`".to_owned(),
        "adc_gain" => {
            "take more sensitive sensors (less ampere to a count of `adc_gain`)".to_owned()
        }
        field => format!("narrow `{field}`"),
    }
}

/// Sensors that reach less than this share of the rated current belong to another motor, or their value is wrong.
const OF_OTHER_MOTOR: f64 = 0.01;

/// The current sensors do not reach the rated current, which the largest set-point is at least by default;
/// `reach`, and the largest set-point `most` that leaves room to trip, if it is known: ampere.
pub fn adc_range_too_small(
    range: &Part,
    (rated, current): (&Part, f64),
    reach: f64,
    most: Option<f64>,
) -> Diagnostic {
    let most = most.map_or(String::new(), |most| {
        format!(" of at most {}", engineering(at_most(most), "A"))
    });
    let remedy = if reach < OF_OTHER_MOTOR * current {
        "it is likely a thousandfold off: check the number and the prefix of its unit".to_owned()
    } else {
        format!("{}, or state a `max_current`{most}", widen(range))
    };
    with_parts(
        Diagnostic::new(
            Code::AdcRangeTooSmall,
            &range.location,
            format!(
                "`{}`: {} measures up to {}, below the rated current of {}; {remedy}",
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
                "`trip_current`: {}, but the current sensors measure up to {} only; lower it or {}",
                trip.given,
                engineering(at_most(reach), "A"),
                widen(range),
            ),
        ),
        &[range],
    )
}

/// A largest set-point of so many `times` the rated current.
pub fn current_far_above_rated(max: &Part, rated: &Part, times: f64) -> Diagnostic {
    let warning = Diagnostic::new(
        Code::CurrentFarAboveRated,
        &max.location,
        format!(
            "`max_current`: {} is {} times the rated current of {}, so the windings may take {} times the copper loss of the rating, and nothing in the drive limits for how long; lower it, or correct `rated_current`",
            max.given,
            significant(times),
            rated.given,
            significant(times * times),
        ),
    );
    with_parts(warning, &[rated])
}

/// A gain of the current sensors far from that of the board, ampere per count: the one that is taken, and the board's.
pub fn gain_unlike_board(own: &Part, board: &Part, [gain, of_board]: [f64; 2]) -> Diagnostic {
    let times = significant(of_board / gain);
    let follows = if gain > of_board {
        format!(
            "true currents and torque are {times} times what is asked, and the loop, which sees too large a change, may trip with `OverCurrent`"
        )
    } else {
        format!(
            "true currents and torque are {times} times what is asked, as is the true current of a trip"
        )
    };
    let [gain, of_board] = [gain, of_board].map(|gain| engineering(gain, "A"));
    let warning = Diagnostic::new(
        Code::GainUnlikeBoard,
        &own.location,
        format!(
            "`{}`: {} makes {gain} a count, the board's `{}` of {} {of_board}: if the board's is right, {follows}; measure the gain, remove the field, or describe a board with other sensors in a file of its own",
            own.field, own.given, board.field, board.given,
        ),
    );
    with_parts(warning, &[board])
}

/// The largest set-point and the trip level; currents in ampere.
#[derive(Clone, Debug)]
pub struct TripRoom {
    /// Largest set-point.
    pub max: Part,
    /// Trip level.
    pub level: Part,
    /// What the current sensors' range follows from.
    pub range: Part,
    /// Greatest phase current at the largest set-point.
    pub peak: f64,
    /// Trip level.
    pub trip: f64,
    /// Least trip level that leaves room for overshoot and ripple.
    pub needed: f64,
    /// Greatest trip level that may be stated.
    pub shown: f64,
    /// Largest set-point that leaves room below the trip level as stated, or by default.
    pub most: f64,
}

impl TripRoom {
    /// The clause by which there is room: a higher level where the sensors show as much.
    fn remedy(&self) -> String {
        let most = engineering(at_most(self.most), "A");
        if self.needed <= self.shown {
            let needed = engineering(at_least(self.needed), "A");
            format!("state a `trip_current` of {needed}, or lower `max_current` to {most}")
        } else {
            format!(
                "the sensors show up to {}: lower `max_current` to {most}, or {}",
                engineering(at_most(self.shown), "A"),
                widen(&self.range)
            )
        }
    }
}

/// The largest set-point reaches the trip current.
pub fn max_current_above_trip(room: &TripRoom) -> Diagnostic {
    let relation = format!("above the trip current of {}", room.level.given);
    without_room(Code::MaxCurrentAboveTrip, room, &relation)
}

/// Between the largest set-point and the trip level is less room than overshoot and ripple take.
pub fn trip_near_set_point(room: &TripRoom) -> Diagnostic {
    let relation = format!(
        "and the drive trips at {}: overshoot and ripple may trip it without a fault",
        room.level.given
    );
    without_room(Code::TripNearSetPoint, room, &relation)
}

/// `relation`: of the phase currents to the trip level, a clause.
fn without_room(code: Code, room: &TripRoom, relation: &str) -> Diagnostic {
    let message = format!(
        "`max_current`: {} gives phase currents of up to {}, {relation}; {}",
        room.max.given,
        engineering(at_least(room.peak), "A"),
        room.remedy(),
    );
    with_parts(
        Diagnostic::new(code, &room.max.location, message),
        &[&room.level, &room.range],
    )
}

/// A limit of the bus current above a trip level that is itself too near to the largest set-point, ampere.
pub fn bus_current_above_trip(limit: &Part, trip: f64, needed: f64) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        &limit.location,
        format!(
            "`{}`: {} lies above the trip level of {}, which is too near to `max_current`; state a `trip_current` of {}",
            limit.field,
            limit.given,
            engineering(trip, "A"),
            engineering(at_least(needed), "A"),
        ),
    )
}

/// A limit of the current that is returned to the supply, outside what can be held; `low`, `high`: its limits.
pub fn return_current_outside(limit: &Part, low: &str, high: &str) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        &limit.location,
        format!(
            "`{}`: {} lies outside {low} to {high}; give a value within, or, for a supply that takes nothing back, remove it and let a `braking_fade` with `v_bus: measured` take the braking torque away as the bus voltage rises",
            limit.field, limit.given,
        ),
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

/// A rated current of too few ADC counts, a thousand times which the sensors show; `given`, `count` in ampere.
pub fn thousandth_of_current(current: &Part, range: &Part, given: f64, count: f64) -> Diagnostic {
    let message = format!(
        "`{}`: {} is {} ADC counts of {}, likely a thousandfold off; check the number and the prefix of its unit",
        current.field,
        current.given,
        significant(given / count),
        engineering(count, "A"),
    );
    let error = Diagnostic::new(Code::AdcTooCoarse, &current.location, message);
    with_parts(error, &[range])
}

/// The rated current or the largest set-point is too few ADC counts; `given`, `count` (one of them) in ampere.
pub fn current_below_counts(
    current: &Part,
    range: &Part,
    given: f64,
    count: f64,
    least: f64,
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::AdcTooCoarse,
            &current.location,
            format!(
                "`{}`: {} is {} ADC counts of {}, below the minimum of {least} (an error of 5 % by half a count); {}, raise `adc_bits`, or give at least {}",
                current.field,
                current.given,
                significant(given / count),
                engineering(count, "A"),
                narrow(range),
                engineering(at_least(least * count), "A"),
            ),
        ),
        &[range],
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

/// The window in which a leg must be low to be sampled takes too much of the PWM period. `leads`: it is sampled before
/// the turning point; `before` and `after`: of that, second; `most`: what either may take, second, and the least duty
/// that it leaves; `f_pwm`: the greatest PWM frequency that leaves so much, hertz.
pub fn sensing_window(
    parts: &[Part],
    (period, leads): (&Part, bool),
    [before, after]: [f64; 2],
    [most, duty]: [f64; 2],
    f_pwm: Option<f64>,
) -> Diagnostic {
    let remedy = if before < after {
        "shorten `aperture_time` or `conversion_time`, or raise `sampling_lead`"
    } else if leads {
        "shorten `settling_time`, `dead_time` or `sampling_lead`"
    } else {
        "shorten `settling_time` or `dead_time`"
    };
    let slower = f_pwm.map_or(String::new(), |f_pwm| {
        let f_pwm = engineering(at_most(f_pwm), "Hz");
        format!(", or lower `f_pwm` to {f_pwm}")
    });
    let at = parts
        .first()
        .map_or(&period.location, |part| &part.location);
    let error = Diagnostic::new(
        Code::SensingWindow,
        at,
        format!(
            "`current_sensing`: to be sampled a leg must be low for {} before the timer's turning point and {} behind it, of which either may be {} at most, so that a duty of {} can be read; {remedy}{slower}",
            engineering(before, "s"),
            engineering(after, "s"),
            engineering(at_most(most), "s"),
            percent(duty),
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

/// Gains of two sensors that differ too much; ampere.
pub fn unlike_gains(gains: &Part, [first, other]: [f64; 2]) -> Diagnostic {
    Diagnostic::new(
        Code::UnlikeGains,
        &gains.location,
        format!(
            "`adc_gain`: a count of one sensor is {}, of the first {}; they may differ by a factor of 2 at most: correct one, or name two phases with sensors alike in `sensed_phases`",
            engineering(other, "A"),
            engineering(first, "A"),
        ),
    )
}

/// Three sensors on fewer converters cannot be sampled at once.
pub fn shared_converter(conversion: &Part, converters: u32) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        &conversion.location,
        format!(
            "`conversion_time`: {} is only of sensors that each have a converter of their own; {converters} `current_adcs` share three sensors, so give the time from one sample to the next",
            conversion.given
        ),
    )
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
            "`{}`: {} turns legs off, and the current of an off leg whose upper diode conducts does not flow through a sensor in its low leg: with two of them (`sensed_phases` {}) it cannot be known; choose `{}`, or a board with three sensors or with `current_sensing: in_phase`",
            option, value, phases.given, instead,
        ),
    );
    with_parts(error, &[place, phases])
}

/// A controller that turns legs off where three low legs have sensors, of which one may be read while its leg turns off;
/// `lead`, second, is early enough.
pub fn leg_turned_off_early(
    at: &Location,
    [option, value, instead]: [&str; 3],
    given: &Part,
    lead: f64,
) -> Diagnostic {
    let error = Diagnostic::new(
        Code::UnreadableLeg,
        at,
        format!(
            "`{option}`: {value} turns legs off, and a sensor in a low leg must be read before its leg may turn off: `sampling_lead` of {} has to be {} at least, for aperture and conversions; state that, or choose `{instead}`",
            given.given,
            engineering(at_least(lead), "s"),
        ),
    );
    with_parts(error, &[given])
}

/// The residual watch tolerates more than faults cause: the deviation that it tolerates at standstill with the
/// largest set-point `max`, and the bus voltage, both in volt. `given` and `max` are as written, or the default.
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
