//! Texts about the choice of controller and its options.

use super::Part;
use super::structure::did_you_mean;
use crate::diagnostics::{
    Code, Diagnostic, Location, at_least, at_most, engineering, list, significant,
};

/// A controller that does not exist.
pub fn unknown_controller(at: &Location, given: &str, available: &[&str]) -> Diagnostic {
    Diagnostic::new(
        Code::UnknownController,
        at,
        format!(
            "`controller`: `{given}` is unknown; choose {}{}",
            list(available, "or"),
            did_you_mean(given, available)
        ),
    )
}

/// An option's value that this version does not have.
pub fn option_unavailable(
    at: &Location,
    option: &str,
    given: &str,
    available: &[&str],
) -> Diagnostic {
    Diagnostic::new(
        Code::OptionUnavailable,
        at,
        format!(
            "`{option}`: `{given}` is not available in this version; choose {}",
            list(available, "or")
        ),
    )
}

/// An option of other controllers.
pub fn option_of_other_controller(
    at: &Location,
    option: &str,
    controller: &str,
    takers: &[&str],
) -> Diagnostic {
    Diagnostic::new(
        Code::OptionOfOtherController,
        at,
        format!(
            "`{controller}` takes no option `{option}`, only {} does; remove it",
            list(takers, "or")
        ),
    )
}

/// A `modulation` whose intervals the board or another setting does not allow; `why` is a clause about turning legs on and
/// off within a period.
pub fn intervals_unavailable(
    modulation: &Part,
    cause: &Part,
    why: &str,
    remedy: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::IntervalsUnavailable,
        &modulation.location,
        format!(
            "`modulation`: {} turns legs on and off within a PWM period, {why}; {remedy}",
            modulation.given
        ),
    )
    .with_note(
        &cause.location,
        format!("`{}`: {}", cause.field, cause.given),
    )
}

/// One vector changes the current by `stride` ampere per period, above `rated`. `t_s`: longest
/// accepted period of whole timer counts, second; `f_pwm`: frequency of its PWM, hertz.
pub fn vector_too_strong(
    at: &Location,
    kind: &str,
    stride: f64,
    rated: f64,
    [t_s, f_pwm]: [f64; 2],
) -> Diagnostic {
    Diagnostic::new(
        Code::VectorTooStrong,
        at,
        format!(
            "`kind`: {kind} applies one vector per period, which changes the current of this motor by {}, \
             above its rated current of {}; choose a control period of at most {} (`f_pwm`: {}), or `pdcc`, which \
             modulates",
            engineering(stride, "A"),
            engineering(rated, "A"),
            engineering(at_most(t_s), "s"),
            engineering(at_least(f_pwm), "Hz"),
        ),
    )
}

/// Two vectors per period miss the current reference by up to `miss` ampere, above `rated`.
/// `t_s`: longest accepted period of whole timer counts, second; `f_pwm`: frequency of its PWM,
/// hertz.
pub fn vectors_too_coarse(
    at: &Location,
    miss: f64,
    rated: f64,
    [t_s, f_pwm]: [f64; 2],
) -> Diagnostic {
    Diagnostic::new(
        Code::VectorTooStrong,
        at,
        format!(
            "`modulated`: two vectors per period miss the current reference of this motor by up to {}, \
             above its rated current of {}; choose a control period of at most {} (`f_pwm`: {}), or `pdcc`, which \
             reaches every voltage",
            engineering(miss, "A"),
            engineering(rated, "A"),
            engineering(at_most(t_s), "s"),
            engineering(at_least(f_pwm), "Hz"),
        ),
    )
}

/// An option that has no effect beside another setting, which may be a default and stand nowhere; `why` is a clause.
pub fn option_without_effect(
    option: &Part,
    [other, value]: [&str; 2],
    other_at: Option<&Location>,
    why: &str,
) -> Diagnostic {
    let Part { field, given, .. } = option;
    let holds = if other_at.is_some() {
        ""
    } else {
        ", which this drive has"
    };
    let error = Diagnostic::new(
        Code::OptionWithoutEffect,
        &option.location,
        format!(
            "`{field}`: {given} has no effect with `{other}: {value}`{holds}: {why}; remove `{field}` or change `{other}`"
        ),
    );
    match other_at {
        Some(at) => error.with_note(at, format!("`{other}: {value}`")),
        None => error,
    }
}

/// The clock of a core that is not named; `portable`: where that is written.
pub fn clock_without_core(clock: &Part, cores: &[&str], portable: Option<&Location>) -> Diagnostic {
    let Part { field, given, .. } = clock;
    let error = Diagnostic::new(
        Code::DependentField,
        &clock.location,
        format!(
            "`{field}`: {given} has an effect only with a core that is named; set `target` to {}, or remove `{field}`",
            list(cores, "or"),
        ),
    );
    match portable {
        Some(at) => error.with_note(at, "`target: portable`"),
        None => error,
    }
}

/// `reference: proportional` with a `modulation` that turns a leg off.
pub fn proportional_pair(at: &Location, modulation: &str, modulation_at: &Location) -> Diagnostic {
    let cost = match modulation {
        "pair" => " (7 to 8 % less torque, 30 to 34 % ripple)",
        _ => "",
    };
    Diagnostic::new(
        Code::DependentField,
        at,
        format!(
            "`reference`: proportional needs current in all three phases, but `modulation: {modulation}` turns a leg off outside commutations{cost}; choose `modulation: three_phase` or `reference: quasi_square`"
        ),
    )
    .with_note(modulation_at, format!("`modulation: {modulation}`"))
}

/// A hysteresis band as wide as the rated current.
pub fn band_above_rated(band: &Part, rated: &Part) -> Diagnostic {
    Diagnostic::new(
        Code::Band,
        &band.location,
        format!(
            "`band`: {} is not below the rated current of {}, so the controller would never correct the current; choose a tenth of the rated current or less",
            band.given, rated.given
        ),
    )
    .with_note(&rated.location, format!("`{}`: {}", rated.field, rated.given))
}

/// The printed switching table, for study only.
pub fn printed_table(at: &Location) -> Diagnostic {
    Diagnostic::new(
        Code::SwitchingTableLosesCurrent,
        at,
        "`table`: the printed table loses control of the current until the drive trips; it is for study only, use `derived` for a drive",
    )
}

/// The EMF turns by `turn` in a period of `t_s` seconds, above the `limit` of the estimate; both in
/// electrical degrees. `filtered`: the limit comes from the filter; `has_angle`: there are no Hall edges.
pub fn estimate_turns_too_far(
    at: &Location,
    given: &str,
    [turn, limit]: [f64; 2],
    t_s: f64,
    [filtered, has_angle]: [bool; 2],
) -> Diagnostic {
    let timer = if has_angle {
        ""
    } else {
        " and `hall_capture: timer`"
    };
    let [turned, limited] = [turn, limit].map(significant);
    let (consequence, remedy) = if filtered {
        ("the estimate cannot follow", "a greater `emf_filter`, ")
    } else {
        ("the torque may be more than 5 % off", "")
    };
    let period = engineering(t_s * limit / turn, "s");
    Diagnostic::new(
        Code::EstimateTurnsTooFar,
        at,
        format!(
            "`emf`: {given}, but the EMF turns {turned} electrical degrees per control period at rated speed; above {limited} {consequence}; choose {remedy}`emf: observer` with `reference: proportional`{timer}, or a control period of at most {period}"
        ),
    )
}

/// A switching table of the wrong length, or with an entry (position from 1, number) that is not
/// a vector.
pub fn switching_table(at: &Location, length: usize, wrong: Option<(usize, i64)>) -> Diagnostic {
    let what = match wrong {
        Some((position, number)) => {
            format!("entry {position} is {number}, and vectors are numbered 0 to 15")
        }
        None => format!("{length} entries"),
    };
    Diagnostic::new(
        Code::SwitchingTable,
        at,
        format!(
            "`table`: {what}; list 48 vector numbers, 8 per sector from S1 to S6: 4 outside commutation, then 4 in commutation, for comparator outputs (alpha, beta) = 00, 01, 10, 11; or write `derived`"
        ),
    )
}

/// A controller variant (`pdcc:modulation=pair`) that cannot be read.
pub fn variant_syntax(at: &Location, part: &str) -> Diagnostic {
    Diagnostic::new(
        Code::Variant,
        at,
        format!(
            "cannot read `{part}` of the controller variant; write `name:key=value,key=value`, for example `pdcc:modulation=pair,advance=1.5`"
        ),
    )
}
