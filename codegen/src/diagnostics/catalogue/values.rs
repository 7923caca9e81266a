//! Texts about single values: spelling, unit, basis, limits.

use super::Part;
use super::structure::did_you_mean;
use crate::diagnostics::{Code, Diagnostic, Location, list, significant};

/// A value that cannot be read.
pub fn malformed_value(at: &Location, field: &str, given: &str, examples: &[String]) -> Diagnostic {
    Diagnostic::new(
        Code::MalformedValue,
        at,
        format!(
            "`{field}`: cannot read `{given}`; {}",
            like(at, field, examples)
        ),
    )
}

/// A comma in a number; `values`: what may be meant.
pub fn decimal_comma(at: &Location, field: &str, given: &str, values: &[String]) -> Diagnostic {
    let values: Vec<String> = values
        .iter()
        .map(|value| written(at, field, value))
        .collect();
    Diagnostic::new(
        Code::MalformedValue,
        at,
        format!(
            "`{field}`: {given} has a comma in its number; write a decimal point, and nothing between thousands: {}",
            list(&values, "or")
        ),
    )
}

/// Misplaced signs in a value.
pub fn stray_signs(
    at: &Location,
    field: &str,
    given: &str,
    signs: &str,
    examples: &[String],
) -> Diagnostic {
    Diagnostic::new(
        Code::MalformedValue,
        at,
        format!(
            "`{field}`: cannot read `{signs}` in `{given}`; {}",
            like(at, field, examples)
        ),
    )
}

/// A character that compilers reject in comments, where texts end up. `position`: from 1.
pub fn forbidden_character(
    at: &Location,
    field: &str,
    character: char,
    position: usize,
) -> Diagnostic {
    let name = match character {
        '\u{202a}' => "left-to-right embedding",
        '\u{202b}' => "right-to-left embedding",
        '\u{202c}' => "pop directional formatting",
        '\u{202d}' => "left-to-right override",
        '\u{202e}' => "right-to-left override",
        '\u{2066}' => "left-to-right isolate",
        '\u{2067}' => "right-to-left isolate",
        '\u{2068}' => "first strong isolate",
        '\u{2069}' => "pop directional isolate",
        _ => "a control character",
    };
    Diagnostic::new(
        Code::MalformedValue,
        at,
        format!(
            "`{field}`: character {position} of the text is U+{:04X} ({name}), which compilers reject in comments; remove it",
            u32::from(character)
        ),
    )
}

/// A unit that does not exist; `right`: what to give, a clause.
pub fn unknown_unit(
    at: &Location,
    field: &str,
    given: &str,
    unit: &str,
    nearest: Option<&str>,
    right: &str,
) -> Diagnostic {
    let advice = nearest.map_or_else(
        || right.to_owned(),
        |symbol| format!("did you mean `{symbol}`?"),
    );
    Diagnostic::new(
        Code::UnknownUnit,
        at,
        format!("`{field}`: {given} has the unknown unit `{unit}`; {advice}"),
    )
}

/// The reciprocal of what the field takes, as counts per ampere are of amperes per count; `inverse`: what to give.
pub fn inverse_unit(at: &Location, field: &str, given: &str, inverse: &str) -> Diagnostic {
    Diagnostic::new(
        Code::UnknownUnit,
        at,
        format!("`{field}`: {given} is the inverse of what it takes; give {inverse}"),
    )
}

/// A unit that says one of two quantities; `readings`: a unit of each, and what it means.
pub fn ambiguous_unit(
    at: &Location,
    field: &str,
    given: &str,
    unit: &str,
    readings: [(&str, &str); 2],
) -> Diagnostic {
    Diagnostic::new(
        Code::AmbiguousUnit,
        at,
        format!(
            "`{field}`: {given} has the unit `{unit}`, which has two meanings; write {}",
            with_meanings(&readings)
        ),
    )
}

/// A unit of another quantity; `right`: what to give, a clause.
pub fn wrong_dimension(
    at: &Location,
    field: &str,
    given: &str,
    got: &str,
    wanted: &str,
    right: &str,
) -> Diagnostic {
    // Of `gcm²` the compiler refuses the sign, and hands a torque to the macro.
    let is_square = matches!(at, Location::Macro(_)) && (got, wanted) == ("a torque", "an inertia");
    let square = if is_square {
        "; a superscript 2 is no Rust token, write `2`"
    } else {
        ""
    };
    Diagnostic::new(
        Code::WrongDimension,
        at,
        format!("`{field}`: {given} is {got}, but {wanted} is expected; {right}{square}"),
    )
}

/// A quantity that another field takes.
pub fn quantity_of_other_field(
    at: &Location,
    field: &str,
    given: &str,
    got: &str,
    meant: &str,
) -> Diagnostic {
    let message = format!("`{field}`: {given} is {got}; write `{meant}: {given}`");
    Diagnostic::new(Code::WrongDimension, at, message)
}

/// An EMF constant in the field of another one, of volts for 1 rpm that no motor has.
pub fn emf_of_one_rpm(at: &Location, field: &str, given: &str) -> Option<Diagnostic> {
    let meant = per_krpm(given)?;
    let inverse = given.replacen("V/rpm", "rpm/V", 1);
    let message = format!(
        "`{field}`: {given} is an EMF constant, more than most motors have; write `back_emf: {meant}`, or `speed_constant: {inverse}`"
    );
    Some(Diagnostic::new(Code::WrongDimension, at, message))
}

/// A constant for 1000 rpm, as data sheets state it, in place of one for 1 rpm.
pub(super) fn per_krpm(given: &str) -> Option<String> {
    let meant = given.replacen("V/rpm", "V/krpm", 1);
    (meant != given).then_some(meant)
}

/// A voltage at a speed, which is a constant once it is divided by it; `meant`: the quotient.
pub fn voltage_at_speed(at: &Location, field: &str, given: &str, meant: &str) -> Diagnostic {
    let message =
        format!("`{field}`: cannot read `{given}`; divide by the speed: `{field}: {meant}`");
    Diagnostic::new(Code::MalformedValue, at, message)
}

/// Pole pairs where poles are asked for.
pub fn pairs_of_poles(at: &Location, given: &str, pairs: &str) -> Diagnostic {
    let message =
        format!("`poles`: {given} are pairs, half of the poles; write `pole_pairs: {pairs}`");
    Diagnostic::new(Code::UnwantedUnit, at, message)
}

/// Poles in place of pole pairs.
pub fn poles_of_pairs(at: &Location, given: &str, poles: &str) -> Diagnostic {
    let even = poles.parse::<u32>().ok();
    let even = even.filter(|poles| *poles > 0 && poles.is_multiple_of(2));
    let remedy = match even {
        Some(poles) => format!("`poles: {poles}` or `pole_pairs: {}`", poles / 2),
        // Poles come in pairs.
        None => format!("`pole_pairs: {poles}` if pairs are meant"),
    };
    let message = format!("`pole_pairs`: {given} are not pairs; write {remedy}");
    Diagnostic::new(Code::UnwantedUnit, at, message)
}

/// A number without unit; `right`: what to give, a clause.
pub fn missing_unit(at: &Location, field: &str, given: &str, right: &str) -> Diagnostic {
    Diagnostic::new(
        Code::MissingUnit,
        at,
        format!("`{field}`: {given} has no unit; {right}"),
    )
}

/// A unit or basis on a plain number.
pub fn unwanted_unit(at: &Location, field: &str, given: &str, plain: &str) -> Diagnostic {
    Diagnostic::new(
        Code::UnwantedUnit,
        at,
        format!("`{field}`: {given} has a unit, but a plain number is expected; write `{plain}`"),
    )
}

/// A value without its basis; `forms`: the value with each possible basis, and its meaning.
pub fn missing_basis(
    at: &Location,
    field: &str,
    given: &str,
    forms: &[(String, String)],
) -> Diagnostic {
    Diagnostic::new(
        Code::MissingBasis,
        at,
        format!(
            "`{field}`: {given} has no basis; write {}",
            with_meanings(&in_field(at, field, forms))
        ),
    )
}

/// A rated current without its basis, of which data sheets print another one beside it.
pub fn missing_basis_of_current(
    at: &Location,
    given: &str,
    forms: &[(String, String)],
) -> Diagnostic {
    let mut error = missing_basis(at, "rated_current", given, forms);
    error.message.push_str(
        "; it is the continuous current of the motor: a maximum is `max_current` of the inverter",
    );
    error
}

/// An unknown word after the unit, where a basis stands; `remedy` is a clause.
pub fn unknown_basis(
    at: &Location,
    field: &str,
    given: &str,
    word: &str,
    remedy: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::UnknownWord,
        at,
        format!("`{field}`: {given} has the unknown basis `{word}`; {remedy}"),
    )
}

/// A basis that the value cannot have; `remedy` is a clause.
pub fn wrong_basis(
    at: &Location,
    field: &str,
    given: &str,
    basis: &str,
    remedy: &str,
) -> Diagnostic {
    Diagnostic::new(
        Code::WrongBasis,
        at,
        format!("`{field}`: {given} cannot be stated as `{basis}`; {remedy}"),
    )
}

/// A word that the field does not take.
pub fn unknown_word(
    at: &Location,
    field: &str,
    given: &str,
    known: &[&str],
    advice: Option<String>,
) -> Diagnostic {
    let advice = advice.map_or_else(
        || did_you_mean(given, known),
        |advice| format!("; {advice}"),
    );
    Diagnostic::new(
        Code::UnknownWord,
        at,
        format!(
            "`{field}`: unknown word `{given}`; it takes {}{}",
            list(known, "or"),
            advice
        ),
    )
}

/// A value of the wrong kind; `wanted` with article, e.g. `a number with a unit`.
pub fn wrong_kind(
    at: &Location,
    field: &str,
    given: &str,
    wanted: &str,
    examples: &[String],
) -> Diagnostic {
    Diagnostic::new(
        Code::WrongKind,
        at,
        format!(
            "`{field}`: {given}, but {wanted} is expected; {}",
            like(at, field, examples)
        ),
    )
}

/// A value in quotes within a macro call.
pub fn quoted(at: &Location, field: &str, given: &str) -> Diagnostic {
    let plain = given.replace('"', "");
    Diagnostic::new(
        Code::MalformedValue,
        at,
        format!("`{field}`: in a macro values stand without quotes; write `{field}: {plain}`"),
    )
}

/// Zero or negative where a positive value is expected; `low`, `high`: plausible limits.
pub fn not_positive(at: &Location, field: &str, given: &str, low: &str, high: &str) -> Diagnostic {
    Diagnostic::new(
        Code::NotPositive,
        at,
        format!("`{field}`: {given} is not above zero; give a value from {low} to {high}"),
    )
}

/// Zero or negative where a positive value is expected, without stated limits.
pub fn not_above_zero(at: &Location, field: &str, given: &str, examples: &[String]) -> Diagnostic {
    Diagnostic::new(
        Code::NotPositive,
        at,
        format!(
            "`{field}`: {given} is not above zero; {}",
            like(at, field, examples)
        ),
    )
}

/// A value outside its plausible or possible limits.
/// `meant`: the same number with another prefix, if that lies within.
pub fn out_of_range(
    at: &Location,
    field: &str,
    given: &str,
    [low, high]: [&str; 2],
    meant: Option<&str>,
) -> Diagnostic {
    let meant = meant.map_or_else(String::new, |meant| format!(": did you mean `{meant}`?"));
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`{field}`: {given} lies outside {low} to {high}; check the number and its unit{meant}"
        ),
    )
}

/// A plain number outside its possible limits.
pub fn out_of_limits(at: &Location, field: &str, given: &str, low: &str, high: &str) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!("`{field}`: {given} lies outside {low} to {high}; give a value within"),
    )
}

/// A plain number that is not one of the accepted ones.
pub fn not_one_of(at: &Location, field: &str, given: &str, choices: &[&str]) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`{field}`: {given} is not possible; give {}",
            list(choices, "or")
        ),
    )
}

/// A count that is no power of two.
pub fn not_a_power_of_two(
    at: &Location,
    field: &str,
    given: &str,
    below: u32,
    above: u32,
) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!("`{field}`: {given} is not a power of two; give {below} or {above}"),
    )
}

/// A number of poles that makes no pairs.
pub fn odd_poles(at: &Location, given: &str, poles: u32) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`poles`: {given} is odd, and poles come in pairs; give the magnets' poles, as {} or {}, or `pole_pairs: {poles}` if pairs are meant",
            poles - 1,
            poles + 1,
        ),
    )
}

/// Slots of which no three phases have equally many.
pub fn slots_of_three_phases(at: &Location, given: &str, [slots, poles]: [u32; 2]) -> Diagnostic {
    let is_exchanged = poles > 0 && poles.is_multiple_of(3) && slots.is_multiple_of(2);
    let exchanged = if is_exchanged && slots > 0 {
        let other = format!("{poles}N{slots}P");
        format!(
            " {} if slots and poles are exchanged, or",
            list(&[written(at, "poles", &other)], "or")
        )
    } else {
        String::new()
    };
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`poles`: {given} says {slots} slots (N) and {poles} poles (P), and the three phases of a motor share its slots equally, so that 3 divides them; write{exchanged} the number of poles alone"
        ),
    )
}

/// An angle sensor whose word says the electrical angle only by chance: `pairs` of its turn, `all` of the motor's.
pub fn angle_pole_pairs(at: &Location, pairs: u32, all: u32) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`angle_pole_pairs`: {pairs} does not divide the motor's {all} pole pairs, so that the electrical angle at the sensor's zero would differ from turn to turn; give {all} for a sensor on the shaft, or 1 for an electrical angle",
        ),
    )
}

/// An angle sensor that is too coarse: electrical degrees of its step, their limit, and the bits that suffice.
pub fn angle_bits(bits: &Part, [step, most, enough]: [f64; 3]) -> Diagnostic {
    Diagnostic::new(
        Code::OutOfRange,
        &bits.location,
        format!(
            "`angle_bits`: {} makes steps of {} electrical degrees, above {most}; use a sensor of at least {enough} bits, or Hall sensors",
            bits.given,
            significant(step),
        ),
    )
}

/// Hall codes that are no Hall sequence; `why` is a clause.
pub fn hall_codes(at: &Location, given: &str, why: &str) -> Diagnostic {
    Diagnostic::new(
        Code::HallCodes,
        at,
        format!(
            "`hall_codes`: {given}: {why}; give the codes of sectors 1 to 6, each one bit from the next, for example `[1, 5, 4, 6, 2, 3]`, or with sensors 60 degrees apart `[0, 1, 3, 7, 6, 4]`"
        ),
    )
}

/// Data of an EMF shape that cannot be; `why` is a clause with a remedy.
pub fn emf_shape(at: &Location, field: &str, why: &str) -> Diagnostic {
    Diagnostic::new(Code::EmfShape, at, format!("`{field}`: {why}"))
}

/// Angles of Hall edges far from their places; `why` is a clause.
pub fn hall_angles(at: &Location, given: &str, why: &str, farthest: f64) -> Diagnostic {
    Diagnostic::new(
        Code::HallCodes,
        at,
        format!(
            "`hall_angles`: {given}: {why}; give the electrical angles at which sectors 1 to 6 begin, each at most {farthest} deg from -30, 30, 90, 150, 210, 270 deg, and check the order of `hall_codes` if they are farther"
        ),
    )
}

/// A gap of Hall codes in which the rotor may leave the next sector.
pub fn hall_glitches(at: &Location, given: &str, most: u32, maximum_speed: &str) -> Diagnostic {
    let remedy = match most {
        0 => "leave it out, or lower `maximum_speed`".to_owned(),
        _ => format!("give at most {most}, or lower `maximum_speed`"),
    };
    Diagnostic::new(
        Code::OutOfRange,
        at,
        format!(
            "`hall_glitches`: {given} samples and one more take longer than a sector at `maximum_speed` {maximum_speed}, so that the code behind them may skip one; {remedy}"
        ),
    )
}

/// How a value is written, by examples.
fn like(at: &Location, field: &str, examples: &[String]) -> String {
    let examples: Vec<String> = examples
        .iter()
        .map(|example| written(at, field, example))
        .collect();
    format!("write it like {}", list(&examples, "or"))
}

/// `` `a` (what a means) or `b` (what b means) ``.
pub(crate) fn with_meanings<S: AsRef<str>>(words: &[(S, S)]) -> String {
    let explained: Vec<String> = words
        .iter()
        .map(|(word, meaning)| format!("`{}` ({})", word.as_ref(), meaning.as_ref()))
        .collect();
    explained.join(" or ")
}

/// Values as they are written at a place: in a file with their field, for TOML has quotes.
pub(super) fn in_field(
    at: &Location,
    field: &str,
    forms: &[(String, String)],
) -> Vec<(String, String)> {
    forms
        .iter()
        .map(|(value, meaning)| (written(at, field, value), meaning.clone()))
        .collect()
}

fn written(at: &Location, field: &str, value: &str) -> String {
    match at {
        Location::File { .. } => format!("{field}: {value}"),
        Location::Macro(_) | Location::Variant { .. } => value.to_owned(),
    }
}
