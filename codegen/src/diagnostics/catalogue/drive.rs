//! Texts about motor, bus and ratings that do not fit together.

use super::internal;
use super::part::{Part, with_parts};
use super::values::{in_field, per_krpm, with_meanings};
use crate::diagnostics::{
    Code, Diagnostic, Location, at_least, at_most, engineering, list, percent, rpm, rpm_at_most,
    significant,
};
use std::fmt;

/// A bus voltage on the far side, `below` or `above`, of a board's limit.
pub fn outside_of_board(given: &Part, side: &str, limit: &Part) -> Diagnostic {
    let error = Diagnostic::new(
        Code::OutsideOfBoard,
        &given.location,
        format!(
            "`{}`: {} is {side} the board's `{}` of {}; give the voltage of its supply, state your own `{}` with `v_bus: measured` where that one is of another battery and the parts bear yours, or take another board",
            given.field, given.given, limit.field, limit.given, limit.field
        ),
    );
    with_parts(error, &[limit])
}

/// A board whose least bus voltage is above its greatest.
pub fn bus_limits_exchanged(low: &Part, high: &Part) -> Diagnostic {
    let error = Diagnostic::new(
        Code::OutsideOfBoard,
        &low.location,
        format!(
            "`bus_min`: {} is above the board's `bus_max` of {}, so that no supply fits it; correct the board's file",
            low.given, high.given
        ),
    );
    with_parts(error, &[high])
}

/// Current sensors that the board does not have.
pub fn sensors_not_there(given: &Part, own: &Part) -> Diagnostic {
    let error = Diagnostic::new(
        Code::OutsideOfBoard,
        &given.location,
        format!(
            "`{}`: {} asks for sensors that the board does not have: its `{}` is {}; remove the field, or describe a board with other sensors in a file of its own",
            given.field, given.given, own.field, own.given
        ),
    );
    with_parts(error, &[own])
}

/// The EMF constant is far from that of any motor; `phase`, `low`, `high`: peak phase EMF over
/// mechanical speed, V s/rad.
pub fn implausible_emf(stated: &Part, phase: f64, low: f64, high: f64) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        &stated.location,
        format!(
            "`{}`: {} is {} per phase, outside {} to {}; {}",
            stated.field,
            stated.given,
            engineering(phase, "V/(rad/s)"),
            engineering(low, "V/(rad/s)"),
            engineering(high, "V/(rad/s)"),
            per_krpm(&stated.given)
                .filter(|_| phase > high)
                .map_or_else(
                    || "check the number and its unit".to_owned(),
                    |meant| format!("did you mean `{meant}`?")
                ),
        ),
    )
}

/// What the bus voltage allows where it is too low for the rating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BusRemedy {
    /// Speed reached at rated current, mechanical rad/s.
    Speed(f64),
    /// The same, of which sensors in the low legs, whose window is not known yet, take a part.
    BelowSpeed(f64),
    /// Current at standstill, ampere, below the rated current.
    Current(f64),
}

/// Why a data sheet's speed may be beyond the bus.
const AT_NOMINAL: &str = " if the data sheet states it at a higher supply (its `nominal_voltage`)";

impl fmt::Display for BusRemedy {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Speed(reachable) => write!(
                out,
                "lower `rated_speed` to {}{AT_NOMINAL}",
                rpm_at_most(reachable)
            ),
            Self::BelowSpeed(reachable) => write!(
                out,
                "lower `rated_speed` below {} (reading the sensors in the low legs takes a part of the bus, too){AT_NOMINAL}",
                rpm_at_most(reachable)
            ),
            Self::Current(reachable) => {
                let most = engineering(at_most(reachable), "A");
                write!(out, "lower `rated_current` below {most}")
            }
        }
    }
}

/// What is known of the EMF as stated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    /// Whether another field agrees with it.
    pub is_confirmed: bool,
    /// Whether it is stated as a peak.
    pub is_peak: bool,
    /// Speed of the shaft with which the rating fits the bus, if the stated one is electrical, mechanical rad/s.
    pub shaft_speed: Option<f64>,
}

/// Below this share of the bus a resistive drop may be right; beyond this multiple of it an EMF is
/// one of another basis.
const LIKELY: [f64; 2] = [0.5, 1.5];

/// Where a rating takes so many times the stated bus, one of its values is wrong, and not the bus.
const ABSURD: f64 = 10.0;

/// Which of `values` makes most of a voltage that is absurd beside the bus. In volt: the bus; `taken`: what the
/// rating takes; `voltages`: what each value makes of it.
pub fn most_of_absurd<T>([bus, taken]: [f64; 2], voltages: [f64; 3], values: [T; 3]) -> Option<T> {
    let pairs = voltages.into_iter().zip(values);
    let most = pairs.max_by(|one, other| one.0.total_cmp(&other.0))?.1;
    (taken > ABSURD * bus).then_some(most)
}

/// A value that makes most of a voltage that is absurd beside the bus.
pub fn thousandfold(code: Code, value: &Part, [bus, taken]: [f64; 2]) -> Diagnostic {
    Diagnostic::new(
        code,
        &value.location,
        format!(
            "`{}`: {} is likely a thousandfold off: the rating takes {}, most of it by this value, and the bus is {}; check the number and the prefix of its unit",
            value.field,
            value.given,
            engineering(taken, "V"),
            engineering(bus, "V"),
        ),
    )
}

/// EMF and resistive drop of the rating exceed the bus. In volt: the bus; `emf`: line to line at
/// rated speed; `drop`: of rated current between two terminals; `raised`: the bus that holds the rating, none
/// where it is above the limit of a measured one, or of the board.
pub fn bus_too_low(
    bus: &Part,
    [speed, current, stated, resistance]: [&Part; 4],
    [volts, emf, drop]: [f64; 3],
    Stated {
        is_confirmed,
        is_peak,
        shaft_speed,
    }: Stated,
    (raised, remedy): (Option<f64>, BusRemedy),
) -> Diagnostic {
    let raise = raised.map_or_else(String::new, |raised| {
        format!(
            "raise `bus_voltage` to {} (the inductance takes its part, too), ",
            engineering(at_least(raised), "V")
        )
    });
    let trace = if !is_confirmed && is_peak && emf > LIKELY[1] / 2.0 * volts {
        "; a peak-to-peak voltage of a trace is written `peak_to_peak`"
    } else {
        ""
    };
    let of_shaft = shaft_speed.map_or_else(String::new, |shaft| {
        format!(
            ", give `rated_speed` as {} if {} is an electrical speed (eRPM)",
            rpm(shaft),
            speed.given
        )
    });
    let culprit = if drop > LIKELY[0] * volts {
        resistance
    } else if is_confirmed && emf > 2.0 * volts {
        bus
    } else if !is_confirmed && emf > LIKELY[1] * volts {
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
                "`{}`: {}: the rating, {} at {}, takes {} of the bus of {}: an EMF of {} line to line and a resistive drop of {}; {raise}{remedy}{of_shaft}, or check the bases of `{}` ({}) and `resistance` ({}){trace}",
                culprit.field,
                culprit.given,
                current.quoted(),
                speed.quoted(),
                engineering(emf + drop, "V"),
                bus.given,
                engineering(emf, "V"),
                engineering(drop, "V"),
                stated.field,
                stated.given,
                resistance.given,
            ),
        ),
        &parts,
    )
}

/// A rating beyond the envelope of the drive.
#[derive(Clone, Debug)]
pub struct Beyond {
    /// Torque of the rating, and the greatest within the envelope at rated speed, Nm.
    pub torques: [f64; 2],
    /// Greatest speed of that rating's torque, mechanical rad/s; none if it is not held at any.
    pub speed: Option<f64>,
    /// Nominal bus voltage, volt.
    pub bus: f64,
    /// The one that the rating takes, volt; none above the limit of a measured bus, or of the board.
    pub raised: Option<f64>,
    /// Whether vectors of pairs make the voltage.
    pub pairs: bool,
    /// Where the inductance takes more of that than EMF or resistance: the inductance, the pole pairs, and what it takes, volt.
    pub inductive: Option<(Part, u32, f64)>,
}

impl Beyond {
    /// The values that are likely wrong, a clause.
    fn doubtful(&self) -> String {
        self.inductive.as_ref().map_or_else(
            || "check the bases of the EMF constant and `resistance`".to_owned(),
            |(inductance, pairs, taken)| {
                format!(
                    "check `inductance` ({}) for the prefix of its unit, and the {pairs} pole pairs for a count of magnets, of which two make a pair: the change of the current through the inductance takes {} alone",
                    inductance.given,
                    engineering(*taken, "V"),
                )
            },
        )
    }
}

/// A rating at which the bus cuts the current's shape. `speed`: the rated speed and where it was written.
pub fn rating_beyond_bus((at, speed): (&Location, &str), beyond: &Beyond) -> Diagnostic {
    let [rated, held] = beyond.torques.map(|torque| engineering(torque, "Nm"));
    let drives = if beyond.torques[1] > 0.0 {
        format!("drives the whole current up to {held} of the rating's {rated}, and beyond that")
    } else {
        format!(
            "does not drive the whole current of any torque, let alone of the rating's {rated}:"
        )
    };
    let raise = beyond.raised.map_or_else(String::new, |raised| {
        let raised = engineering(at_least(raised), "V");
        format!("raise `bus_voltage` to {raised}, or ")
    });
    let modulate = if beyond.pairs {
        "take `modulation: three_phase`, which makes more voltage, or "
    } else {
        ""
    };
    let lasts = beyond.speed.map_or_else(String::new, |speed| {
        format!("; the rating lasts to {}", rpm_at_most(speed))
    });
    Diagnostic::new(
        Code::RatingBeyondBus,
        at,
        format!(
            "`rated_speed`: {speed}: there the bus of {} {drives} the torque ripples and falls{lasts}; {raise}{modulate}lower `rated_speed`, or {}",
            engineering(beyond.bus, "V"),
            beyond.doubtful(),
        ),
    )
}

/// A greatest speed beyond that at which field weakening holds the EMF within the bus. `speed`: where it was written,
/// and the value; `last`: the speed that is held, rad/s.
pub fn weakening_ends(
    (at, speed): (&Location, &str),
    [max_current, bus, last]: [f64; 3],
) -> Diagnostic {
    Diagnostic::new(
        Code::WeakeningEnds,
        at,
        format!(
            "`maximum_speed`: {speed}: with `field_weakening: on` a `max_current` of {} brings the voltage within the bus of {} up to {}; beyond, the torque ends, and soon the motor brakes whatever the set-point; lower `maximum_speed`, or raise `max_current`",
            engineering(max_current, "A"),
            engineering(bus, "V"),
            rpm_at_most(last),
        ),
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
    /// Those of them that agree with each other, where they are more than half.
    pub agreed: &'a [&'a Part],
    /// Readings that fit, with what follows from them.
    pub fitting: &'a [(String, String)],
    /// What to state of the voltage that a speed refers to, a clause.
    pub voltage: Option<&'static str>,
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
    let advice = if let Some(voltage) = of.voltage {
        voltage.to_owned()
    } else if of.fitting.is_empty() && !(1.0 / THOUSANDFOLD..THOUSANDFOLD).contains(&ratio) {
        "one of the two is likely a thousandfold off, so check the prefixes of their units"
            .to_owned()
    } else if of.fitting.is_empty() {
        "no other basis or shape fits either, so check the numbers against the data sheet"
            .to_owned()
    } else {
        let fits: Vec<String> = of
            .fitting
            .iter()
            .map(|(change, value)| format!("{change} ({value})"))
            .collect();
        format!("readings that fit: {}; {LOOK_UP}", fits.join(", "))
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
                "{told} ({}, a factor of at most 1.15 is allowed); {}{advice}",
                deviation(ratio),
                agreement(of),
            ),
        ),
        &parts,
    )
}

/// `` `a` and `b` agree, so that `c` is likely wrong; ``.
fn agreement(of: &Contradiction) -> String {
    let fields: Vec<&str> = of.agreed.iter().map(|part| part.field).collect();
    if fields.len() < 2 {
        return String::new();
    }
    let agree = format!("{} agree", list(&fields, "and"));
    if of.fitting.is_empty() && of.voltage.is_none() {
        // A rated torque and its current are one claim.
        let suspects: Vec<&str> = match of.claim.first() {
            Some(first) if first.field == of.culprit.field => {
                of.claim.iter().map(|part| part.field).collect()
            }
            _ => vec![of.culprit.field],
        };
        format!(
            "{agree}, so that {} is likely wrong; ",
            list(&suspects, "or")
        )
    } else {
        format!("{agree}; ")
    }
}

/// An inertia with which a rated torque takes an unlikely time from rest to rated speed; `time`, and the range of likely
/// ones, second.
pub fn unlikely_inertia(inertia: &Part, torque: f64, time: f64, likely: [f64; 2]) -> Diagnostic {
    let [least, most] = likely.map(|time| engineering(time, "s"));
    let time = if time < 1.0 {
        engineering(time, "s")
    } else {
        format!("{} s", significant(time))
    };
    Diagnostic::new(
        Code::UnlikelyInertia,
        &inertia.location,
        format!(
            "`inertia`: {}: from rest to rated speed takes {time} with the rated {}, and most drives take {least} to {most}; check the unit (g cm2, kg cm2, kg m2), and that it is of the rotor and what it moves",
            inertia.given,
            engineering(torque, "Nm"),
        ),
    )
}

/// A rotor that turns by `degrees` in a control period, at whose end a Hall edge is seen; `ripple`: the greatest of the
/// torque, over its mean.
pub fn sampled_halls(period: &Part, degrees: f64, ripple: f64) -> Diagnostic {
    Diagnostic::new(
        Code::SampledHalls,
        &period.location,
        format!(
            "`{}`: {}: at rated speed the rotor turns {degrees:.1} electrical degrees in a control period, and without a timer a Hall edge is seen up to a period late: the torque ripples by up to {:.0} %; let a timer capture the edges (`hall_timer_clock`), or control more often",
            period.field,
            period.given,
            100.0 * ripple,
        ),
    )
}

/// A control period that is too long, with the `clause` that says how much and what to change.
pub fn long_control_period(period: &Part, clause: &str) -> Diagnostic {
    Diagnostic::new(
        Code::LongControlPeriod,
        &period.location,
        format!(
            "`{}`: {}: {clause}; as it is, the torque ripples by more than most drives do",
            period.field, period.given
        ),
    )
}

/// An inverter at `location` without a dead time, of which a `usual` one moves the current by the share `moved` of the
/// rated one.
pub fn no_dead_time(location: &Location, usual: f64, moved: f64) -> Diagnostic {
    Diagnostic::new(
        Code::NoDeadTime,
        location,
        format!(
            "`dead_time` is not stated, and with {} of it, as many inverters have, the bus would move the current by {:.1} % of the rated one in a control period, and the torque would ripple: state the inverter's, so that the drive compensates it, or `0 s` if it has none",
            engineering(usual, "s"),
            100.0 * moved,
        ),
    )
}

/// A trip by a bus voltage near the nominal one, with a motor that brakes and no fade; in volt: nominal, and the level
/// that a fade ends at. `limit`: a limit of the returned current.
pub fn trip_by_braking(level: &Part, limit: Option<&Part>, [nominal, end]: [f64; 2]) -> Diagnostic {
    let fade = at_most((end - nominal) / 2.0);
    let fade = if fade > 0.0 {
        format!(
            "state a `braking_fade`, such as {}, or ",
            engineering(fade, "V")
        )
    } else {
        String::new()
    };
    let held = if limit.is_some() {
        " (`return_current_limit` holds the mean of the current, not the voltage)"
    } else {
        ""
    };
    let warning = Diagnostic::new(
        Code::TripByBraking,
        &level.location,
        format!(
            "`{}`: {} is less than 20 % above the nominal {}: a full battery is near it, a supply that takes no current back rises to it{held}, and braking then trips the drive with `OverVoltage`, all legs off; {fade}raise `{}` if switches and capacitors bear it",
            level.field,
            level.given,
            engineering(nominal, "V"),
            level.field,
        ),
    );
    with_parts(warning, limit.as_slice())
}

/// A stall time-out within which no start ends.
#[derive(Clone, Debug)]
pub struct StallOfStart {
    /// The time-out.
    pub timeout: Part,
    /// Inertia, kg m2.
    pub inertia: f64,
    /// Torque of the largest set-point, Nm.
    pub torque: f64,
    /// Time of a sector from rest, second.
    pub start: f64,
}

/// Several times the fastest start leave room for a load and a smaller set-point.
const STARTS: f64 = 10.0;

/// A stall time-out shorter than the motor's fastest start.
pub fn stall_before_start(stall: &StallOfStart) -> Diagnostic {
    Diagnostic::new(
        Code::StallBeforeStart,
        &stall.timeout.location,
        format!(
            "`stall_timeout`: {} is shorter than the {} in which the whole {} turns the `inertia` of {} kg m2 from rest through a Hall sector without load, so that a start may trip with `Stall`; give some times that, as {}, or 0 s for no stall detection",
            stall.timeout.given,
            engineering(stall.start, "s"),
            engineering(stall.torque, "Nm"),
            significant(stall.inertia),
            engineering(at_least(STARTS * stall.start), "s"),
        ),
    )
}

/// Two constants that state their bases and do not agree; `ratio`: the one that is taken over the other; `changes`:
/// readings with which they would.
pub fn constants_apart([taken, other]: [&Part; 2], ratio: f64, changes: &[String]) -> Diagnostic {
    let advice = if changes.is_empty() {
        "no other basis brings them together, so check the numbers against the data sheet"
            .to_owned()
    } else {
        format!("readings that agree: {}; {LOOK_UP}", changes.join(", "))
    };
    with_parts(
        Diagnostic::new(
            Code::ConstantsApart,
            &taken.location,
            format!(
                "`{}`: {}, which is taken, is {} than {} says; {advice}",
                taken.field,
                taken.given,
                deviation(ratio),
                other.quoted(),
            ),
        ),
        &[other],
    )
}

/// What to do where several readings are possible: which one is meant only the data sheet says.
const LOOK_UP: &str = "look up in the data sheet which is meant, and write that";

/// Constants without basis that agree under one reading, `reading`.
pub fn basis_by_agreement(parts: &[&Part], reading: &str) -> Diagnostic {
    let (first, rest) = (parts[0], &parts[1..]);
    let others: Vec<String> = rest.iter().map(|part| part.quoted()).collect();
    with_parts(
        Diagnostic::new(
            Code::BasisByAgreement,
            &first.location,
            format!(
                "`{}`: {} and {} say no basis; they agree, and are taken, with {reading}; look up in the data sheet whether that is meant, and write it",
                first.field,
                first.given,
                others.join(" and "),
            ),
        ),
        rest,
    )
}

/// Constants without basis that agree under several readings, `agreements`, or under none; `forms`: what the first of
/// them may mean.
pub fn bases_in_doubt(
    parts: &[&Part],
    agreements: &[String],
    forms: &[(String, String)],
) -> Diagnostic {
    let (first, rest) = (parts[0], &parts[1..]);
    let others: Vec<String> = rest.iter().map(|part| part.quoted()).collect();
    let agree = if agreements.is_empty() {
        "agree under no reading".to_owned()
    } else {
        format!("agree under several readings: {}", agreements.join(", or "))
    };
    with_parts(
        Diagnostic::new(
            Code::MissingBasis,
            &first.location,
            format!(
                "`{}`: {} has no basis, nor has {}, and they {agree}; {LOOK_UP}: {}",
                first.field,
                first.given,
                others.join(", nor "),
                with_meanings(&in_field(&first.location, first.field, forms)),
            ),
        ),
        rest,
    )
}

/// Beyond it a prefix is rather wrong than a basis.
const THOUSANDFOLD: f64 = 200.0;

/// Beyond it percents are harder to read than a factor.
const MULTIPLE: f64 = 10.0;

fn deviation(ratio: f64) -> String {
    if ratio >= MULTIPLE {
        format!("{} times as much", significant(ratio))
    } else if ratio >= 1.0 {
        format!("{} more", percent(ratio - 1.0))
    } else {
        format!("{} less", percent(1.0 - ratio))
    }
}

/// EMF and torque constant are one number: `peak` as it was taken, and what it is if it is a mean,
/// V s/rad.
pub fn mean_for_peak([stated, other]: [&Part; 2], peak: f64, true_peak: f64) -> Diagnostic {
    with_parts(
        Diagnostic::new(
            Code::MeanForPeak,
            &stated.location,
            format!(
                "`{}`: {} and {} are one number, as those of a sinusoidal motor are where both are means over block commutation; `{}` is taken as it stands, a line-to-line peak of {}, which as `block_mean` would be one of {}; {LOOK_UP}",
                stated.field,
                stated.given,
                other.quoted(),
                stated.field,
                engineering(peak, "V/(rad/s)"),
                engineering(true_peak, "V/(rad/s)"),
            ),
        ),
        &[other],
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
