//! `hexagen compare`: fixed against floating point, per controller and word length.

use super::accuracy::{MeritDifference, OneStep, SideBySide, differences, side_by_side};
use super::results::SPEEDS;
use super::robustness;
use crate::cli::{
    Failure, PlantArguments, SelectedMotor, Selection, TextTable, print_json, print_text,
    significant, spinner, write_file,
};
use crate::closed_loop::measure;
use crate::engine::{EngineKind, Model, Prepared};
use crate::report::Robustness;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Word lengths that are compared.
const WORDS: [u32; 2] = [32, 16];

/// Options of `compare`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor file, or name of a library motor
    #[arg(value_name = "MOTOR")]
    pub motor: String,
    /// Controller variant, or `all` [default: the motor file's; with --robustness all]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]")]
    pub controller: Option<Selection>,
    /// Run controllers on plants that differ from the motor file instead: R, L, k_b +-30 %, bus -10 %,
    /// dead time 0 to 2 us, Hall sensors +-5 degrees off, 10- and 12-bit ADCs with offset. The plant
    /// options then say what all of these plants have in common
    #[arg(long)]
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
    /// Closed loops, per speed.
    pub closed_loop: Vec<AtSpeed>,
}

/// Merits at one speed.
#[derive(Clone, Debug, Serialize)]
pub struct AtSpeed {
    /// Mechanical speed, rpm.
    pub rpm: f64,
    /// Every merit.
    pub merits: Vec<MeritDifference>,
}

/// Accuracy of one drive at rated torque, as far as its set-point reaches.
///
/// # Errors
/// A plant option out of range.
pub fn accuracy(drive: &Prepared, plant: &PlantArguments) -> Result<Accuracy, Failure> {
    let (params, torque) = (plant.plant(drive)?, drive.demand());
    let set_point = plant.set_point(drive, torque);
    let speeds = SPEEDS.map(|part| part * drive.rated_rpm());
    let runs = speeds.map(|rpm| plant.run(drive, rpm, torque));
    let mut closed_loop = Vec::new();
    let mut measured = Vec::new();
    for (rpm, run) in speeds.into_iter().zip(&runs) {
        let both = side_by_side(drive, &params, run, set_point)?;
        let alone = measure(&params, run, drive.maker(Model::Ideal, set_point))?;
        closed_loop.push(AtSpeed {
            rpm,
            merits: differences(&both.fixed.merits, &both.ideal.merits, &alone.merits),
        });
        measured.push(both);
    }
    Ok(Accuracy {
        engine: drive.engine_kind(),
        one_step: SideBySide::one_step(&measured),
        closed_loop,
    })
}

/// Compares every selected controller at every word length.
///
/// # Errors
/// No such motor, an unreadable file, or a plant option out of range. A controller that does not
/// generate is a row with the reason.
pub fn collect(options: &Options) -> Result<Vec<Row>, Failure> {
    let motor = SelectedMotor::find(&options.motor, &options.plant)?;
    let variants = match &options.controller {
        None => vec!["pdcc".to_owned()],
        Some(selection) => selection.variants(),
    };
    // What does not generate at any word length is no matter of accuracy.
    motor.prepare_for_torque(variants.first().map(String::as_str))?;
    let mut rows = Vec::new();
    for variant in &variants {
        for word in WORDS {
            let Some(controller) = with_word(variant, word) else {
                continue;
            };
            let (refused, accuracy) = match motor.prepare(Some(&controller)) {
                Ok(drive) => (None, Some(accuracy(&drive, &options.plant)?)),
                Err(failure) => (Some(failure.to_string()), None),
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
fn with_word(variant: &str, word: u32) -> Option<String> {
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
        rows: Vec<Row>,
    }
    if options.robustness {
        return run_robustness(options);
    }
    let progress = spinner("comparing");
    let rows = collect(options);
    progress.finish_and_clear();
    let rows = rows?;
    if options.json {
        return print_json(&Comparison {
            motor: &options.motor,
            rows,
        });
    }
    print_text(&one_step_table(&rows))?;
    for row in &rows {
        let Some(accuracy) = &row.accuracy else {
            continue;
        };
        for at in &accuracy.closed_loop {
            print_text(&format!(
                "\n{}, {:.0} rpm ({}):",
                row.controller,
                at.rpm,
                accuracy.engine.name()
            ))?;
            print_text(&merit_table(&at.merits))?;
        }
    }
    print_text(
        "\nideal: on the words that the fixed-point drive read and from its state; alone: in a loop of its own.",
    )
}

/// The robustness sheet instead.
fn run_robustness(options: &Options) -> Result<(), Failure> {
    #[derive(Serialize)]
    struct Sheet<'a> {
        motor: &'a str,
        #[serde(flatten)]
        robustness: Robustness,
    }
    let all = Selection::All;
    let variants = options.controller.as_ref().unwrap_or(&all).variants();
    let (motor, plant) = (&options.motor, &options.plant);
    let sheet = robustness::collect(motor, &variants, plant)?;
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

fn one_step_table(rows: &[Row]) -> String {
    let mut table = TextTable::new(
        1,
        [
            "controller",
            "word",
            "steps",
            "ties",
            "u max V",
            "u rms V",
            "duty max",
            "duty rms",
            "SNR dB",
            "equal %",
        ],
    );
    for row in rows {
        let Some(Accuracy { one_step, .. }) = &row.accuracy else {
            let reason = row.refused.clone().unwrap_or_default();
            table.row([row.controller.clone(), row.word.to_string(), reason]);
            continue;
        };
        table.row([
            row.controller.clone(),
            row.word.to_string(),
            one_step.steps.to_string(),
            one_step.other_decisions.to_string(),
            significant(one_step.u_largest_v, 3),
            significant(one_step.u_rms_v, 3),
            significant(one_step.duty_largest_counts, 3),
            significant(one_step.duty_rms_counts, 3),
            format!("{:.1}", one_step.snr_db),
            format!("{:.2}", one_step.equal_compares_pct),
        ]);
    }
    table.render()
}

fn merit_table(merits: &[MeritDifference]) -> String {
    let mut table = TextTable::new(1, ["merit", "fixed", "ideal", "alone", "unit", "close"]);
    for merit in merits {
        table.row([
            merit.merit.to_owned(),
            significant(merit.fixed, 5),
            significant(merit.ideal, 5),
            significant(merit.ideal_alone, 5),
            merit.unit.to_owned(),
            if merit.close { "yes" } else { "NO" }.to_owned(),
        ]);
    }
    table.render()
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
