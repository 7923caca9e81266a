//! Tables: columns, groups of rows, cells.

use super::Sign;
use serde::Serialize;

/// A table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// What kind of table it is, for style sheets; empty for a plain one.
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

    /// A table without rows of named columns: first texts, then numbers.
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

    /// Begins a group of rows that belong together.
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
    /// What is in it.
    pub name: String,
    /// Unit of its numbers.
    pub unit: String,
    /// What it has in common with its neighbours.
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

    /// The column, with what it has in common with its neighbours.
    #[must_use]
    pub fn of(mut self, group: impl Into<String>) -> Self {
        self.group = group.into();
        self
    }
}

/// Rows that belong together.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Group {
    /// What they have in common.
    pub label: Label,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

/// Where a group says what its rows have in common.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Label {
    /// Nowhere.
    #[default]
    None,
    /// In a row above them.
    Above(Cell),
    /// In the first column, beside all of them.
    Beside(Cell),
}

/// A cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Cell {
    /// Sign of what it is about.
    pub sign: Option<Sign>,
    /// What it says.
    pub text: String,
    /// What it says besides, less loud.
    pub detail: String,
    /// How it is meant.
    pub tone: Tone,
    /// How many columns it takes; 0 and 1 are one.
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
    /// The cell, with what it says besides.
    #[must_use]
    pub fn detail(mut self, detail: impl Into<String>) -> Self {
        self.detail = detail.into();
        self
    }

    /// The cell in a tone.
    #[must_use]
    pub fn toned(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }

    /// The cell as one that is not as it should be, where it is not; the mark says so without
    /// colours.
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

    /// The cell behind a sign.
    #[must_use]
    pub fn signed(mut self, sign: Option<Sign>) -> Self {
        self.sign = sign;
        self
    }
}

/// How a cell is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Tone {
    /// As any other.
    #[default]
    None,
    /// As it should be.
    Good,
    /// Not as it should be.
    Missed,
    /// Of less interest.
    Muted,
    /// A little off.
    Slight,
    /// Clearly off.
    Marked,
    /// Far off.
    Strong,
    /// Beyond use.
    Broken,
}

impl Tone {
    /// Its name, as style sheets have it.
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
