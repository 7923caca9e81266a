//! Emitted texts: code, data sheet, specification.

use super::nothing;
use crate::report::highlight::Highlighter;
use crate::report::{GeneratedTexts, ReportData, ReportError, Variant};
use maud::{Markup, html};

fn generated(data: &ReportData) -> impl Iterator<Item = (&Variant, &GeneratedTexts)> {
    data.variants
        .iter()
        .filter_map(|variant| Some((variant, variant.generated.as_ref()?)))
}

/// Emitted Rust, highlighted, folded.
///
/// # Errors
/// Code that cannot be highlighted.
pub fn code(data: &ReportData, highlighter: &Highlighter) -> Result<Markup, ReportError> {
    let mut blocks = Vec::new();
    for (variant, texts) in generated(data) {
        let block = highlighter.rust(&texts.rust)?;
        blocks.push((variant, texts.rust.lines().count(), block));
    }
    if blocks.is_empty() {
        return Ok(nothing("emitted code"));
    }
    Ok(html! {
        @for (variant, lines, block) in blocks {
            details {
                summary { (variant.label) ", " (lines) " lines of Rust" }
                div { (block) }
            }
        }
    })
}

/// Data sheets, folded.
pub fn data_sheet(data: &ReportData) -> Markup {
    plain(data, "data sheet", |texts| &texts.data_sheet)
}

/// Normalised specifications, folded.
pub fn spec(data: &ReportData) -> Markup {
    plain(data, "specification", |texts| &texts.spec_toml)
}

fn plain(data: &ReportData, what: &str, of: fn(&GeneratedTexts) -> &str) -> Markup {
    let shown: Vec<_> = generated(data)
        .filter(|(_, texts)| !of(texts).trim().is_empty())
        .collect();
    if shown.is_empty() {
        return nothing(what);
    }
    html! {
        @for (variant, texts) in shown {
            details {
                summary { (variant.label) }
                pre { (of(texts).trim_end()) }
            }
        }
    }
}
