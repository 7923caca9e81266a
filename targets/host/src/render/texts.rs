//! Texts of other languages as HTML: Markdown, and source with a class per kind of token.

use super::RenderError;
use maud::{Markup, PreEscaped, html};
use pulldown_cmark::html::push_html;
use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd};
use std::sync::LazyLock;
use syntect::easy::ScopeRegionIterator;
use syntect::parsing::{ParseState, Scope, ScopeStack, SyntaxSet};
use syntect::util::LinesWithEndings;

static SYNTAXES: LazyLock<SyntaxSet> = LazyLock::new(SyntaxSet::load_defaults_newlines);

/// Classes of tokens with the scopes that they stand for, the narrower first. One letter each: a page
/// has ten thousand tokens.
const CLASSES: [(&str, &str); 15] = [
    ("c", "comment"),
    ("s", "string"),
    ("n", "constant"),
    ("f", "entity.name.function"),
    ("f", "support.function"),
    ("t", "entity.name"),
    ("t", "support.type"),
    ("k", "storage.type.function"),
    ("k", "storage.type.impl"),
    ("k", "storage.type.struct"),
    ("t", "storage.type"),
    ("k", "storage"),
    ("", "keyword.operator"),
    ("k", "keyword"),
    ("a", "meta.annotation"),
];

static SCOPES: LazyLock<Vec<(&str, Scope)>> = LazyLock::new(|| {
    let scopes = CLASSES.iter();
    let scopes = scopes.filter_map(|(class, scope)| Some((*class, Scope::new(scope).ok()?)));
    scopes.collect()
});

/// The class of a token, of its innermost scope that has one.
fn class_of(stack: &ScopeStack) -> &'static str {
    let class = |scope: &Scope| {
        SCOPES
            .iter()
            .find(|(_, prefix)| prefix.is_prefix_of(*scope))
    };
    let found = stack.scopes.iter().rev().find_map(class);
    found.map_or("", |(class, _)| class)
}

/// Source as a code block, coloured where its language is known.
///
/// # Errors
/// An error in the rules of the syntax.
pub fn code(language: &str, source: &str) -> Result<Markup, RenderError> {
    let lines = lines(language, source)?;
    Ok(html! { pre.code { code { @for line in lines { (line) } } } })
}

/// The lines of a source, coloured where its language is known.
///
/// # Errors
/// As [`code`].
pub fn lines(language: &str, source: &str) -> Result<Vec<Markup>, RenderError> {
    // The syntax needs a line end after every line.
    let source = format!("{}\n", source.trim_end());
    let Some(syntax) = SYNTAXES.find_syntax_by_extension(language) else {
        return Ok(LinesWithEndings::from(&source)
            .map(|line| html! { (line) })
            .collect());
    };
    let (mut state, mut stack) = (ParseState::new(syntax), ScopeStack::new());
    let failed = |error: &dyn std::fmt::Display| RenderError::Highlight(error.to_string());
    let mut coloured = Vec::new();
    for line in LinesWithEndings::from(&source) {
        let changes = state
            .parse_line(line, &SYNTAXES)
            .map_err(|error| failed(&error))?;
        // Neighbours of one class are one token.
        let mut tokens: Vec<(&str, String)> = Vec::new();
        for (text, change) in ScopeRegionIterator::new(&changes, line) {
            stack.apply(change).map_err(|error| failed(&error))?;
            match tokens.last_mut() {
                Some((class, token)) if *class == class_of(&stack) || text.trim().is_empty() => {
                    token.push_str(text);
                }
                _ => tokens.push((class_of(&stack), text.to_owned())),
            }
        }
        coloured.push(html! {
            @for (class, token) in tokens {
                @if class.is_empty() { (token) } @else { i.(class) { (token) } }
            }
        });
    }
    Ok(coloured)
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
