//! The study of faults: a drive in closed loop while one thing breaks at a time, and whether it
//! trips.
//!
//! Each class of [`classes`] runs at every operating point of [`points`]: two speeds, two torques,
//! motoring and braking, with the shaft held. What breaks does so at one instant, after settling;
//! the deviations of sound drives are there from the start.

mod class;
mod defect;
mod outcome;
mod run;
mod signals;

pub use class::{FaultClass, Part, classes};
pub use defect::{CurrentDefect, Defect, PlantDefect, SignalDefect};
pub use outcome::{CauseCount, FaultRow, FaultStudy, Seen, Totals};
pub use run::{OperatingPoint, points};

use crate::engine::{Model, PlantOptions, Prepared};
use crate::{LabError, Progress};
use rayon::prelude::*;
use run::{Bench, Run};

/// Runs every class of faults at every operating point; `torque` in newton metres is the greater
/// one of these.
///
/// # Errors
/// A free shaft, or a plant option out of range.
pub fn study(
    drive: &Prepared,
    model: Model,
    options: &PlantOptions,
    torque: f64,
    progress: &dyn Progress,
) -> Result<FaultStudy, LabError> {
    let bench = Bench::new(drive, model, options)?;
    let classes = classes(&drive.spec);
    let points = points(drive, torque);
    let runs: Vec<(&FaultClass, usize)> = classes
        .iter()
        .flat_map(|class| (0..points.len()).map(move |place| (class, place)))
        .collect();
    progress.begin("breaking", runs.len() as u64);
    let runs = runs.par_iter().map(|&(class, place)| {
        let run = bench.run(class, points[place], place);
        progress.advance(1);
        run
    });
    let runs = runs.collect::<Result<Vec<Run>, _>>()?;
    let rows: Vec<&[Run]> = runs.chunks(points.len()).collect();
    Ok(FaultStudy::of(&drive.spec, points, &classes, &rows))
}
