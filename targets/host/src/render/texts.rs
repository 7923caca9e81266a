//! Texts of other languages as HTML: Markdown, and source with a class per kind of token.

use super::RenderError;
use maud::{Markup, PreEscaped, html};
use pulldown_cmark::html::push_html;
use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd};
use std::sync::LazyLock;
use syntect::html::{ClassStyle, ClassedHTMLGenerator};
use syntect::parsing::SyntaxSet;
use syntect::util::LinesWithEndings;

/// Prefix of the classes, as the style sheet has it.
const STYLE: ClassStyle = ClassStyle::SpacedPrefixed { prefix: "s-" };

static SYNTAXES: LazyLock<SyntaxSet> = LazyLock::new(SyntaxSet::load_defaults_newlines);

/// Source as a code block, coloured where its language is known.
///
/// # Errors
/// An error in the rules of the syntax.
pub fn code(language: &str, source: &str) -> Result<Markup, RenderError> {
    let Some(syntax) = SYNTAXES.find_syntax_by_extension(language) else {
        return Ok(html! { pre { (source) } });
    };
    let mut generator = ClassedHTMLGenerator::new_with_class_style(syntax, &SYNTAXES, STYLE);
    // The generator needs a line end after every line.
    let source = format!("{}\n", source.trim_end());
    for line in LinesWithEndings::from(&source) {
        generator
            .parse_html_for_line_which_includes_newline(line)
            .map_err(|error| RenderError::Highlight(error.to_string()))?;
    }
    Ok(html! { pre.code { code { (PreEscaped(generator.finalize())) } } })
}

/// Levels by which headings of a text are lowered, below the section's own heading.
const BELOW: usize = 2;

/// Markdown as HTML. Embedded HTML is shown as text.
pub fn markdown(text: &str) -> Markup {
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
    html! { div.sheet { (PreEscaped(html)) } }
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
