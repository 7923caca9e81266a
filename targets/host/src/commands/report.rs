//! `hexagen report`: the result table and the page of one motor.

use crate::cli::{
    Bar, Failure, note, paragraph, print_json, print_table, print_text, print_verdict,
    verdict_lines,
};
use crate::render;
use clap::Args;
use hexagen_lab::judgement::Judgement;
use hexagen_lab::report::{results_page, variants_table, verdict};
use hexagen_lab::results::{PAPER_MOTOR, Plan, Results};
use hexagen_lab::verification::{Checked, mismatches};
use std::path::{Path, PathBuf};

/// Default folder of the page.
pub(super) const FOLDER: &str = "target/hexagen";

/// Options of `report`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// Motor file, or name of a library motor [default: the 660 W motor of the paper]
    #[arg(value_name = "MOTOR")]
    pub motor: Option<String>,
    /// Board, a name of the library or a file [default: the motor file's]
    #[arg(long, value_name = "BOARD")]
    pub board: Option<String>,
    /// What is printed and written.
    #[command(flatten)]
    pub output: Output,
}

/// What a report prints and writes.
#[derive(Args, Clone, Debug)]
pub struct Output {
    /// Folder of the page [default: target/hexagen]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the table of all variants, best first
    #[arg(long)]
    pub all: bool,
    /// Print the page as one JSON object: its prose, tables and plots
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// No such motor, diagnostics, a page that cannot be written, or a drive that does not work.
pub fn run(options: &Options) -> Result<(), Failure> {
    let Output { out, all, json } = &options.output;
    let folder = out.clone().unwrap_or_else(|| PathBuf::from(FOLDER));
    let motor = options.motor.as_deref().unwrap_or(PAPER_MOTOR);
    let plan = Plan::of(motor, options.board.as_deref())?;
    // An unwritable folder is reported before the long run.
    render::prepare_folder(&folder)?;
    let (data, checked) = plan.run(&Bar::of_long_work())?;
    let page = results_page(&data);
    let path = render::write(&page, &folder)?;
    if *json {
        print_json(&page)?;
    } else {
        for warning in data.own.iter().flat_map(|own| &own.judgement.warnings) {
            note(warning);
        }
        print_verdict(&lines(&data, &path))?;
        if *all {
            print_table(&variants_table(&data))?;
            for text in &data.notes {
                print_text(&paragraph(text))?;
            }
        }
    }
    outcome(data.own.as_ref().map(|own| &own.judgement), &checked)
}

/// Fails as `check` does for the same drive, and where generated code differs from its reference.
fn outcome(judgement: Option<&Judgement>, checked: &[Checked]) -> Result<(), Failure> {
    let fails = judgement.and_then(Judgement::failure);
    let failures: Vec<String> = fails.into_iter().chain(mismatches(checked)).collect();
    if failures.is_empty() {
        Ok(())
    } else {
        Err(Failure::Check(failures.join("\n")))
    }
}

/// Most lines of the verdict.
const MOST: usize = 12;

/// The verdict in lines of at most 100 columns.
fn lines(data: &Results, page: &Path) -> Vec<String> {
    let page = ("page", page.display().to_string());
    let (verdict, rows) = verdict(data).unwrap_or_default();
    // Texts of pages keep numbers and units together.
    let plain = |text: &str| text.replace('\u{a0}', " ");
    let head = format!("{}: {}", data.file, plain(&verdict));
    let rows = rows.into_iter().chain([page]);
    let rows = rows.map(|(name, text)| match name {
        "furthest" => (name, format!("{} (--all lists them)", plain(&text))),
        _ => (name, plain(&text)),
    });
    verdict_lines(&head, &rows.collect::<Vec<_>>(), MOST, "on the page")
}
