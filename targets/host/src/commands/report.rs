//! `hexagen report`: the result table and the page of one motor.

use crate::cli::{Bar, Failure, print_blocks, print_json, print_text};
use crate::render;
use clap::Args;
use hexagen_lab::report::{results_blocks, results_page};
use hexagen_lab::results::{PAPER_MOTOR, Plan};
use hexagen_lab::verification::mismatches;
use std::path::PathBuf;

/// Default folder of the page.
pub(super) const FOLDER: &str = "target/hexagen";

/// Options of `report`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// Motor file, or name of a library motor [default: the 660 W motor of the paper]
    #[arg(value_name = "MOTOR")]
    pub motor: Option<String>,
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
/// No such motor, diagnostics, or a page that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from(FOLDER));
    let plan = Plan::of(options.motor.as_deref().unwrap_or(PAPER_MOTOR))?;
    // An unwritable folder is reported before the long run.
    render::prepare_folder(&folder)?;
    let (data, checked) = plan.run(&Bar::default())?;
    let page = results_page(&data);
    let path = render::write(&page, &folder)?;
    if options.json {
        print_json(&page)?;
    } else {
        print_text(&page.title)?;
        print_blocks(&page.opening)?;
        print_blocks(&results_blocks(&data))?;
        print_text(&format!("Page: {}", path.display()))?;
    }
    mismatches(&checked).map_or(Ok(()), |lines| Err(Failure::Check(lines)))
}
