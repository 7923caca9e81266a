//! Constants of which none says its basis: only what they agree upon tells how they are meant.
//!
//! One reading under which they agree is taken, with a warning. Several that mean different motors,
//! or none, are an error that lists them.

use super::emf::{Emf, Reading, forms};
use crate::diagnostics::catalogue::{self, Part};
use crate::diagnostics::{Collector, Diagnostic};
use crate::spec::EmfShape;

/// So near are two constants whose bases are right: no basis is so near to another.
pub(super) const ROUNDED: f64 = 0.04;

/// A reading of each constant, and how far apart they are then.
struct Agreement {
    readings: Vec<Reading>,
    /// Of the first.
    phase: f64,
    /// The greatest phase constant over the least, less 1.
    spread: f64,
}

/// Gives constants without basis the readings that they agree upon; none where that is in doubt.
pub(super) fn resolve<'a>(
    mut all: Vec<Emf<'a>>,
    shape: Option<EmfShape>,
    errors: &mut Collector,
) -> Vec<Emf<'a>> {
    let Some(shape) = shape.filter(|_| is_open(&all)) else {
        return all;
    };
    let mut agreements = agreements(&all, shape);
    agreements.sort_by(|one, other| one.spread.total_cmp(&other.spread));
    match agreements.first() {
        Some(best) if agreements.iter().all(|other| is_same(best, other)) => {
            for (stated, reading) in all.iter_mut().zip(&best.readings) {
                stated.reading = *reading;
            }
            all
        }
        _ => {
            errors.push(doubt(&all, &agreements, shape));
            Vec::new()
        }
    }
}

/// The reading that was taken, where no other one means the same.
pub(super) fn warning(all: &[Emf], shape: EmfShape) -> Option<Diagnostic> {
    if !is_open(all) || agreements(all, shape).len() > 1 {
        return None;
    }
    let readings: Vec<Reading> = all.iter().map(|stated| stated.reading).collect();
    Some(catalogue::basis_by_agreement(
        &parts(all),
        &told(all, &readings),
    ))
}

fn is_open(all: &[Emf]) -> bool {
    all.len() > 1 && all.iter().all(Emf::is_open)
}

fn is_same(one: &Agreement, other: &Agreement) -> bool {
    (one.phase / other.phase - 1.0).abs() <= ROUNDED
}

/// All choices of a reading for each constant under which they agree.
fn agreements(all: &[Emf], shape: EmfShape) -> Vec<Agreement> {
    let mut choices: Vec<Vec<(Reading, f64)>> = vec![Vec::new()];
    for stated in all {
        // Open constants are of the mechanical speed.
        let with = |&reading: &Reading| (reading, stated.constant(1) / reading.factor(shape));
        let more = |choice: &Vec<_>| {
            let choice = choice.clone();
            let readings = stated.readings().iter().map(with);
            readings.map(move |one| [choice.clone(), vec![one]].concat())
        };
        choices = choices.iter().flat_map(more).collect();
    }
    let agreement = |choice: Vec<(Reading, f64)>| {
        let phases = choice.iter().map(|(_, phase)| *phase);
        let least = phases.clone().fold(f64::INFINITY, f64::min);
        Agreement {
            readings: choice.iter().map(|(reading, _)| *reading).collect(),
            phase: choice[0].1,
            spread: phases.fold(0.0, f64::max) / least - 1.0,
        }
    };
    let all = choices.into_iter().map(agreement);
    all.filter(|one| one.spread <= ROUNDED).collect()
}

fn doubt(all: &[Emf], agreements: &[Agreement], shape: EmfShape) -> Diagnostic {
    let told: Vec<String> = agreements
        .iter()
        .map(|one| told(all, &one.readings))
        .collect();
    catalogue::bases_in_doubt(&parts(all), &told, &forms(&all[0], shape))
}

fn parts<'a>(all: &'a [Emf]) -> Vec<&'a Part> {
    all.iter().map(|stated| &stated.given.part).collect()
}

/// `` `speed_constant` as `block_mean` and `torque_constant` as `block_mean` ``.
fn told(all: &[Emf], readings: &[Reading]) -> String {
    let told = all.iter().zip(readings).map(|(stated, reading)| {
        let field = stated.given.part.field;
        format!("`{field}` as `{}`", reading.words())
    });
    told.collect::<Vec<_>>().join(" and ")
}
