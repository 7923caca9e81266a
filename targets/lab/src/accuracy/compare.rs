//! Fixed point against floating point, per controller and word length.

use super::{FigureDifference, OneStep, SideBySide, differences, one_step, side_by_side};
use crate::LabError;
use crate::closed_loop::{Trip, measure};
use crate::engine::{EngineKind, Model, PlantOptions, Prepared, SelectedMotor};
use crate::results::SPEEDS;
use serde::Serialize;

/// Compared word lengths.
pub const WORDS: [u32; 2] = [32, 16];

/// One controller at one word length.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Controller variant.
    pub controller: String,
    /// Word length in bits.
    pub word: u32,
    /// Why it cannot be generated.
    pub refused: Option<String>,
    /// The comparison, if it can.
    #[serde(flatten)]
    pub accuracy: Option<Accuracy>,
}

/// Differences between fixed and floating point.
#[derive(Clone, Debug, Serialize)]
pub struct Accuracy {
    /// Engine of the fixed-point program in closed loop.
    pub engine: EngineKind,
    /// One step from the same state.
    pub one_step: OneStep,
    /// Histogram of the errors of phases a and b: equal parts of the range from the negative to the
    /// positive bound.
    pub histogram: Vec<u64>,
    /// Closed loops, per speed.
    pub closed_loop: Vec<AtSpeed>,
}

impl Accuracy {
    /// The figure of merit with the largest `difference`, relative to the tolerance, and its speed in rpm.
    pub fn furthest(
        &self,
        difference: impl Fn(&FigureDifference) -> f64,
    ) -> Option<(&FigureDifference, f64)> {
        let figures = self.closed_loop.iter();
        let figures = figures.flat_map(|at| at.figures.iter().map(move |figure| (figure, at.rpm)));
        figures.max_by(|(one, _), (other, _)| difference(one).total_cmp(&difference(other)))
    }
}

/// Figures of merit at one speed.
#[derive(Clone, Debug, Serialize)]
pub struct AtSpeed {
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Trip of the fixed-point drive, which then has no figures of merit.
    pub tripped: Option<Trip>,
    /// Every figure of merit.
    pub figures: Vec<FigureDifference>,
}

/// One drive and its ideal model at rated torque (or the most that its set-point limit allows), and
/// speeds in rpm.
///
/// # Errors
/// A plant option out of range.
pub fn at_speeds(
    drive: &Prepared,
    plant: &PlantOptions,
) -> Result<Vec<(f64, SideBySide)>, LabError> {
    let (params, torque) = (plant.plant(drive)?, drive.demand());
    let set_point = plant.set_point(drive, torque);
    let speeds = SPEEDS.map(|part| part * drive.rated_rpm());
    let measured = speeds.into_iter().map(|rpm| {
        let run = plant.run(drive, rpm, torque);
        Ok((rpm, side_by_side(drive, &params, &run, set_point)?))
    });
    measured.collect()
}

/// Accuracy of one drive at rated torque, or the most that its set-point limit allows.
///
/// # Errors
/// A plant option out of range.
pub fn accuracy(drive: &Prepared, plant: &PlantOptions) -> Result<Accuracy, LabError> {
    let (params, torque) = (plant.plant(drive)?, drive.demand());
    let set_point = plant.set_point(drive, torque);
    let measured = at_speeds(drive, plant)?;
    let reference = drive.spec.controller.common().reference;
    let closed_loop = measured.iter().map(|(rpm, both)| {
        let run = plant.run(drive, *rpm, torque);
        let alone = measure(&params, &run, drive.maker(Model::Ideal, set_point))?;
        let figures = differences(
            reference,
            &both.fixed.figures,
            &both.ideal.figures,
            &alone.figures,
        );
        Ok(AtSpeed {
            rpm: *rpm,
            tripped: both.fixed.tripped,
            figures,
        })
    });
    let closed_loop = closed_loop.collect::<Result<_, LabError>>()?;
    let (one_step, histogram) = one_step(drive, measured.iter().map(|(_, both)| both));
    Ok(Accuracy {
        engine: drive.engine_kind(),
        one_step,
        histogram,
        closed_loop,
    })
}

/// Compares controllers at all word lengths.
///
/// # Errors
/// No such motor, an unreadable file, or a plant option out of range. A controller that cannot be
/// generated is a row with the reason.
pub fn compare(
    motor: &str,
    variants: &[String],
    plant: &PlantOptions,
) -> Result<Vec<Row>, LabError> {
    let motor = SelectedMotor::find(motor, plant)?;
    // A variant that fails at every word length has no accuracy.
    match variants {
        [one] => motor.prepare_for_torque(Some(one))?,
        _ => motor.prepare(None)?,
    };
    let mut rows = Vec::new();
    for variant in variants {
        for word in WORDS {
            let Some(controller) = with_word(variant, word) else {
                continue;
            };
            let (controller, refused, accuracy) = match motor.prepare_for_torque(Some(&controller))
            {
                Ok(drive) => {
                    let accuracy = accuracy(&drive, plant)?;
                    (drive.variant, None, Some(accuracy))
                }
                Err(failure) => (controller, Some(failure.to_string()), None),
            };
            rows.push(Row {
                controller,
                word,
                refused,
                accuracy,
            });
        }
    }
    Ok(rows)
}

/// The variant with a word length; `None` if it names another one itself.
pub fn with_word(variant: &str, word: u32) -> Option<String> {
    let options = variant.split_once(':').map_or("", |(_, options)| options);
    let named = options
        .split(',')
        .find_map(|option| option.trim().strip_prefix("word="));
    match named {
        Some(named) => (named.trim() == word.to_string()).then(|| variant.to_owned()),
        None if options.is_empty() => {
            Some(format!("{}:word={word}", variant.trim_end_matches(':')))
        }
        None => Some(format!("{variant},word={word}")),
    }
}

#[cfg(test)]
mod tests {
    use super::with_word;

    #[test]
    fn word_lengths_are_laid_over_variants() {
        let word = |variant, word| with_word(variant, word);
        assert_eq!(word("pdcc", 16).as_deref(), Some("pdcc:word=16"));
        assert_eq!(
            word("pdcc:emf=model", 32).as_deref(),
            Some("pdcc:emf=model,word=32")
        );
        assert_eq!(
            word("pdcc:word=16,emf=model", 16).as_deref(),
            Some("pdcc:word=16,emf=model")
        );
        assert_eq!(word("pdcc:word=16,emf=model", 32), None);
    }
}
