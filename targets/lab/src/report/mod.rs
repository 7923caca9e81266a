//! Reports as data: pages of prose, tables and figures, rendered for a terminal, as HTML or as
//! JSON.
//!
//! Texts have a little markup: `` `code` ``, `**strong**` and `_{subscript}`; a line feed is a line
//! break within a cell.

mod pages;
mod palette;
pub mod plot;
mod table;

pub use pages::{
    reproduction_blocks, reproduction_page, results_blocks, results_page, robustness_blocks,
    variants_table, verdict,
};
pub use palette::{AXIS, Color, DEMAND, GRID, IDEAL, INK, PHASES, VARIANTS, variant};
pub use plot::Plot;
pub use table::{Cell, Column, Group, Label, Table, Tone};

use serde::Serialize;

/// A page: title, introduction and sections.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Page {
    /// Name of its file, without ending.
    pub file: String,
    /// Title.
    pub title: String,
    /// Heading of the page, if different from the title.
    pub heading: String,
    /// Introduction below the heading.
    pub opening: Vec<Block>,
    /// The sections.
    pub sections: Vec<Section>,
    /// Program and version.
    pub generator: String,
}

/// One section of a page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// Anchor, unique on the page.
    pub id: &'static str,
    /// Title.
    pub title: &'static str,
    /// Content.
    pub blocks: Vec<Block>,
}

impl Section {
    /// A section of these blocks.
    pub fn new(id: &'static str, title: &'static str, blocks: Vec<Block>) -> Self {
        Self { id, title, blocks }
    }
}

/// A piece of a section.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Block {
    /// A heading within the section.
    Heading(String),
    /// A leading sentence.
    Lead(String),
    /// A paragraph.
    Prose(String),
    /// A note on how to read the following.
    Note(String),
    /// A table.
    Table(Table),
    /// Small tables side by side.
    Tables(Vec<Table>),
    /// Key of the figures below.
    Legend(Vec<Key>),
    /// Key of the variants, each of which can be switched off in all figures.
    Switches(Vec<Switch>),
    /// Figures side by side.
    Figures {
        /// Number of figures in a row.
        columns: usize,
        /// The figures.
        figures: Vec<Figure>,
    },
    /// Folded content.
    Details {
        /// Summary.
        summary: String,
        /// Whether it is unfolded at first.
        is_open: bool,
        /// The content.
        blocks: Vec<Block>,
    },
    /// A text in Markdown.
    Markdown(String),
    /// Specification, formulas and code side by side.
    Linked(Linked),
    /// A text in a programming language.
    Code {
        /// File extension: "rs", "toml".
        language: &'static str,
        /// The text.
        text: String,
    },
}

impl Block {
    /// Replaces a part without content.
    pub fn nothing(what: &str) -> Vec<Self> {
        vec![Self::Note(format!("This report has no {what}."))]
    }
}

/// A plot below its caption.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Index of the variant that it shows, if it shows one alone.
    pub variant: Option<usize>,
    /// Symbol before the caption.
    pub sign: Option<Sign>,
    /// Caption.
    pub caption: String,
    /// The plot; `None` if there is no data.
    pub plot: Option<Plot>,
    /// Note below.
    pub note: Option<String>,
}

impl Figure {
    /// A plot with its caption.
    pub fn new(sign: Option<Sign>, caption: impl Into<String>, plot: Plot) -> Self {
        Self {
            variant: None,
            sign,
            caption: caption.into(),
            plot: Some(plot),
            note: None,
        }
    }
}

/// A symbol with its meaning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// The symbol.
    pub sign: Sign,
    /// Its meaning.
    pub text: String,
}

/// A variant's symbol and name, with which it is switched on and off.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Switch {
    /// Its index in the table.
    pub variant: usize,
    /// Symbol and name.
    pub key: Key,
}

/// A specification, the formulas that follow from it, and the code that computes them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Linked {
    /// The fields as written, with the formulas that each bears on.
    pub fields: Vec<(String, Vec<usize>)>,
    /// Name and text of each formula, with the lines of the code in which it stands, its own first.
    pub formulas: Vec<(String, String, Vec<usize>)>,
    /// File extension of the code's language.
    pub language: &'static str,
    /// The code.
    pub code: String,
}

/// Symbol of a plot element.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Sign {
    /// As a line: colour, width, dash and gap.
    Line(Color, f64, (f64, f64)),
    /// As a field: colour and opacity.
    Field(Color, f64),
    /// As a dot.
    Dot(Color),
    /// As a cross.
    Cross(Color),
    /// As a cell of a table.
    Cell(Tone),
}

impl Sign {
    /// A solid line.
    pub fn line(color: Color, width: f64) -> Self {
        Self::Line(color, width, (0.0, 0.0))
    }

    /// The symbol with a meaning.
    pub fn means(self, text: impl Into<String>) -> Key {
        Key {
            sign: self,
            text: text.into(),
        }
    }
}

/// A span of text with one style.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Span<'t> {
    /// As the text around it.
    Plain(&'t str),
    /// Code.
    Code(&'t str),
    /// Emphasised.
    Strong(&'t str),
    /// A subscript.
    Subscript(&'t str),
}

/// The spans of a text with markup. A mark without its counterpart is text.
pub fn spans(text: &str) -> Vec<Span<'_>> {
    let marks = [("`", "`"), ("**", "**"), ("_{", "}")];
    let (mut spans, mut rest) = (vec![], text);
    loop {
        let found = marks
            .iter()
            .enumerate()
            .filter_map(|(kind, (open, close))| {
                let start = rest.find(open)?;
                let from = start + open.len();
                let to = from + rest[from..].find(close)?;
                Some((start, kind, from, to, to + close.len()))
            });
        let Some((start, kind, from, to, end)) = found.min() else {
            break;
        };
        if start > 0 {
            spans.push(Span::Plain(&rest[..start]));
        }
        let inside = &rest[from..to];
        spans.push(match kind {
            0 => Span::Code(inside),
            1 => Span::Strong(inside),
            _ => Span::Subscript(inside),
        });
        rest = &rest[end..];
    }
    if !rest.is_empty() {
        spans.push(Span::Plain(rest));
    }
    spans
}

/// A plain text: code keeps its marks, a subscript follows an underscore.
pub fn plain(text: &str) -> String {
    let spans = spans(text).into_iter();
    spans
        .map(|span| match span {
            Span::Plain(text) | Span::Strong(text) => text.to_owned(),
            Span::Code(text) => format!("`{text}`"),
            Span::Subscript(text) => format!("_{text}"),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paired_marks_make_spans_and_single_ones_are_text() {
        assert_eq!(
            spans("T_{s} of `a*b`, **not** 2 ** 3"),
            [
                Span::Plain("T"),
                Span::Subscript("s"),
                Span::Plain(" of "),
                Span::Code("a*b"),
                Span::Plain(", "),
                Span::Strong("not"),
                Span::Plain(" 2 ** 3"),
            ]
        );
        assert_eq!(
            plain("T_{s} of `a`, **not** one ` alone"),
            "T_s of `a`, not one ` alone"
        );
    }
}
