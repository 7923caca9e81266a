//! The page around the sections: title, style, contents, order.

use super::highlight::Highlighter;
use super::plot::palette;
use super::sections::{header, numbers, results, spectra, stability, texts, torque_speed, waves};
use super::{ReportData, ReportError};
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Style sheet, without the rules for plots on a dark ground.
const STYLE: &str = include_str!("page.css");

/// One section: the name its link has, its title, its content.
struct Section {
    id: &'static str,
    title: &'static str,
    content: Markup,
}

/// The whole page.
///
/// # Errors
/// A plot that cannot be drawn or code that cannot be highlighted.
pub fn render(data: &ReportData) -> Result<String, ReportError> {
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
        section("errors", "Fixed point against float", numbers::errors(data)),
        section("stability", "Stable ranges", stability::section(data)?),
        section("code", "Emitted code", texts::code(data, &highlighter)?),
        section("data-sheet", "Data sheet", texts::data_sheet(data)),
        section("spec", "Specification", texts::spec(data)),
    ];
    let title = header::title(data);
    let dark = format!(
        "@media (prefers-color-scheme: dark) {{\n{}}}",
        palette::dark_rules()
    );
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(dark)) }
            }
            body {
                header {
                    (header::heading(data))
                    nav {
                        @for section in &sections {
                            a href={ "#" (section.id) } { (section.title) }
                        }
                    }
                }
                main {
                    @for section in &sections {
                        section id=(section.id) {
                            h2 { (section.title) }
                            (section.content)
                        }
                    }
                }
                footer { p { "Written by " (data.generator) "." } }
            }
        }
    };
    Ok(page.into_string())
}
