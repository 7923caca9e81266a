//! The motor's data: basis, winding and shape resolved to phase values of the equivalent star.

use super::emf::{self, Emf, Winding};
use super::{agreement, angle, emf_shape};
use crate::diagnostics::{Collector, catalogue, engineering, significant};
use crate::spec::ast::{Basis, Value};
use crate::spec::fields;
use crate::spec::model::extreme_sectors;
use crate::spec::reader::{Given, Reader};
use crate::spec::units::Dimension;
use crate::spec::{AngleSensor, EmfShape, HALL_ANGLES, MotorSpec, RotorSource};

/// The usual shapes of the EMF, and which motors have them.
const EMF_SHAPES: [(&str, &str); 2] = [
    ("sinusoidal", "most servo, hub and outrunner motors"),
    (
        "trapezoidal",
        "motors sold as BLDC whose EMF has a flat top",
    ),
];

/// Fields with the data of a shape, and that shape.
const SHAPES_OF_DATA: [(&str, &[(&str, &str)]); 2] = [
    ("emf_samples", &[("samples", "those of `emf_samples`")]),
    ("emf_orders", &[("harmonics", "those of `emf_orders`")]),
];

/// The motor as far as it could be read.
pub(super) struct Motor<'a> {
    pub description: String,
    pub pole_pairs: Option<u32>,
    pub resistance: Option<f64>,
    pub inductance: Option<f64>,
    /// The EMF constant as it is stated, and whatever else states it.
    pub emf: Vec<Emf<'a>>,
    pub emf_constant: Option<f64>,
    pub emf_shape: Option<EmfShape>,
    pub rated_current: Option<Given<'a>>,
    pub rated_torque: Option<Given<'a>>,
    pub rated_speed: Option<Given<'a>>,
    pub no_load_speed: Option<Given<'a>>,
    pub nominal_voltage: Option<Given<'a>>,
    pub inertia: Option<f64>,
    pub inductance_tolerance: f64,
    pub resistance_tolerance: f64,
    /// None with Hall sensors, and together with an error.
    pub angle: Option<AngleSensor>,
    /// None together with an error.
    pub rotor: Option<RotorSource>,
    pub hall_codes: [u8; 6],
    pub hall_angles: [f64; 6],
}

pub(super) fn read<'a>(reader: &Reader<'a>, errors: &mut Collector) -> Motor<'a> {
    let names = ["resistance", "inductance", "rated_current", "rated_speed"];
    reader.require(errors, &names);
    // Data of a shape say which it is.
    let of_data = SHAPES_OF_DATA
        .iter()
        .find(|(field, _)| reader.field(field).is_some());
    let shapes = of_data.map_or(&EMF_SHAPES[..], |(_, shape)| shape);
    reader.require_choice(errors, "emf_shape", shapes);
    emf::require(reader, errors);
    reader.require_one_of(errors, ["pole_pairs", "poles"]);
    let pole_pairs = read_pole_pairs(reader, errors);
    let winding = read_winding(reader, errors);
    let resistance = read_winding_value(reader, errors, "resistance", winding);
    let inductance = read_winding_value(reader, errors, "inductance", winding);
    let stated = emf_shape::read(reader, errors);
    let emf_shape = stated.map(|stated| stated.shape);
    let constants = emf::read(reader, winding, emf_shape, errors);
    let mut emf = agreement::resolve(constants, emf_shape, errors);
    if stated.is_some_and(|stated| stated.trace.is_some()) {
        emf::refuse_phase(&mut emf, errors);
    }
    let emf_constant = match (emf.first(), emf_shape, pole_pairs) {
        (Some(stated), Some(shape), Some(pole_pairs)) => {
            emf::check_plausible(stated, stated.phase_constant(shape, pole_pairs), errors)
        }
        _ => None,
    };
    if let (Some(stated), Some(constant)) = (stated, emf_constant) {
        emf_shape::check_amplitude(reader, &stated, constant, errors);
    }
    let (rotor, angle) = angle::read(reader, pole_pairs, errors);
    Motor {
        description: reader.text("description").unwrap_or_default().to_owned(),
        pole_pairs,
        resistance,
        inductance,
        emf,
        emf_constant,
        emf_shape,
        rated_current: read_rated_current(reader, emf_shape, errors),
        rated_torque: reader.plain_quantity(errors, "rated_torque"),
        rated_speed: reader.plain_quantity(errors, "rated_speed"),
        no_load_speed: reader.plain_quantity(errors, "no_load_speed"),
        nominal_voltage: read_nominal_voltage(reader, errors),
        inertia: reader
            .plain_quantity(errors, "inertia")
            .map(|given| given.si),
        inductance_tolerance: reader
            .plain_quantity(errors, "inductance_tolerance")
            .map_or(0.1, |given| given.si),
        resistance_tolerance: reader
            .plain_quantity(errors, "resistance_tolerance")
            .map_or(0.3, |given| given.si),
        angle,
        rotor,
        hall_codes: read_hall_codes(reader, errors).unwrap_or([1, 5, 4, 6, 2, 3]),
        hall_angles: read_hall_angles(reader, errors).unwrap_or(HALL_ANGLES),
    }
}

impl Motor<'_> {
    /// Width of the narrowest and of the widest sector, over 60 degrees.
    pub fn extreme_sectors(&self) -> [f64; 2] {
        extreme_sectors(&self.hall_angles)
    }

    /// The checked motor. None if something is missing or in error.
    pub fn finish(&self) -> Option<MotorSpec> {
        Some(MotorSpec {
            description: self.description.clone(),
            pole_pairs: self.pole_pairs?,
            resistance: self.resistance?,
            inductance: self.inductance?,
            emf_constant: self.emf_constant?,
            emf_shape: self.emf_shape?,
            rated_current: self.rated_current.as_ref()?.si,
            rated_torque: self.rated_torque.as_ref().map(|given| given.si),
            rated_speed: self.rated_speed.as_ref()?.si,
            inertia: self.inertia,
            inductance_tolerance: self.inductance_tolerance,
            resistance_tolerance: self.resistance_tolerance,
            hall_codes: self.hall_codes,
            hall_angles: self.hall_angles,
        })
    }
}

/// Resistance or inductance of the equivalent star's phase: half of the line-to-line value, and a
/// third of a delta's phase value.
fn read_winding_value(
    reader: &Reader,
    errors: &mut Collector,
    name: &'static str,
    winding: Option<Winding>,
) -> Option<f64> {
    let given = reader.quantity(errors, name)?;
    let (at, text) = (&given.part.location, &given.part.given);
    match given.basis {
        [Basis::LineToLine] => Some(given.si / 2.0),
        [Basis::PerPhase] => match winding? {
            Winding::Star => Some(given.si),
            Winding::Delta => Some(given.si / 3.0),
        },
        [] => {
            let unit = if name == "resistance" { "ohm" } else { "H" };
            let half = engineering(given.si / 2.0, unit);
            let forms: Vec<(String, String)> = fields::field(name)
                .references()
                .iter()
                .map(|(basis, meaning)| {
                    let meaning = match basis {
                        Basis::LineToLine => format!("{meaning}: {half} per phase of a star"),
                        _ => (*meaning).to_owned(),
                    };
                    (format!("{text} {}", basis.word()), meaning)
                })
                .collect();
            errors.push(catalogue::missing_basis(at, name, text, &forms));
            None
        }
        [.., last] => {
            let is_other = |basis: &&Basis| !matches!(basis, Basis::LineToLine | Basis::PerPhase);
            let wrong = given.basis.iter().find(is_other).unwrap_or(last).word();
            let remedy = "write either `per_phase` or `line_to_line`";
            errors.push(catalogue::wrong_basis(at, name, text, wrong, remedy));
            None
        }
    }
}

/// As given, or half of the poles.
fn read_pole_pairs(reader: &Reader, errors: &mut Collector) -> Option<u32> {
    if reader.field("pole_pairs").is_some() {
        return reader.integer(errors, "pole_pairs");
    }
    let poles = reader.integer(errors, "poles")?;
    if poles % 2 == 1 {
        let part = reader.part("poles", String::new);
        errors.push(catalogue::odd_poles(&part.location, &part.given, poles));
        return None;
    }
    Some(poles / 2)
}

/// The connection of the phases. Values between terminals say all of it by themselves.
fn read_winding(reader: &Reader, errors: &mut Collector) -> Option<Winding> {
    let words = [("star", Winding::Star), ("delta", Winding::Delta)];
    if reader.field("winding").is_some() {
        return reader.word(errors, "winding", &words);
    }
    let mut is_linkage = false;
    let of_phase = ["resistance", "inductance", "back_emf"]
        .into_iter()
        .find(|name| {
            let Some(Value::Number(number)) = reader.field(name).map(|field| &field.value) else {
                return false;
            };
            let unit = number.unit.as_ref();
            is_linkage |= unit.is_some_and(|unit| unit.dimension == Dimension::FluxLinkage);
            let of_phase = [Basis::PerPhase, Basis::Phase];
            of_phase.iter().any(|basis| number.basis.contains(basis))
        });
    match of_phase {
        Some(name) if reader.may_lack("winding") => {
            errors.push(catalogue::missing_winding(&reader.part(name, String::new)));
        }
        Some(_) => {}
        None if is_linkage => reader.require(errors, &["winding"]),
        None => return Some(Winding::Star),
    }
    None
}

/// The voltage at which the no-load speed holds, of use with it alone.
fn read_nominal_voltage<'a>(reader: &Reader<'a>, errors: &mut Collector) -> Option<Given<'a>> {
    let given = reader.plain_quantity(errors, "nominal_voltage")?;
    if reader.field("no_load_speed").is_none() {
        errors.push(catalogue::needless_field(
            &given.part.location,
            "nominal_voltage",
            &given.part.given,
            "no_load_speed: 5000 rpm",
            None,
        ));
    }
    Some(given)
}

/// The rated current is the peak of the wave that belongs to the EMF's shape. Beside a flat top it is that of a
/// quasi-square wave unless it says otherwise; of a sine, data sheets print either.
fn read_rated_current<'a>(
    reader: &Reader<'a>,
    shape: Option<EmfShape>,
    errors: &mut Collector,
) -> Option<Given<'a>> {
    let given = reader.quantity(errors, "rated_current")?;
    let is_flat = matches!(shape, None | Some(EmfShape::Trapezoidal { .. }));
    match given.basis {
        [] if !is_flat => {
            let (at, text) = (&given.part.location, &given.part.given);
            let peak = shape.map_or(given.si, |shape| given.si * shape.rated_peak());
            let forms = [
                (
                    "peak",
                    "of the phase current, or what two phases carry in block commutation"
                        .to_owned(),
                ),
                (
                    "rms",
                    format!(
                        "of the phase current, as servo drives state it: {} peak",
                        engineering(peak, "A")
                    ),
                ),
            ];
            let forms = forms.map(|(basis, meaning)| (format!("{text} {basis}"), meaning));
            errors.push(catalogue::missing_basis_of_current(at, text, &forms));
            None
        }
        [] | [Basis::Peak] => Some(given),
        [Basis::PeakToPeak] => Some(emf::amplitude(given)),
        [Basis::Rms] => Some(Given {
            si: given.si * shape?.rated_peak(),
            ..given
        }),
        [.., last] => {
            let remedy = "write `peak` (of the block or sine wave) or `rms` of the phase current";
            let (at, text) = (&given.part.location, &given.part.given);
            errors.push(catalogue::wrong_basis(
                at,
                "rated_current",
                text,
                last.word(),
                remedy,
            ));
            None
        }
    }
}

/// Six different codes, neighbours (and last and first) one bit apart, of which each sensor shows a
/// one in three sectors in a row. Sensors 120 degrees apart never agree; of sensors 60 degrees apart
/// two other opposite codes do not occur.
fn read_hall_codes(reader: &Reader, errors: &mut Collector) -> Option<[u8; 6]> {
    let (list, part) = reader.integers(errors, "hall_codes")?;
    let codes: Vec<u8> = list
        .iter()
        .filter_map(|code| u8::try_from(*code).ok())
        .collect();
    let twice = (0..codes.len()).find(|&k| codes[..k].contains(&codes[k]));
    let problem = if let Some(code) = list.iter().find(|code| !(0..=7).contains(*code)) {
        Some(format!("{code} lies outside 0 to 7"))
    } else if list.len() != 6 {
        Some(format!("{} codes instead of 6", list.len()))
    } else if let Some(k) = twice {
        Some(format!("{} stands twice", codes[k]))
    } else if let Some(k) = (0..6).find(|&k| (codes[k] ^ codes[(k + 1) % 6]).count_ones() != 1) {
        let next = codes[(k + 1) % 6];
        Some(format!(
            "{} and {next} differ by more than one bit",
            codes[k]
        ))
    } else {
        let missing: Vec<u8> = (0..8).filter(|code| !codes.contains(code)).collect();
        let is_odd = missing[0] ^ missing[1] != 7;
        is_odd.then(|| "a sensor does not show a one for half a turn".to_owned())
    };
    if let Some(problem) = problem {
        errors.push(catalogue::hall_codes(&part.location, &part.given, &problem));
        return None;
    }
    codes.try_into().ok()
}

/// Largest placement error of a Hall edge, electrical degrees; a larger one is more likely a wrong order
/// of the codes.
const LARGEST_ERROR: f64 = 20.0;

/// Six angles, each near its place; whole turns more or less make no difference.
fn read_hall_angles(reader: &Reader, errors: &mut Collector) -> Option<[f64; 6]> {
    const FIELD: &str = "hall_angles";
    let given = reader.each(FIELD, |one| {
        one.plain_quantity(errors, FIELD).map(|given| given.si)
    })?;
    let within_a_turn =
        |(angle, place): (&f64, &f64)| angle - 360.0 * ((angle - place) / 360.0).round();
    let angles: Vec<f64> = given.iter().zip(&HALL_ANGLES).map(within_a_turn).collect();
    let error_of = |k: usize| (angles[k] - HALL_ANGLES[k]).abs();
    let far = (0..angles.len()).find(|&k| error_of(k) > LARGEST_ERROR + 1e-9);
    let problem = match far {
        _ if given.len() != 6 => format!("{} angles instead of 6", given.len()),
        Some(k) => format!(
            "that of sector {} is {} deg from its place, {} deg",
            k + 1,
            significant(error_of(k)),
            HALL_ANGLES[k],
        ),
        None => return angles.try_into().ok(),
    };
    let part = reader.part(FIELD, String::new);
    errors.push(catalogue::hall_angles(
        &part.location,
        &part.given,
        &problem,
        LARGEST_ERROR,
    ));
    None
}
