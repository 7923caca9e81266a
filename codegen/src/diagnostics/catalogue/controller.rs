//! Texts about the choice of controller and its options.

use super::structure::did_you_mean;
use crate::diagnostics::{Code, Diagnostic, Location, engineering, list};

/// A controller that this version does not have; `planned`: it is a known method.
pub fn controller_unavailable(
    at: &Location,
    given: &str,
    planned: bool,
    available: &[&str],
) -> Diagnostic {
    let what = if planned {
        "is not available in this version"
    } else {
        "is unknown"
    };
    let suggestion = if planned {
        String::new()
    } else {
        did_you_mean(given, available)
    };
    Diagnostic::new(
        Code::ControllerUnavailable,
        at,
        format!(
            "`controller`: `{given}` {what}; choose {}{suggestion}",
            list(available, "or")
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

/// An option that this version does not have.
pub fn option_planned(at: &Location, option: &str) -> Diagnostic {
    Diagnostic::new(
        Code::OptionUnavailable,
        at,
        format!("`{option}` is not available in this version; remove it"),
    )
}

/// One vector moves the current by `stride` ampere in a period; `t_s`: the period at which it would be
/// the `rated` current.
pub fn vector_too_strong(at: &Location, stride: f64, rated: f64, t_s: f64) -> Diagnostic {
    Diagnostic::new(
        Code::VectorTooStrong,
        at,
        format!(
            "`kind`: fcs-mpc applies one vector for a whole period, which moves the current of this motor by {}, more \
             than its rated current of {}; choose a control period of at most {} (`f_pwm`: {}), or `pdcc`, whose \
             modulator divides the period",
            engineering(stride, "A"),
            engineering(rated, "A"),
            engineering(t_s, "s"),
            engineering(1.0 / t_s, "Hz"),
        ),
    )
}

/// An option that has no effect beside another setting; `why` is a clause.
pub fn option_without_effect(
    at: &Location,
    option: &str,
    given: &str,
    other_at: &Location,
    other: &str,
    why: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::OptionWithoutEffect,
        at,
        format!("`{option}`: {given} has no effect with `{other}`: {why}; remove one of the two"),
    )
    .with_note(other_at, format!("`{other}`"))
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
