//! The report's page: which sections it has, in which order.

use super::ReportError;
use super::document::{Section, document};
use super::highlight::Highlighter;
use super::sections::{
    header, histograms, numbers, results, robustness, spectra, stability, texts, torque_speed,
    waves,
};
use hexagen_lab::results::Results;

/// The whole page.
///
/// # Errors
/// A plot that cannot be drawn or code that cannot be highlighted.
pub fn render(data: &Results) -> Result<String, ReportError> {
    let highlighter = Highlighter::new();
    let section = |id, title, content| Section { id, title, content };
    let sections = [
        section("motor", "Motor and inverter", header::facts(data)),
        section("results", "Results", results::section(data)),
        section("currents", "Phase currents", waves::currents(data)?),
        section(
            "trajectory",
            "Current in the alpha-beta plane",
            waves::trajectories(data)?,
        ),
        section("torque", "Torque", waves::torque(data)?),
        section("spectra", "Spectra", spectra::section(data)?),
        section(
            "torque-speed",
            "Torque over speed",
            torque_speed::section(data)?,
        ),
        section("formats", "Formats", numbers::formats(data)),
        section(
            "errors",
            "Fixed point against float",
            maud::html! { (numbers::errors(data)) (histograms::section(data)?) },
        ),
        section("stability", "Stable ranges", stability::section(data)?),
        section("robustness", "Robustness", robustness::section(data)),
        section("code", "Emitted code", texts::code(data, &highlighter)?),
        section("data-sheet", "Data sheet", texts::data_sheet(data)),
        section("spec", "Specification", texts::spec(data)),
    ];
    let title = header::title(data);
    let heading = header::heading(data);
    Ok(document(&title, &heading, &sections, &data.generator))
}
