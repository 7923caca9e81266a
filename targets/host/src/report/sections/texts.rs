//! Emitted texts: code, data sheet, specification.

use super::nothing;
use crate::report::ReportError;
use crate::report::highlight::Highlighter;
use hexagen_lab::results::{GeneratedTexts, Results, Variant};
use maud::{Markup, PreEscaped, html};
use pulldown_cmark::html::push_html;
use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd};

fn generated(data: &Results) -> impl Iterator<Item = (&Variant, &GeneratedTexts)> {
    data.variants
        .iter()
        .filter_map(|variant| Some((variant, variant.generated.as_ref()?)))
}

/// Emitted Rust, highlighted, folded.
///
/// # Errors
/// Code that cannot be highlighted.
pub fn code(data: &Results, highlighter: &Highlighter) -> Result<Markup, ReportError> {
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
pub fn data_sheet(data: &Results) -> Markup {
    folded(data, "data sheet", |texts| {
        let sheet = texts.data_sheet.trim();
        (!sheet.is_empty()).then(|| html! { div.sheet { (markdown(sheet)) } })
    })
}

/// Normalised specifications, folded.
pub fn spec(data: &Results) -> Markup {
    folded(data, "specification", |texts| {
        let spec = texts.spec_toml.trim();
        (!spec.is_empty()).then(|| html! { pre { (spec) } })
    })
}

fn folded(
    data: &Results,
    what: &str,
    content: impl Fn(&GeneratedTexts) -> Option<Markup>,
) -> Markup {
    let shown: Vec<_> = generated(data)
        .filter_map(|(variant, texts)| Some((variant, content(texts)?)))
        .collect();
    if shown.is_empty() {
        return nothing(what);
    }
    html! {
        @for (variant, content) in shown {
            details {
                summary { (variant.label) }
                (content)
            }
        }
    }
}

/// Levels by which headings of a text go down, to stay below the section's own.
const BELOW: usize = 2;

/// Markdown as HTML. HTML inside of it is shown as text, so that the page stays its own.
fn markdown(text: &str) -> Markup {
    let lower = |level: HeadingLevel| {
        HeadingLevel::try_from(level as usize + BELOW).unwrap_or(HeadingLevel::H6)
    };
    let events = Parser::new_ext(text, Options::ENABLE_TABLES).map(|event| match event {
        Event::Start(Tag::Heading {
            level,
            id,
            classes,
            attrs,
        }) => Event::Start(Tag::Heading {
            level: lower(level),
            id,
            classes,
            attrs,
        }),
        Event::End(TagEnd::Heading(level)) => Event::End(TagEnd::Heading(lower(level))),
        Event::Html(html) | Event::InlineHtml(html) => Event::Text(html),
        other => other,
    });
    let mut html = String::new();
    push_html(&mut html, events);
    PreEscaped(html)
}

#[cfg(test)]
mod tests {
    use super::markdown;

    #[test]
    fn markdown_keeps_to_its_place() {
        let html =
            markdown("# Sheet\n\nof <b>one</b> & all\n\n| a | b |\n|---|---|\n| 1 | `x < y` |\n");
        let html = html.into_string();
        assert!(html.contains("<h3>Sheet</h3>"), "{html}");
        assert!(
            html.contains("of &lt;b&gt;one&lt;/b&gt; &amp; all"),
            "{html}"
        );
        assert!(html.contains("<td><code>x &lt; y</code></td>"), "{html}");
    }
}
