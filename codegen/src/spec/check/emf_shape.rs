//! The shape of the EMF: a word, and for `harmonics` and `samples` the data that belong to it.

use crate::diagnostics::{Collector, catalogue, significant};
use crate::spec::EmfShape;
use crate::spec::harmonics::{Harmonics, Trace};
use crate::spec::reader::Reader;
use std::f64::consts::TAU;

/// Fewest and most samples of a trace.
const SAMPLES: [usize; 2] = [24, 1000];

/// Greatest share of offset and even orders, and of orders that three divides, in a trace.
const MOST_FOREIGN: f64 = 0.03;

/// Largest difference between a trace's amplitude and that of the EMF constant, relative.
const MOST_APART: f64 = 0.05;

/// Least part of the EMF in the plane along its fundamental, over that: a current in proportion to the
/// EMF grows with its inverse.
const LEAST_ALONG: f64 = 0.5;

/// Greatest sum of the harmonics' amplitudes over the fundamental's, each times its order: a shape's
/// slope. A square wave of the orders taken has 8.
const STEEPEST: f64 = 8.0;

/// What `emf_shape` says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Trapezoidal,
    Sinusoidal,
    Harmonics,
    Samples,
}

/// Fields that have a meaning with one shape alone.
const OF_KIND: [(&str, Kind, &str); 6] = [
    ("flat_top", Kind::Trapezoidal, "emf_shape: trapezoidal"),
    ("emf_orders", Kind::Harmonics, "emf_shape: harmonics"),
    ("emf_amplitudes", Kind::Harmonics, "emf_shape: harmonics"),
    ("emf_phases", Kind::Harmonics, "emf_shape: harmonics"),
    ("emf_samples", Kind::Samples, "emf_shape: samples"),
    ("emf_samples_speed", Kind::Samples, "emf_shape: samples"),
];

/// The stated shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stated {
    pub shape: EmfShape,
    /// The trace that it was taken from.
    pub trace: Option<Trace>,
}

/// Reads the shape.
pub(super) fn read(reader: &Reader, errors: &mut Collector) -> Option<Stated> {
    let flat_top = reader.plain_quantity(errors, "flat_top");
    let kind = reader.word(
        errors,
        "emf_shape",
        &[
            ("trapezoidal", Kind::Trapezoidal),
            ("sinusoidal", Kind::Sinusoidal),
            ("harmonics", Kind::Harmonics),
            ("samples", Kind::Samples),
        ],
    )?;
    refuse_others(reader, kind, errors);
    let shape = match kind {
        Kind::Trapezoidal => EmfShape::Trapezoidal {
            flat_top_deg: flat_top.map_or(120.0, |given| given.si),
        },
        Kind::Sinusoidal => EmfShape::Sinusoidal,
        Kind::Harmonics => EmfShape::Harmonics(read_harmonics(reader, errors)?),
        Kind::Samples => {
            let trace = read_trace(reader, errors)?;
            return Some(Stated {
                shape: EmfShape::Harmonics(trace.shape),
                trace: Some(trace),
            });
        }
    };
    Some(Stated { shape, trace: None })
}

/// Data of another shape than the stated one.
fn refuse_others(reader: &Reader, kind: Kind, errors: &mut Collector) {
    let of_others = OF_KIND.iter().filter(|(_, of, _)| *of != kind);
    for (name, _, needed) in of_others {
        reader.refuse_without(errors, needed, &[name]);
    }
}

fn refuse(reader: &Reader, field: &'static str, problem: &str, errors: &mut Collector) {
    let part = reader.part(field, String::new);
    errors.push(catalogue::emf_shape(&part.location, field, problem));
}

fn read_harmonics(reader: &Reader, errors: &mut Collector) -> Option<Harmonics> {
    reader.require(errors, &["emf_orders", "emf_amplitudes"]);
    let orders = reader.integers(errors, "emf_orders");
    let each = |name, errors: &mut Collector| {
        reader.each(name, |one| Some(one.plain_quantity(errors, name)?.si))
    };
    let amplitudes = each("emf_amplitudes", errors);
    let has_phases = reader.field("emf_phases").is_some();
    let phases = each("emf_phases", errors);
    let (orders, amplitudes) = (orders?.0, amplitudes?);
    let phases = if has_phases {
        phases?
    } else {
        vec![0.0; orders.len()]
    };
    let lists = [("emf_amplitudes", &amplitudes), ("emf_phases", &phases)];
    for (field, list) in lists {
        if list.len() != orders.len() {
            let (has, needs) = (list.len(), orders.len());
            let problem =
                format!("{has} in the list, but {needs} in `emf_orders`; give one of each order");
            refuse(reader, field, &problem, errors);
            return None;
        }
    }
    if orders.is_empty() {
        let problem = "no order; give at least one, or `sinusoidal` as `emf_shape`";
        refuse(reader, "emf_orders", problem, errors);
        return None;
    }
    let is_odd = |order: i64| u32::try_from(order).is_ok_and(Harmonics::has_order);
    let wrong = (0..orders.len()).find(|&k| !is_odd(orders[k]) || orders[..k].contains(&orders[k]));
    if let Some(wrong) = wrong {
        let order = orders[wrong];
        let problem = format!(
            "order {order}; give different odd orders from 3 to 23: the fundamental is 100 %, and even ones cancel between the poles"
        );
        refuse(reader, "emf_orders", &problem, errors);
        return None;
    }
    let values = amplitudes.into_iter().zip(phases);
    let stated = orders.iter().zip(values);
    let stated =
        stated.map(|(order, (amplitude, phase))| (*order as u32, amplitude, phase.to_radians()));
    plausible(Harmonics::of(stated), reader, "emf_amplitudes", errors)
}

/// The shape, unless its EMF nearly vanishes somewhere, or changes too fast.
fn plausible(
    shape: Harmonics,
    reader: &Reader,
    field: &'static str,
    errors: &mut Collector,
) -> Option<Harmonics> {
    let (along, steep) = (shape.least_along(), shape.steepness());
    let problem = if along < LEAST_ALONG {
        format!(
            "along its fundamental the EMF of the three phases falls to {} % of it, below {} %, at some angle; no current in proportion to it suits a motor: lower the harmonics",
            significant(100.0 * along),
            100.0 * LEAST_ALONG,
        )
    } else if steep > STEEPEST {
        format!(
            "the amplitudes times their orders are {} % of the fundamental, above {} %; no winding is so steep: lower the harmonics of high order",
            significant(100.0 * steep),
            100.0 * STEEPEST,
        )
    } else {
        return Some(shape);
    };
    refuse(reader, field, &problem, errors);
    None
}

fn read_trace(reader: &Reader, errors: &mut Collector) -> Option<Trace> {
    const FIELD: &str = "emf_samples";
    reader.require(errors, &[FIELD]);
    let samples = reader.each(FIELD, |one| Some(one.plain(errors, FIELD)?.si))?;
    let [fewest, most] = SAMPLES;
    if !(fewest..=most).contains(&samples.len()) {
        let problem = format!("{} samples; give {fewest} to {most}", samples.len());
        refuse(reader, FIELD, &problem, errors);
        return None;
    }
    let percent = |share: f64| significant(100.0 * share);
    let trace = Trace::of(&samples);
    let problem = match trace {
        None => "no fundamental in them; give the voltage between two terminals of the turned motor over one electrical period".to_owned(),
        Some(trace) if trace.uneven > MOST_FOREIGN => format!(
            "the two half waves are not opposite: offset and even harmonics are {} % of the fundamental, above {} %; give one whole electrical period, without offset",
            percent(trace.uneven),
            percent(MOST_FOREIGN),
        ),
        Some(trace) if trace.triple > MOST_FOREIGN => format!(
            "harmonics of order 3, 9, 15 and 21 are {} % of the fundamental, above {} %, but cancel between two terminals; give the trace between two terminals, not of one to the star point",
            percent(trace.triple),
            percent(MOST_FOREIGN),
        ),
        Some(trace) => {
            plausible(trace.shape, reader, FIELD, errors)?;
            return Some(trace);
        }
    };
    refuse(reader, FIELD, &problem, errors);
    None
}

/// Compares the amplitude of a trace in volt with that of the EMF constant, where the speed of the trace
/// is known. `constant`: peak of a phase's EMF over mechanical speed, V s/rad.
pub(super) fn check_amplitude(
    reader: &Reader,
    stated: &Stated,
    constant: f64,
    errors: &mut Collector,
) {
    const FIELD: &str = "emf_samples_speed";
    let speed = reader.plain_quantity(errors, FIELD);
    let (Some(speed), Some(peak)) = (speed, stated.trace.map(|trace| trace.peak)) else {
        return;
    };
    let expected = constant * stated.shape.line_to_line_peak() * speed.si;
    if (peak / expected - 1.0).abs() > MOST_APART {
        let problem = format!(
            "at {} rpm the samples peak at {} V, and the EMF constant says {} V between two terminals; correct one of the two",
            significant(speed.si * 60.0 / TAU),
            significant(peak),
            significant(expected),
        );
        refuse(reader, FIELD, &problem, errors);
    }
}
