//! `hexagen compare`: fixed against floating point, per controller and word length; without a motor, words of 16 bits
//! against one format for the whole library.

mod library;
mod print;

use super::accuracy::{FigureDifference, OneStep, SideBySide, differences, one_step, side_by_side};
use super::results::SPEEDS;
use super::robustness;
use crate::cli::{
    Failure, PlantArguments, SelectedMotor, Selection, print_json, spinner, write_file,
};
use crate::report::Robustness;
use clap::Args;
use hexagen_lab::closed_loop::{Trip, measure};
use hexagen_lab::engine::{EngineKind, Model, Prepared};
use serde::Serialize;
use std::path::PathBuf;

/// Word lengths that are compared.
pub const WORDS: [u32; 2] = [32, 16];

/// Options of `compare`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor file, or name of a library motor. Without one: words of 16 bits against one 16-bit format for the whole
    /// library
    #[arg(value_name = "MOTOR")]
    pub motor: Option<String>,
    /// Controller variant, whose figures of merit are printed one by one; or `all` [default: all]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]", requires = "motor")]
    pub controller: Option<Selection>,
    /// Run controllers on plants that differ from the motor file instead: R, L, k_b +-30 %, bus -10 %,
    /// dead time 0 to 2 us, Hall sensors +-5 degrees off, 10- and 12-bit ADCs with offset. The plant
    /// options then say what all of these plants have in common
    #[arg(long, requires = "motor")]
    pub robustness: bool,
    /// Write the sheet of --robustness, one row per controller, disturbance and speed
    #[arg(long, value_name = "FILE", requires = "robustness")]
    pub csv: Option<PathBuf>,
    /// What the plant differs in
    #[command(flatten)]
    pub plant: PlantArguments,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// One controller at one word length.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Controller variant.
    pub controller: String,
    /// Word length in bits.
    pub word: u32,
    /// Why it does not generate.
    pub refused: Option<String>,
    /// What it computes otherwise.
    #[serde(flatten)]
    pub accuracy: Option<Accuracy>,
}

/// Distances of fixed from floating point.
#[derive(Clone, Debug, Serialize)]
pub struct Accuracy {
    /// What ran the fixed-point program in the closed loops.
    pub engine: EngineKind,
    /// One step from the same state.
    pub one_step: OneStep,
    /// How often errors of which size were seen in phases a and b: equal parts of the range from the negative to the
    /// positive bound.
    pub histogram: Vec<u64>,
    /// Closed loops, per speed.
    pub closed_loop: Vec<AtSpeed>,
}

impl Accuracy {
    /// The figure of merit of the closed loops that differs most, by what may differ, and its speed in rpm.
    pub fn furthest(&self) -> Option<(&FigureDifference, f64)> {
        let figures = self.closed_loop.iter();
        let figures = figures.flat_map(|at| at.figures.iter().map(move |figure| (figure, at.rpm)));
        figures.max_by(|(one, _), (other, _)| one.of_allowance.total_cmp(&other.of_allowance))
    }
}

/// Figures of merit at one speed.
#[derive(Clone, Debug, Serialize)]
pub struct AtSpeed {
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// What tripped the fixed-point drive; then it has no figures of merit.
    pub tripped: Option<Trip>,
    /// Every figure of merit.
    pub figures: Vec<FigureDifference>,
}

/// One drive beside the ideal model at rated torque, as far as its set-point reaches, and each of the speeds in rpm.
///
/// # Errors
/// A plant option out of range.
pub fn at_speeds(
    drive: &Prepared,
    plant: &PlantArguments,
) -> Result<Vec<(f64, SideBySide)>, Failure> {
    let (params, torque) = (plant.plant(drive)?, drive.demand());
    let set_point = plant.set_point(drive, torque);
    let speeds = SPEEDS.map(|part| part * drive.rated_rpm());
    let measured = speeds.into_iter().map(|rpm| {
        let run = plant.run(drive, rpm, torque);
        Ok((rpm, side_by_side(drive, &params, &run, set_point)?))
    });
    measured.collect()
}

/// Accuracy of one drive at rated torque, as far as its set-point reaches.
///
/// # Errors
/// A plant option out of range.
pub fn accuracy(drive: &Prepared, plant: &PlantArguments) -> Result<Accuracy, Failure> {
    let (params, torque) = (plant.plant(drive)?, drive.demand());
    let set_point = plant.set_point(drive, torque);
    let measured = at_speeds(drive, plant)?;
    let closed_loop = measured.iter().map(|(rpm, both)| {
        let run = plant.run(drive, *rpm, torque);
        let alone = measure(&params, &run, drive.maker(Model::Ideal, set_point))?;
        let figures = differences(&both.fixed.figures, &both.ideal.figures, &alone.figures);
        Ok(AtSpeed {
            rpm: *rpm,
            tripped: both.fixed.tripped,
            figures,
        })
    });
    let closed_loop = closed_loop.collect::<Result<_, Failure>>()?;
    let (one_step, histogram) = one_step(drive, measured.iter().map(|(_, both)| both));
    Ok(Accuracy {
        engine: drive.engine_kind(),
        one_step,
        histogram,
        closed_loop,
    })
}

/// Compares every selected controller at every word length.
///
/// # Errors
/// No such motor, an unreadable file, or a plant option out of range. A controller that does not
/// generate is a row with the reason.
pub fn collect(
    motor: &str,
    selection: &Selection,
    plant: &PlantArguments,
) -> Result<Vec<Row>, Failure> {
    let motor = SelectedMotor::find(motor, plant)?;
    // What does not generate at any word length is no matter of accuracy.
    match selection {
        Selection::All => motor.prepare(None)?,
        Selection::One(variant) => motor.prepare_for_torque(Some(variant))?,
    };
    let mut rows = Vec::new();
    for variant in &selection.variants() {
        for word in WORDS {
            let Some(controller) = with_word(variant, word) else {
                continue;
            };
            let (controller, refused, accuracy) = match motor.prepare(Some(&controller)) {
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

/// The variant with a word length; none where it names another one itself.
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

/// Runs the command.
///
/// # Errors
/// As [`collect`].
pub fn run(options: &Options) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Comparison<'a> {
        motor: &'a str,
        rows: &'a [Row],
    }
    let Some(motor) = &options.motor else {
        return library::run(&options.plant, options.json);
    };
    let all = Selection::All;
    let selection = options.controller.as_ref().unwrap_or(&all);
    if options.robustness {
        return run_robustness(options, motor, selection);
    }
    let progress = spinner("comparing");
    let rows = collect(motor, selection, &options.plant);
    progress.finish_and_clear();
    let rows = rows?;
    if options.json {
        print_json(&Comparison { motor, rows: &rows })?;
    } else {
        print::rows(&rows, matches!(selection, Selection::One(_)))?;
    }
    within_bounds(&rows)
}

/// Whether no error was larger than what is proven of it.
fn within_bounds(rows: &[Row]) -> Result<(), Failure> {
    let beyond = rows.iter().filter_map(|row| {
        let one_step = &row.accuracy.as_ref()?.one_step;
        // Also where there is no number at all.
        (!one_step.is_within_bounds()).then(|| {
            format!(
                "{}: errors of {:e} V, of {} and (limited) {} timer counts were seen, and proven are at most {:e} V, {} and {}",
                row.controller,
                one_step.largest_v,
                one_step.duty_largest_counts,
                one_step.duty_limited_counts,
                one_step.bound_v,
                one_step.duty_bound_counts,
                one_step.duty_limited_bound_counts,
            )
        })
    });
    let beyond: Vec<String> = beyond.collect();
    if beyond.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(beyond.join("\n")))
    }
}

/// The robustness sheet instead.
fn run_robustness(options: &Options, motor: &str, selection: &Selection) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Sheet<'a> {
        motor: &'a str,
        #[serde(flatten)]
        robustness: Robustness,
    }
    let sheet = robustness::collect(motor, &selection.variants(), &options.plant)?;
    if let Some(path) = &options.csv {
        let contents = robustness::csv(&sheet).map_err(|error| Failure::Write {
            path: path.clone(),
            reason: error.to_string(),
        })?;
        write_file(path, &contents)?;
    }
    if options.json {
        return print_json(&Sheet {
            motor,
            robustness: sheet,
        });
    }
    robustness::print(&sheet)
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
