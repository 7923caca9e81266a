//! The EMF constant against what else states it: rated torque and current, torque constant, speed
//! constant, no-load speed.
//!
//! All of them say the same thing about a motor. Where they do not, some basis or shape is wrong:
//! the commonest mistake of this field. One contradiction is one error, at the value that is most
//! likely wrong; it tells which other reading would fit.

use super::agreement::{self, ROUNDED};
use super::emf::{Emf, Reading, words};
use super::inverter::Inverter;
use super::motor::Motor;
use crate::diagnostics::catalogue::{self, Contradiction, Part};
use crate::diagnostics::{Code, Collector, Diagnostic, engineering, rpm};
use crate::spec::EmfShape;
use crate::spec::ast::Basis;
use crate::spec::reader::Reader;
use crate::spec::units::Dimension;

/// Data sheets round, and rate torque with iron losses: so much is no contradiction.
const TOLERANCE: f64 = 0.15;

/// So near are two printed constants that are one number.
const EQUAL: f64 = 0.01;

/// Something that follows from the phase constant and is stated, too.
struct Claim<'a> {
    code: Code,
    /// The fields that state it, the one with the value first.
    parts: Vec<&'a Part>,
    /// As a constant, in V s/rad or Nm/A.
    constant: f64,
    /// What it may be over the phase constant.
    factors: Vec<f64>,
    /// The value as it is told, of a constant.
    told: Box<dyn Fn(f64) -> String + 'a>,
}

impl Claim<'_> {
    /// The values of constants, in words.
    fn values(&self, constants: &[f64]) -> String {
        let told = constants.iter().map(|constant| (self.told)(*constant));
        told.collect::<Vec<_>>().join(" or ")
    }

    fn agrees(&self, phase: f64) -> bool {
        let fits = |factor: &f64| fits(factor * phase, self.constant);
        self.factors.iter().any(fits)
    }
}

/// Another reading of one field: what is changed, where, and the phase constant or the claim's
/// constant over what they were.
struct Other<'a> {
    change: String,
    at: &'a Part,
    phase: f64,
}

fn fits(expected: f64, given: f64) -> bool {
    (expected / given - 1.0).abs() <= TOLERANCE
}

/// Reports a contradiction; returns whether there is one. `warnings` takes what is no contradiction
/// but probably a mean that was taken for a peak.
pub(super) fn check(
    reader: &Reader,
    motor: &Motor,
    inverter: &Inverter,
    errors: &mut Collector,
    warnings: &mut Vec<Diagnostic>,
) -> bool {
    // An implausible constant is an error of its own.
    let (Some(phase), Some(shape), Some(pole_pairs)) =
        (motor.emf_constant, motor.emf_shape, motor.pole_pairs)
    else {
        return false;
    };
    let [stated, rest @ ..] = motor.emf.as_slice() else {
        return false;
    };
    let claims = claims(motor, inverter, rest, shape, pole_pairs);
    let (agreeing, failing): (Vec<&Claim>, Vec<&Claim>) =
        claims.iter().partition(|claim| claim.agrees(phase));
    if failing.is_empty() {
        let apart = || apart(stated, rest, shape, pole_pairs);
        let taken = agreement::warning(&motor.emf, shape)
            .or_else(|| mean_for_peak(stated, rest, shape, pole_pairs));
        warnings.extend(taken.or_else(apart));
        return false;
    }
    // An odd one must be among those that do not fit.
    let majority = majority(phase, &claims).filter(|&constant| {
        !fits(constant, phase) || failing.iter().any(|claim| !claim.agrees(constant))
    });
    let is_odd = |claim: &&&Claim| majority.is_some_and(|constant| !claim.agrees(constant));
    let Some(first) = failing.iter().find(is_odd).or(failing.first()) else {
        return false;
    };
    let shape_part = reader.part("emf_shape", String::new);
    let others = others(stated, shape, pole_pairs, &shape_part);
    let mut fitting = fitting(others, first, motor, phase);
    // Another reading must not contradict what agrees with this one.
    fitting.retain(|(other, _)| agreeing.iter().all(|claim| claim.agrees(other.phase)));
    let stated_part = &stated.given.part;
    let (culprit, agreed) = if let Some(constant) = majority {
        odd_one(stated_part, &claims, first, [phase, constant])
    } else {
        let misread = fitting.first().map(|(other, _)| other.at);
        (misread.unwrap_or(first.parts[0]), Vec::new())
    };
    fitting.retain(|(other, _)| agreed.iter().all(|part| part.field != other.at.field));
    let mut parts = first.parts.clone();
    parts.push(stated_part);
    for claim in failing
        .iter()
        .filter(|claim| claim.parts[0].field != first.parts[0].field)
    {
        parts.extend(&claim.parts);
    }
    let is_electrical = fitting
        .iter()
        .any(|(other, _)| other.at.field == "no_load_speed");
    // The claim's current may be misread as well as its torque.
    let of_claim = |at: &&Part| first.parts.iter().any(|part| part.field == at.field);
    let misread = fitting.first().map(|(other, _)| other.at);
    let culprit = misread.filter(of_claim).unwrap_or(culprit);
    let fitting: Vec<(String, String)> = fitting
        .iter()
        .map(|(other, constants)| (other.change.clone(), first.values(constants)))
        .collect();
    let expected: Vec<f64> = first.factors.iter().map(|factor| factor * phase).collect();
    errors.push(catalogue::contradiction(&Contradiction {
        code: first.code,
        culprit,
        claim: &first.parts,
        stated: stated_part,
        expected: expected
            .iter()
            .map(|constant| (first.told)(*constant))
            .collect(),
        ratio: expected[0] / first.constant,
        inverse: matches!(first.code, Code::SpeedContradiction),
        parts: &parts,
        agreed: &agreed,
        fitting: &fitting,
        voltage: (first.parts[0].field == "no_load_speed" && motor.nominal_voltage.is_none())
            .then_some(if is_electrical {
                "if it is an electrical speed (eRPM), divide it by the pole pairs; if it holds at another voltage, state that as `nominal_voltage`"
            } else {
                "if the speed holds at another voltage, state that as `nominal_voltage`"
            }),
    }));
    true
}

/// The value that most others speak against, and these; `first`: the first claim that does not fit the constant that is
/// taken, `phase`, nor that of most statements, `constant`.
fn odd_one<'a>(
    stated: &'a Part,
    claims: &[Claim<'a>],
    first: &Claim<'a>,
    [phase, constant]: [f64; 2],
) -> (&'a Part, Vec<&'a Part>) {
    let agreeing = claims.iter().filter(|claim| claim.agrees(constant));
    let agreeing = agreeing.map(|claim| claim.parts[0]);
    if fits(constant, phase) {
        let culprit = first.parts[0];
        let agreeing = agreeing.filter(|part| part.field != culprit.field);
        (culprit, std::iter::once(stated).chain(agreeing).collect())
    } else {
        (stated, agreeing.collect())
    }
}

/// The constant that most statements agree with, more than half of them; none where all agree.
fn majority(phase: f64, claims: &[Claim]) -> Option<f64> {
    let implied = claims.iter().flat_map(|claim| {
        let factors = claim.factors.iter();
        factors.map(|factor| claim.constant / factor)
    });
    let votes = |constant: f64| {
        let claims = claims.iter().filter(|claim| claim.agrees(constant)).count();
        claims + usize::from(fits(constant, phase))
    };
    let constants = std::iter::once(phase).chain(implied);
    let mut best = (phase, 0);
    for constant in constants {
        let votes = votes(constant);
        if votes > best.1 {
            best = (constant, votes);
        }
    }
    let (constant, votes) = best;
    let all = 1 + claims.len();
    (2 * votes > all && votes < all).then_some(constant)
}

/// Torque per ampere of a rated current's peak over the phase constant, by the current's shape.
fn factors_of_rating(shape: EmfShape, is_rms: bool) -> Vec<f64> {
    // Of one root mean square a block has another plateau than a sine has a peak.
    let plateau = if is_rms {
        1.5_f64.sqrt() / shape.rated_peak()
    } else {
        1.0
    };
    let block = shape.quasi_square_factor() * plateau;
    // A sinusoidal current of the same peak, too.
    let has_sine = !matches!(shape, EmfShape::Trapezoidal { .. });
    std::iter::once(block)
        .chain(has_sine.then(|| shape.sine_factor()))
        .collect()
}

/// Everything that is stated beside the constant that is taken.
fn claims<'a>(
    motor: &'a Motor,
    inverter: &'a Inverter,
    rest: &'a [Emf<'a>],
    shape: EmfShape,
    pole_pairs: u32,
) -> Vec<Claim<'a>> {
    let (block, sine) = (shape.quasi_square_factor(), shape.sine_factor());
    let mut claims = Vec::new();
    if let (Some(torque), Some(current)) = (&motor.rated_torque, &motor.rated_current) {
        let factors = factors_of_rating(shape, current.basis.contains(&Basis::Rms));
        let amperes = current.si;
        claims.push(Claim {
            code: Code::TorqueContradiction,
            parts: vec![&torque.part, &current.part],
            constant: torque.si / amperes,
            factors,
            told: Box::new(move |constant| engineering(constant * amperes, "Nm")),
        });
    }
    for other in rest {
        let is_speed = other.given.dimension == Some(Dimension::SpeedConstant);
        let factors = if other.reading == Reading::PerAmpere {
            vec![block, sine]
        } else {
            vec![other.reading.factor(shape)]
        };
        claims.push(Claim {
            code: if is_speed {
                Code::SpeedContradiction
            } else {
                Code::TorqueConstantContradiction
            },
            parts: vec![&other.given.part],
            constant: other.constant(pole_pairs),
            factors,
            told: Box::new(move |constant| {
                if is_speed {
                    format!("{}/V", rpm(1.0 / constant))
                } else {
                    engineering(constant, "Nm/A")
                }
            }),
        });
    }
    let voltage = motor.nominal_voltage.as_ref().or(inverter.v_bus.as_ref());
    if let (Some(speed), Some(voltage)) = (&motor.no_load_speed, voltage) {
        let volts = voltage.si;
        claims.push(Claim {
            code: Code::SpeedContradiction,
            parts: vec![&speed.part, &voltage.part],
            constant: volts / speed.si,
            factors: vec![block],
            told: Box::new(move |constant| rpm(volts / constant)),
        });
    }
    claims
}

/// The other bases that a constant may have.
fn other_readings(stated: &Emf) -> impl Iterator<Item = Reading> + Clone {
    let taken = stated.reading;
    // A voltage from peak to peak was halved: it has no root mean square.
    let is_double = stated.given.basis.contains(&Basis::PeakToPeak);
    let is_peak = |reading: Reading| matches!(reading, Reading::PhasePeak | Reading::LinePeak);
    let others = stated.readings().iter().copied();
    others.filter(move |reading| *reading != taken && (!is_double || is_peak(*reading)))
}

/// Other readings of the constant that is taken: its other bases, the other shape, and two of them
/// together.
fn others<'a>(
    stated: &'a Emf<'a>,
    shape: EmfShape,
    pole_pairs: u32,
    shape_part: &'a Part,
) -> Vec<Other<'a>> {
    let part = &stated.given.part;
    let (other_shape, word) = match shape {
        EmfShape::Trapezoidal { .. } => (EmfShape::Sinusoidal, "sinusoidal"),
        EmfShape::Sinusoidal | EmfShape::Harmonics(_) => {
            let flat_top_deg = 120.0;
            (EmfShape::Trapezoidal { flat_top_deg }, "trapezoidal")
        }
    };
    let constant = stated.constant(pole_pairs);
    // Of the torque that a phase constant makes with block currents.
    let scaled = |reading: Reading, of: EmfShape| {
        constant / reading.factor(of) * of.quasi_square_factor() / shape.quasi_square_factor()
    };
    // A voltage from peak to peak was halved.
    let is_double = stated.given.basis.contains(&Basis::PeakToPeak);
    let as_words = |reading| format!("`{}` as `{}`", part.field, words(&stated.given, reading));
    let different = other_readings(stated);
    let whole = is_double.then(|| Other {
        change: format!("`{}` as `{}`", part.field, stated.reading.words()),
        at: part,
        phase: scaled(stated.reading, shape) * 2.0,
    });
    let single = different.clone().map(|reading| Other {
        change: as_words(reading),
        at: part,
        phase: scaled(reading, shape),
    });
    let shape_text = format!("`emf_shape: {word}`");
    let by_shape = Other {
        change: shape_text.clone(),
        at: shape_part,
        phase: scaled(stated.reading, other_shape),
    };
    let double = different.map(|reading| Other {
        change: format!("{} and {shape_text}", as_words(reading)),
        at: part,
        phase: scaled(reading, other_shape),
    });
    single
        .chain(whole)
        .chain([by_shape])
        .chain(double)
        .collect()
}

/// Those readings that fit, with the constants that they give by the current's shape, single changes first; two
/// changes only where no single one fits.
fn fitting<'a>(
    others: Vec<Other<'a>>,
    claim: &Claim<'a>,
    motor: &'a Motor,
    phase: f64,
) -> Vec<(Other<'a>, Vec<f64>)> {
    let factor = claim.factors[0];
    let mut candidates: Vec<(Other, Vec<f64>)> = Vec::new();
    // The claim's own field may be the one that is misread.
    let shape = motor.emf_shape.unwrap_or(EmfShape::Sinusoidal);
    if let (Code::TorqueContradiction, Some(current)) = (claim.code, motor.rated_current.as_ref()) {
        let is_rms = current.basis.contains(&Basis::Rms);
        let (word, peak) = if is_rms {
            ("peak", 1.0 / shape.rated_peak())
        } else {
            ("rms", shape.rated_peak())
        };
        let change = format!("`rated_current` as `{word}`");
        let at = &current.part;
        let factors = factors_of_rating(shape, !is_rms);
        let constants = factors.iter().map(|factor| factor * peak * phase);
        candidates.push((Other { change, at, phase }, constants.collect()));
    }
    if let (Some(speed), Some(pairs @ 2..)) = (motor.no_load_speed.as_ref(), motor.pole_pairs)
        && speed.part.field == claim.parts[0].field
    {
        let change = "`no_load_speed` as an electrical speed, eRPM".to_owned();
        let at = &speed.part;
        let constant = factor * phase / f64::from(pairs);
        candidates.push((Other { change, at, phase }, vec![constant]));
    }
    let claimed = |stated: &&Emf| stated.given.part.field == claim.parts[0].field;
    if let Some(stated) = motor.emf.iter().skip(1).find(claimed) {
        for reading in other_readings(stated) {
            let change = format!(
                "`{}` as `{}`",
                stated.given.part.field,
                words(&stated.given, reading)
            );
            let at = &stated.given.part;
            let constant = reading.factor(shape) * phase;
            candidates.push((Other { change, at, phase }, vec![constant]));
        }
    }
    candidates.extend(others.into_iter().map(|other| {
        let constant = factor * other.phase;
        (other, vec![constant])
    }));
    let fits = |constant: &f64| fits(*constant, claim.constant);
    let fitting = candidates
        .into_iter()
        .filter(|(_, constants)| constants.iter().any(fits));
    let (single, double): (Vec<_>, Vec<_>) =
        fitting.partition(|(other, _)| !other.change.contains(" and "));
    if single.is_empty() { double } else { single }
}

/// A peak and a torque constant that are one number: only the mean over block commutation is both.
fn mean_for_peak(
    stated: &Emf,
    rest: &[Emf],
    shape: EmfShape,
    pole_pairs: u32,
) -> Option<Diagnostic> {
    // Whichever of the two is taken.
    let taken_as_peak = matches!(stated.reading, Reading::LinePeak | Reading::PerPeakAmpere);
    if shape != EmfShape::Sinusoidal || !taken_as_peak {
        return None;
    }
    let is_torque = |of: &Emf| of.given.dimension == Some(Dimension::TorqueConstant);
    let constant = stated.constant(pole_pairs);
    let other = rest.iter().find(|other| {
        let is_of_other_kind = is_torque(other) != is_torque(stated);
        let is_rms = matches!(other.reading, Reading::LineRms | Reading::PerRmsAmpere);
        let is_equal = (other.constant(pole_pairs) / constant - 1.0).abs() <= EQUAL;
        is_of_other_kind && !is_rms && is_equal
    })?;
    let of_phase = Reading::LinePeak.factor(shape);
    let taken = stated.phase_constant(shape, pole_pairs) * of_phase;
    let true_peak = constant * of_phase / Reading::BlockMean.factor(shape);
    let parts = [&stated.given.part, &other.given.part];
    Some(catalogue::mean_for_peak(parts, taken, true_peak))
}

/// Two constants that state their bases, and are further apart than data sheets round.
fn apart(stated: &Emf, rest: &[Emf], shape: EmfShape, pole_pairs: u32) -> Option<Diagnostic> {
    let has_basis = |of: &Emf| !of.given.basis.is_empty();
    let ratio = |one: &Emf, other: &Emf| {
        one.phase_constant(shape, pole_pairs) / other.phase_constant(shape, pole_pairs)
    };
    let is_apart = |ratio: f64| (ratio - 1.0).abs() > ROUNDED;
    let mut stating = rest.iter().filter(|other| has_basis(other));
    let other = stating.find(|other| has_basis(stated) && is_apart(ratio(stated, other)))?;
    let changes = [[stated, other], [other, stated]].map(|[one, other]| {
        other_readings(one).filter_map(move |reading| {
            let given = one.given.clone();
            let field = given.part.field;
            let word = words(&given, reading);
            let changed = ratio(&Emf { given, reading }, other);
            (!is_apart(changed)).then(|| format!("`{field}` as `{word}`"))
        })
    });
    let changes: Vec<String> = changes.into_iter().flatten().collect();
    let parts = [&stated.given.part, &other.given.part];
    Some(catalogue::constants_apart(
        parts,
        ratio(stated, other),
        &changes,
    ))
}

#[cfg(test)]
mod tests {
    use crate::diagnostics::Code;
    use crate::spec::{check, parse_toml};

    /// Codes of what is wrong with the paper's motor, its shape of EMF and one more line in its
    /// file.
    fn codes(shape: &str, line: &str) -> Vec<Code> {
        let text = include_str!("../../example.toml");
        let text = text.replace("\"trapezoidal\"", &format!("\"{shape}\""));
        let lines = text
            .lines()
            .filter(|line| !line.starts_with("rated_torque"));
        let text = lines.collect::<Vec<_>>().join("\n");
        let text = text.replacen("[motor]\n", &format!("[motor]\n{line}\n"), 1);
        let checked = parse_toml(&text, "motor.toml").and_then(|ast| check(&ast).map(drop));
        let errors = checked.err().into_iter().flatten();
        errors.map(|error| error.code).collect()
    }

    /// The first and the last value that are accepted, to a millionth.
    fn check_edges(shape: &str, field: &str, unit: &str, [first, last]: [f64; 2], code: Code) {
        for (edge, outward) in [(first, -1.0), (last, 1.0)] {
            let line =
                |share: f64| format!("{field} = \"{:.9} {unit}\"", edge * (1.0 + share * outward));
            assert_eq!(codes(shape, &line(-1e-6)), [], "{shape}: {}", line(-1e-6));
            assert_eq!(codes(shape, &line(1e-6)), [code], "{shape}: {}", line(1e-6));
        }
    }

    #[test]
    fn torque_and_torque_constant_may_be_fifteen_percent_off_what_the_emf_gives() {
        // 0.1648 V/(rad/s) between two lines: phases of half of it with a flat top, of 1/sqrt 3 of
        // it without.
        let (flat, sine) = (0.1648 / 2.0, 0.1648 / 3.0_f64.sqrt());
        let quasi_square = |phase: f64, share: f64| phase * share;
        // A sine current meets the fundamental of a flat top's EMF, 4/pi sin(30 deg)/(pi/6) of it.
        let (of_flat, of_sine) = (
            quasi_square(flat, 2.0),
            // The mean of a sine over the 60 degrees about the crossing of two phases' tops.
            quasi_square(sine, 3.0 * 3.0_f64.sqrt() / std::f64::consts::PI),
        );
        // What follows from the EMF is 15 % more than the least and 15 % less than the greatest.
        let range = |least: f64, greatest: f64| [least / 1.15, greatest / 0.85];
        let torque = Code::TorqueContradiction;
        let times =
            |[least, greatest]: [f64; 2], current: f64| [least * current, greatest * current];
        check_edges(
            "trapezoidal",
            "rated_torque",
            "Nm",
            times(range(of_flat, of_flat), 20.0),
            torque,
        );
        check_edges(
            "sinusoidal",
            "rated_torque",
            "Nm",
            times(range(1.5 * sine, of_sine), 20.0),
            torque,
        );
        let constant = Code::TorqueConstantContradiction;
        // Per ampere of a sine wave, too, of the same peak.
        check_edges(
            "trapezoidal",
            "torque_constant",
            "Nm/A",
            range(1.5 * 1.215_854_203_708_053 * flat, of_flat),
            constant,
        );
        check_edges(
            "sinusoidal",
            "torque_constant",
            "Nm/A",
            range(1.5 * sine, of_sine),
            constant,
        );
    }
}
