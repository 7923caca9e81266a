//! `hexagen reproduce`: the paper's experiment, its claims and a page with its figures.
//!
//! Both variants of each controller run as generated drives in closed loop on the paper's motor.

use super::report::FOLDER;
use crate::cli::{Bar, Failure, print_blocks, print_json, print_text};
use crate::render;
use clap::Args;
use hexagen_lab::report::{Section, reproduction_blocks, reproduction_page, results_blocks};
use hexagen_lab::reproduction::{Effort, reproduce};
use hexagen_lab::results::Plan;
use std::path::PathBuf;

/// Title of the table of figures.
const EXPECTED: &str = "Measured and expected figures";

/// Options of `reproduce`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// Folder of the page [default: target/hexagen]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the page as one JSON object: its prose, tables and plots
    #[arg(long)]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// Diagnostics, a plant parameter out of range, or a page that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from(FOLDER));
    render::prepare_folder(&folder)?;
    let data = reproduce(&Effort::full(), &Bar::of_long_work())?;
    let table = results_blocks(&Plan::of_paper()?.table(&Bar::of_long_work())?);
    let mut page = reproduction_page(&data);
    page.sections
        .push(Section::new("expected", EXPECTED, table.clone()));
    let path = render::write(&page, &folder)?;
    if options.json {
        return print_json(&page);
    }
    print_blocks(&reproduction_blocks(&data))?;
    print_text(EXPECTED)?;
    print_blocks(&table)?;
    print_text(&format!("Page: {}", path.display()))
}
