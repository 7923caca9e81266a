//! Rust source as HTML with a class per kind of token; the page's style sheet colours them.

use super::ReportError;
use maud::{Markup, PreEscaped, html};
use syntect::html::{ClassStyle, ClassedHTMLGenerator};
use syntect::parsing::SyntaxSet;
use syntect::util::LinesWithEndings;

/// Prefix of the classes, as the style sheet has it.
const STYLE: ClassStyle = ClassStyle::SpacedPrefixed { prefix: "s-" };

/// Highlights sources; loads the syntax once.
pub struct Highlighter {
    syntaxes: SyntaxSet,
}

impl Highlighter {
    /// Loads the syntaxes.
    pub fn new() -> Self {
        Self {
            syntaxes: SyntaxSet::load_defaults_newlines(),
        }
    }

    /// Rust source as a code block.
    ///
    /// # Errors
    /// A fault of the syntax's own rules.
    pub fn rust(&self, source: &str) -> Result<Markup, ReportError> {
        let syntax = self
            .syntaxes
            .find_syntax_by_extension("rs")
            .unwrap_or_else(|| self.syntaxes.find_syntax_plain_text());
        let mut generator =
            ClassedHTMLGenerator::new_with_class_style(syntax, &self.syntaxes, STYLE);
        // The generator needs every line ended.
        let source = format!("{}\n", source.trim_end());
        for line in LinesWithEndings::from(&source) {
            generator
                .parse_html_for_line_which_includes_newline(line)
                .map_err(|error| ReportError::Highlight(error.to_string()))?;
        }
        Ok(html! { pre.code { code { (PreEscaped(generator.finalize())) } } })
    }
}
