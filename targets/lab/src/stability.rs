//! Runs on both sides of the edges of a loop's stable range, judged by the criterion of the
//! robustness sheet.

use crate::LabError;
use crate::closed_loop::RunOptions;
use crate::engine::{Prepared, plant_of, run_of};
use crate::robustness::{DisturbedFigures, Outcome, measured};
use hexagen_codegen::laws::{StableRange, stable_range};
use hexagen_codegen::spec::EmfSource;
use rayon::prelude::*;

/// Stable range computed from the closed-loop poles, and simulated runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    /// True over nominal resistance and inductance; 0.1 and 10 are the ends of the search.
    pub range: StableRange,
    /// Simulated runs with one parameter varied.
    pub checks: Vec<StabilityCheck>,
}

/// A simulated run on a plant with one varied parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityCheck {
    /// The parameter.
    pub parameter: Parameter,
    /// Its true over its nominal value.
    pub factor: f64,
    /// Speed in rpm.
    pub rpm: f64,
    /// RMS torque ripple in percent of the mean.
    pub ripple_rms_pct: Option<f64>,
    /// Whether the run is stable.
    pub stable: bool,
}

/// A motor parameter in the controller's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Phase inductance.
    Inductance,
    /// Phase resistance.
    Resistance,
}

/// Range of simulated edges, in true over nominal value. No motor is farther off, and a loop with
/// many times the inductance diverges slowly, which the criterion does not detect; the search for
/// the range itself ends at 0.1 and 10.
pub const EDGES: (f64, f64) = (0.2, 4.0);

/// Relative distance of a run from an edge, inside and outside.
pub const DISTANCE: f64 = 0.07;

/// Speed relative to the rated one: so low that a loop near its edge settles between commutations.
const SPEED: f64 = 0.1;

/// Electrical start angle in radians.
const START: f64 = 0.1;

/// True over nominal value just inside and just outside of each simulated edge.
pub fn sides((low, high): (f64, f64)) -> Vec<[f64; 2]> {
    [(low, 1.0 + DISTANCE), (high, 1.0 - DISTANCE)]
        .into_iter()
        .filter(|(edge, _)| (EDGES.0..EDGES.1).contains(edge))
        .map(|(edge, inward)| [edge * inward, edge / inward])
        .collect()
}

/// Runs of the page: on both sides of the edges, and half-way (by ratio) from the nominal value to
/// each end of the simulated range.
fn factors((low, high): (f64, f64)) -> Vec<f64> {
    let inside = [low.max(EDGES.0).sqrt(), high.min(EDGES.1).sqrt()];
    sides((low, high))
        .into_iter()
        .flatten()
        .chain(inside)
        .collect()
}

/// Run of a drive at its rated torque on a motor with scaled resistance and inductance.
///
/// # Errors
/// A plant parameter out of range.
pub fn run_off(
    drive: &Prepared,
    resistance: f64,
    inductance: f64,
) -> Result<DisturbedFigures, LabError> {
    let torque = drive.demand();
    let run = RunOptions {
        starts: vec![START],
        ..run_of(&drive.spec, SPEED * drive.spec.motor.rated_speed, torque)
    };
    let plant = plant_of(&drive.spec).scaled(resistance, inductance, 1.0);
    let found = measured(drive, &plant, &run, drive.set_point(torque), torque)?;
    // A controller with a modulator is judged by its own swing.
    Ok(found.judged(&found))
}

/// The stable range of a linear loop, and with an estimated EMF, whose range is narrow, runs on both sides of its edges;
/// `None` for other loops.
///
/// # Errors
/// A plant parameter out of range.
pub fn checked(drive: &Prepared) -> Result<Option<Stability>, LabError> {
    let Some(range) = stable_range(&drive.spec) else {
        return Ok(None);
    };
    if drive.spec.controller.common().emf != EmfSource::Estimated {
        let checks = vec![];
        return Ok(Some(Stability { range, checks }));
    }
    let inductances = factors(range.inductance);
    let resistances = factors(range.resistance);
    let runs: Vec<(Parameter, f64)> = inductances
        .into_iter()
        .map(|factor| (Parameter::Inductance, factor))
        .chain(
            resistances
                .into_iter()
                .map(|factor| (Parameter::Resistance, factor)),
        )
        .collect();
    let checks = runs
        .into_par_iter()
        .map(|(parameter, factor)| {
            let figures = match parameter {
                Parameter::Inductance => run_off(drive, 1.0, factor)?,
                Parameter::Resistance => run_off(drive, factor, 1.0)?,
            };
            Ok(StabilityCheck {
                parameter,
                factor,
                rpm: SPEED * drive.rated_rpm(),
                ripple_rms_pct: figures.ripple_rms_pct,
                stable: figures.outcome == Outcome::Runs,
            })
        })
        .collect::<Result<Vec<_>, LabError>>()?;
    Ok(Some(Stability { range, checks }))
}
