//! Reports as data: pages of prose, tables and figures. Renderers show them on a terminal, as HTML
//! or as JSON.
//!
//! Text has a little markup: `` `code` ``, `**strong**` and `_{subscript}`; a line feed ends a line
//! within a cell.

mod pages;
mod palette;
pub mod plot;
mod table;

pub use pages::{
    reproduction_blocks, reproduction_page, results_blocks, results_page, robustness_blocks,
};
pub use palette::{AXIS, Color, DEMAND, GRID, IDEAL, INK, PHASES, VARIANTS, variant};
pub use plot::Plot;
pub use table::{Cell, Column, Group, Label, Table, Tone};

use serde::Serialize;

/// A page: what it is called, what stands at its beginning, and its sections in their order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Page {
    /// Name of its file, without ending.
    pub file: String,
    /// Title.
    pub title: String,
    /// Heading of the page, where it is another one than the title.
    pub heading: String,
    /// What stands below the heading.
    pub opening: Vec<Block>,
    /// The sections.
    pub sections: Vec<Section>,
    /// Program and version that it is from.
    pub generator: String,
}

/// One section of a page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// Name of its link, unique on the page.
    pub id: &'static str,
    /// Title.
    pub title: &'static str,
    /// What it says.
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
    /// A sentence that leads in.
    Lead(String),
    /// A paragraph.
    Prose(String),
    /// A paragraph on how to read what follows.
    Note(String),
    /// A table.
    Table(Table),
    /// Small tables side by side.
    Tables(Vec<Table>),
    /// What the signs of the figures below mean.
    Legend(Vec<Key>),
    /// Figures side by side.
    Figures {
        /// How many of them stand in a row.
        columns: usize,
        /// The figures.
        figures: Vec<Figure>,
    },
    /// What is folded until somebody asks for it.
    Details {
        /// What is in it.
        summary: String,
        /// Whether it is unfolded at first.
        is_open: bool,
        /// The content.
        blocks: Vec<Block>,
    },
    /// A text in Markdown.
    Markdown(String),
    /// A text in a language of machines.
    Code {
        /// Ending of its files: "rs", "toml".
        language: &'static str,
        /// The text.
        text: String,
    },
}

impl Block {
    /// Said instead of a part that has nothing to show.
    pub fn nothing(what: &str) -> Vec<Self> {
        vec![Self::Note(format!("This report has no {what}."))]
    }
}

/// A plot below its caption.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Sign of what is plotted, before the caption.
    pub sign: Option<Sign>,
    /// Caption.
    pub caption: String,
    /// The plot; none where there is nothing to show.
    pub plot: Option<Plot>,
    /// What is said below.
    pub note: Option<String>,
}

impl Figure {
    /// A plot with its caption.
    pub fn new(sign: Option<Sign>, caption: impl Into<String>, plot: Plot) -> Self {
        Self {
            sign,
            caption: caption.into(),
            plot: Some(plot),
            note: None,
        }
    }
}

/// A sign and what it means.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Key {
    /// The sign.
    pub sign: Sign,
    /// Its meaning.
    pub text: String,
}

/// How something is drawn.
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

    /// The sign with its meaning.
    pub fn means(self, text: impl Into<String>) -> Key {
        Key {
            sign: self,
            text: text.into(),
        }
    }
}

/// A stretch of text that is set alike.
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

/// The stretches of a text with markup. A mark without its end is text.
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

/// A text for readers of plain text: code keeps its marks, subscripts stand behind a low line.
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
    fn marks_part_a_text_and_lone_ones_stay() {
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
