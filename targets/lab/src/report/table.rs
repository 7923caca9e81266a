//! Tables: columns, groups of rows, cells.

use super::Sign;
use serde::Serialize;

/// A table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// Class of the table for style sheets; empty for a plain one.
    pub kind: &'static str,
    /// Title, for small tables side by side.
    pub title: String,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows.
    pub groups: Vec<Group>,
}

impl Table {
    /// A table without rows.
    pub fn new(kind: &'static str, columns: impl IntoIterator<Item = Column>) -> Self {
        Self {
            kind,
            columns: columns.into_iter().collect(),
            ..Self::default()
        }
    }

    /// A table without rows, of named columns: first texts, then numbers.
    pub fn listed<const T: usize, const N: usize>(texts: [&str; T], numbers: [&str; N]) -> Self {
        let texts = texts.into_iter().map(Column::text);
        let numbers = numbers.into_iter().map(|name| Column::number(name, ""));
        Self::new("", texts.chain(numbers))
    }

    /// Adds a row to the last group.
    pub fn row<C: Into<Cell>>(&mut self, cells: impl IntoIterator<Item = C>) {
        if self.groups.is_empty() {
            self.groups.push(Group::default());
        }
        if let Some(group) = self.groups.last_mut() {
            group.rows.push(cells.into_iter().map(Into::into).collect());
        }
    }

    /// Begins a group of rows.
    pub fn group(&mut self, label: Label) {
        self.groups.push(Group {
            label,
            rows: Vec::new(),
        });
    }
}

/// A column.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Column {
    /// Heading.
    pub name: String,
    /// Unit of its numbers.
    pub unit: String,
    /// Heading shared with its neighbours.
    pub group: String,
    /// Whether it holds numbers.
    pub is_number: bool,
}

impl Column {
    /// A column of text.
    pub fn text(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..Self::default()
        }
    }

    /// A column of numbers.
    pub fn number(name: impl Into<String>, unit: &str) -> Self {
        Self {
            name: name.into(),
            unit: unit.to_owned(),
            is_number: true,
            ..Self::default()
        }
    }

    /// The column with a heading shared with its neighbours.
    #[must_use]
    pub fn of(mut self, group: impl Into<String>) -> Self {
        self.group = group.into();
        self
    }
}

/// A group of rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Group {
    /// Heading of the group.
    pub label: Label,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

/// Position of a group's heading.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Label {
    /// Nowhere.
    #[default]
    None,
    /// In a row above them.
    Above(Cell),
    /// In the first column, next to all rows.
    Beside(Cell),
}

/// A cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cell {
    /// Symbol before the text.
    pub sign: Option<Sign>,
    /// Text.
    pub text: String,
    /// Secondary text, less prominent.
    pub detail: String,
    /// Rating of the cell.
    pub tone: Tone,
    /// Number of columns that it spans; 0 and 1 are one.
    pub columns: usize,
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }
}

impl Cell {
    /// The cell with a secondary text.
    #[must_use]
    pub fn detail(mut self, detail: impl Into<String>) -> Self {
        self.detail = detail.into();
        self
    }

    /// The cell with a tone.
    #[must_use]
    pub fn toned(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    /// The cell, marked as wrong if it is; the mark is visible without colours.
    #[must_use]
    pub fn missed_if(mut self, is_missed: bool) -> Self {
        if is_missed {
            self.tone = Tone::Missed;
            self.text = format!("\u{2260}\u{a0}{}", self.text);
        }
        self
    }

    /// The cell over several columns.
    #[must_use]
    pub fn across(mut self, columns: usize) -> Self {
        self.columns = columns;
        self
    }

    /// The cell with a symbol before it.
    #[must_use]
    pub fn signed(mut self, sign: Option<Sign>) -> Self {
        self.sign = sign;
        self
    }
}

/// Tone of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tone {
    /// Neutral.
    #[default]
    None,
    /// Right.
    Good,
    /// Wrong.
    Missed,
    /// Minor.
    Muted,
    /// Slight deviation.
    Slight,
    /// Clear deviation.
    Marked,
    /// Large deviation.
    Strong,
    /// Unusable.
    Broken,
}

impl Tone {
    /// Its name in style sheets.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "",
            Self::Good => "good",
            Self::Missed => "missed",
            Self::Muted => "muted",
            Self::Slight => "slight",
            Self::Marked => "marked",
            Self::Strong => "strong",
            Self::Broken => "broken",
        }
    }
}
