//! `hexagen compare`: fixed against floating point, per controller and word length; without a motor,
//! 16-bit formats per motor against one format for the whole library.

mod library;
mod print;

use crate::cli::{
    Bar, Failure, PlantArguments, Selection, print_blocks, print_json, spinner, write_file,
};
use clap::Args;
use hexagen_lab::accuracy::{Row, compare};
use hexagen_lab::advise::DEFAULT;
use hexagen_lab::engine::SelectedMotor;
use hexagen_lab::report::robustness_blocks;
use hexagen_lab::robustness::{Robustness, csv, robustness};
use serde::Serialize;
use std::path::PathBuf;

/// Options of `compare`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor file, or name of a library motor. Without one: 16-bit formats per motor against one
    /// format for the whole library
    #[arg(value_name = "MOTOR")]
    pub motor: Option<String>,
    /// Controller variant, with all figures of merit, or `all` [default: all]
    #[arg(long, value_name = "NAME[:KEY=VALUE,…]", requires = "motor")]
    pub controller: Option<Selection>,
    /// Run controllers on disturbed plants instead: R x 0.5 and x 2, L x 0.75 and x 1.3, k_b x 0.8 and x 1.2, bus -15 %, dead time 0 to 2 us,
    /// Hall sensors +-5 degrees off, 10- and 12-bit ADCs with offset, current sensors 2 % apart or with
    /// noise, and, where the board converts one current after the other, both at once. The plant
    /// options apply to all of these plants
    #[arg(long, requires = "motor")]
    pub robustness: bool,
    /// Write the table of --robustness, one row per controller, disturbance and speed
    #[arg(long, value_name = "FILE", requires = "robustness")]
    pub csv: Option<PathBuf>,
    /// Changes of the plant
    #[command(flatten)]
    pub plant: PlantArguments,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// No such motor, an unreadable file, or a plant option out of range.
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
    let rows = compare(motor, &selection.variants(), &options.plant.options());
    progress.finish_and_clear();
    let rows = rows.map_err(|error| options.plant.blame(error))?;
    if options.json {
        print_json(&Comparison { motor, rows: &rows })?;
    } else {
        match selection {
            Selection::One(variant) => print::of_one(&rows, variant)?,
            Selection::All => {
                let motor = SelectedMotor::find(motor, &options.plant.options())?;
                let own = motor.ast.controller.field("kind");
                let own = own.map_or(DEFAULT.to_owned(), |own| own.value.to_string());
                print::of_all(&rows, &own)?;
            }
        }
    }
    within_bounds(&rows)
}

/// Checks all errors against their proven bounds.
fn within_bounds(rows: &[Row]) -> Result<(), Failure> {
    let beyond = rows.iter().filter_map(|row| {
        let one_step = &row.accuracy.as_ref()?.one_step;
        // NaN counts as out of bounds.
        (!one_step.is_within_bounds()).then(|| {
            format!(
                "{}: errors of {:e} V, {} and (limited) {} timer counts exceed the proven bounds of {:e} V, {} and {}",
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
    let sheet = robustness(
        motor,
        &selection.variants(),
        &options.plant.options(),
        &Bar::default(),
    )
    .map_err(|error| options.plant.blame(error))?;
    if let Some(path) = &options.csv {
        let contents = csv(&sheet).map_err(|error| Failure::Write {
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
    print_blocks(&robustness_blocks(&sheet))
}
