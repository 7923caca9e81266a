//! Specification, formulas and code side by side; the script marks what belongs together.

use super::RenderError;
use super::texts::lines;
use hexagen_lab::report::Linked;
use maud::{Markup, html};

/// Three lists of lines. A formula names its lines of code, a field its formulas.
///
/// # Errors
/// An error in the rules of the syntax.
pub fn linked(of: &Linked) -> Result<Markup, RenderError> {
    let code = lines(of.language, &of.code)?;
    Ok(html! {
        div.linked {
            div {
                h3 { "Specification" }
                ul.pane {
                    @for (text, formulas) in &of.fields {
                        li {
                            // Not everything leaves a trace in the code.
                            @if formulas.is_empty() { code { (text) } }
                            @else { button data-formulas=(joined(formulas)) { code { (text) } } }
                        }
                    }
                }
            }
            div {
                h3 { "Formulas" }
                ul.pane {
                    @for (name, text, lines) in &of.formulas {
                        li {
                            button data-lines=(joined(lines)) {
                                code { (name) } ": " (text)
                            }
                        }
                    }
                }
            }
            div {
                h3 { "Emitted code" }
                pre.pane { @for line in code { span.line { (line) } } }
            }
        }
    })
}

/// Places, the ranges among them as from-to: most lines of a formula follow each other.
fn joined(places: &[usize]) -> String {
    let runs = places.chunk_by(|a, b| a + 1 == *b);
    let texts = runs.map(|run| match run {
        [one] => one.to_string(),
        _ => format!("{}-{}", run[0], run[run.len() - 1]),
    });
    texts.collect::<Vec<_>>().join(" ")
}
