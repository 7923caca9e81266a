//! Texts about periods, timers and speeds.

use super::part::{Part, with_parts};
use crate::diagnostics::{
    Code, Diagnostic, Location, at_least, at_most, engineering, frequency, percent, rpm,
    rpm_at_least, rpm_at_most, significant,
};

/// L/R is far shorter than that of any motor, by the one of both that is `likely` a thousandfold off.
/// `time_constant` = L/R in second.
pub fn absurd_time_constant(likely: &Part, other: &Part, time_constant: f64) -> Diagnostic {
    let message = format!(
        "`{}`: {} is likely a thousandfold off: with {} L/R is {}, as of no motor; check the number and the prefix of its unit",
        likely.field,
        likely.given,
        other.quoted(),
        engineering(time_constant, "s"),
    );
    let error = Diagnostic::new(Code::PeriodTooLong, &likely.location, message);
    with_parts(error, &[other])
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

/// A step that may take longer than the control period.
#[derive(Clone, Debug)]
pub struct LongStep<'a> {
    /// The core as written.
    pub given: String,
    /// The chip whose cycles were counted.
    pub chip: &'a str,
    /// Cycles of a step at most, in Rust and in C.
    pub most: [f64; 2],
    /// Clock of the core, hertz.
    pub clock: f64,
    /// Whether the specification states the clock.
    pub is_stated: bool,
    /// Control period, second.
    pub period: f64,
    /// Cycles in Rust without the error, and the error as a part of them; none for a counted drive.
    pub estimate: Option<(u32, f64)>,
}

impl LongStep<'_> {
    /// What the control period has, a clause, and what to do first.
    fn of_period(&self) -> String {
        let faster = if self.is_stated {
            ""
        } else {
            "state `core_clock` if your core is faster, "
        };
        format!(
            "the control period of {} has {} at {}; {faster}",
            engineering(self.period, "s"),
            (self.clock * self.period).floor(),
            engineering(self.clock, "Hz"),
        )
    }

    /// Greatest control frequencies of a step in Rust and in C.
    fn frequencies(&self) -> [String; 2] {
        self.most
            .map(|most| engineering(at_most(self.clock / most), "Hz"))
    }
}

/// A step that may take longer than the control period in Rust, and so in C.
pub fn step_exceeds_period(at: &Location, step: &LongStep) -> Diagnostic {
    let [most, in_c] = step.most.map(f64::ceil);
    let estimated = step.estimate.map_or(String::new(), |(cycles, error)| {
        let error = percent((100.0 * error).ceil() / 100.0);
        format!(" (estimated as {cycles}, with an error of up to {error})")
    });
    let [rust, c] = step.frequencies();
    Diagnostic::new(
        Code::StepExceedsPeriod,
        at,
        format!(
            "`target`: {}: a step takes up to {most} cycles on {} in Rust{estimated}, {in_c} in C, trips and braking included, and {}control at {rust} at most, in C at {c} (lower `f_pwm`, or raise `pwm_per_control`), or choose a controller with a shorter step",
            step.given,
            step.chip,
            step.of_period(),
        ),
    )
}

/// A step that may take longer than the control period in C, while it fits in Rust.
pub fn step_exceeds_period_in_c(at: &Location, step: &LongStep) -> Diagnostic {
    let [rust, in_c] = step.most;
    let [_, frequency] = step.frequencies();
    Diagnostic::new(
        Code::StepExceedsPeriod,
        at,
        format!(
            "`target`: {}: in C a step is estimated to take up to {} cycles, trips and braking included: its {} in Rust times {}, the largest ratio of C to Rust among the drives that were counted on {} (your drive and chip may differ); {}lower `f_pwm` or raise `pwm_per_control` until control runs at {frequency} at most; in Rust the step fits",
            step.given,
            in_c.ceil(),
            rust.ceil(),
            significant(in_c / rust),
            step.chip,
            step.of_period(),
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
/// `least`: the lowest accepted speed, rad/s (none where the rated one is below it); `clock`: the fastest accepted capture
/// clock, hertz (none when edges are sampled); `culprit`: the clock as written where nobody stated the speed.
pub fn minimum_speed(
    speed: &Part,
    ticks: f64,
    least: Option<f64>,
    clock: Option<f64>,
    culprit: Option<&Part>,
) -> Diagnostic {
    let slower = clock.map_or_else(
        || "lengthen the control period".to_owned(),
        |clock| {
            let clock = engineering(at_most(clock), "Hz");
            format!("lower `hall_timer_clock` to {clock}")
        },
    );
    let faster = least.map_or_else(String::new, |least| {
        format!(", or raise the speed to {}", rpm_at_least(least))
    });
    Diagnostic::new(
        Code::MinimumSpeed,
        &culprit.unwrap_or(speed).location,
        format!(
            "`minimum_speed`: {}, where 60 electrical degrees last {} ticks of the Hall timer, above its limit of 65000; {slower}{faster}",
            speed.given,
            significant(ticks.round()),
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
    [periods, least]: [f64; 2],
    fastest: f64,
    f_pwm: f64,
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::TooFewPeriods,
            &speed.location,
            format!(
                "`maximum_speed`: {} leaves {} control periods per electrical turn, below {least}; lower it to {} or raise `f_pwm` to {}",
                speed.given,
                significant(periods),
                rpm_at_most(fastest),
                engineering(at_least(f_pwm), "Hz"),
            ),
        ),
        &[period],
    )
}

/// An over-speed that a run at rated speed may reach, or that is not measured. `range`: the least and the
/// greatest that is accepted, rad/s.
pub fn over_speed(speed: &Part, rated: &Part, period: &Part, range: [f64; 2]) -> Diagnostic {
    let [least, fastest] = range;
    with_parts(
        Diagnostic::new(
            Code::OverSpeed,
            &speed.location,
            format!(
                "`over_speed`: {} lies outside the accepted {} to {}: below, an error of one control period in the time of a turn may trip a run at `rated_speed` {}; above, too few control periods fall into an electrical turn to measure the speed; give a speed within, or raise `f_pwm`",
                speed.given,
                rpm_at_least(least),
                rpm_at_most(fastest),
                rated.given,
            ),
        ),
        &[rated, period],
    )
}

/// With field weakening the greatest speed is one at which the EMF exceeds the bus. `emf`: between two
/// terminals at that speed; `bus`: its name and voltage; `fastest`: speed at which the EMF is the bus voltage, rad/s.
pub fn emf_above_bus(
    speed: &Part,
    emf: f64,
    (bus, volts): (&Part, f64),
    fastest: f64,
) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::EmfAboveBus,
            &speed.location,
            format!(
                "`maximum_speed`: with `field_weakening: on` the EMF between two terminals at {} is {}, above the bus of {}; legs that a trip or `coast()` turns off there drive current into the bus; lower it to {}, or state the `bus_clamp` at which the board holds its bus",
                speed.given,
                engineering(emf, "V"),
                engineering(volts, "V"),
                rpm_at_most(fastest),
            ),
        ),
        &[bus],
    )
}

/// A ramp of the speed may reverse within the stall time-out, without a Hall edge.
pub fn stall_timeout(timeout: &Part, acceleration: f64, reversal: f64) -> Diagnostic {
    Diagnostic::new(
        Code::StallTimeout,
        &timeout.location,
        format!(
            "`stall_timeout`: {} is shorter than the {} that a ramp of {} a second may take to reverse without a Hall edge; give at least {}, or raise `acceleration_limit`",
            timeout.given,
            engineering(reversal, "s"),
            rpm(acceleration),
            engineering(at_least(reversal), "s"),
        ),
    )
}

/// The dead time exceeds a tenth of the PWM period.
pub fn dead_time(dead_time: &Part, period: f64) -> Diagnostic {
    Diagnostic::new(
        Code::DeadTime,
        &dead_time.location,
        format!(
            "`dead_time`: {} exceeds a tenth of the PWM period of {}; shorten it to {} or lengthen that period",
            dead_time.given,
            engineering(period, "s"),
            engineering(at_most(period / 10.0), "s"),
        ),
    )
}
