//! Pages, parts of them and tables as plain text; tables in Markdown, coloured where a terminal
//! shows it.

use super::lines::paragraph;
use anstream::{AutoStream, ColorChoice};
use comfy_table::presets::ASCII_MARKDOWN;
use comfy_table::{CellAlignment, Color, ColumnConstraint, ContentArrangement, Row, Width};
use hexagen_lab::report::{Block, Cell, Column, Group, Key, Label, Sign, Table, Tone, plain};

/// Columns of a line; a table that is wider breaks the texts in its cells.
const COLUMNS: u16 = 100;

/// Spaces beside a cell's text.
const PADDING: u16 = 2;

/// Blocks one after another; figures are represented by their captions.
pub fn text(blocks: &[Block]) -> String {
    let parts = blocks.iter().map(block).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("\n")
}

fn block(block: &Block) -> String {
    match block {
        Block::Heading(text) => format!("\n{}:", typed(text)),
        Block::Lead(text) | Block::Prose(text) | Block::Note(text) => paragraph(&typed(text)),
        Block::Table(of) => table(of),
        Block::Tables(tables) => {
            let titled = tables
                .iter()
                .map(|of| format!("\n{}:\n{}", typed(&of.title), table(of)));
            titled.collect::<Vec<_>>().join("\n")
        }
        Block::Legend(keys) => legend(keys),
        // Nothing is switched on a terminal.
        Block::Switches(_) => String::new(),
        Block::Figures { figures, .. } => {
            let captions = figures
                .iter()
                .map(|figure| typed(&figure.caption).replace('\n', ", "));
            captions
                .map(|caption| format!("[{caption}]"))
                .collect::<Vec<_>>()
                .join("\n")
        }
        Block::Details {
            summary, blocks, ..
        } => format!("{}:\n{}", typed(summary), text(blocks)),
        Block::Linked(of) => of.code.clone(),
        Block::Markdown(text) | Block::Code { text, .. } => text.clone(),
    }
}

/// What the colours of cells mean; those of lines are not seen here.
fn legend(keys: &[Key]) -> String {
    let mut tones = Table::listed(["colour", "meaning"], []);
    for key in keys {
        if let Sign::Cell(tone) = key.sign {
            let name = if tone == Tone::None {
                "none"
            } else {
                tone.name()
            };
            tones.row([Cell::from(name).toned(tone), key.text.as_str().into()]);
        }
    }
    if tones.groups.is_empty() {
        String::new()
    } else {
        table(&tones)
    }
}

/// A text in plain characters: code marks, minus signs and spaces.
fn typed(text: &str) -> String {
    let text = plain(text).replace('\u{2212}', "-").replace('\u{ad}', "");
    text.replace(['\u{a0}', '\u{202f}'], " ")
}

/// Whether what stdout shows has colours, by NO_COLOR, CLICOLOR, CLICOLOR_FORCE and what it is.
pub fn is_coloured() -> bool {
    AutoStream::choice(&std::io::stdout()) != ColorChoice::Never
}

/// A table in Markdown, with the first line of each cell only.
pub fn table(table: &Table) -> String {
    let mut drawn = comfy_table::Table::new();
    drawn.load_style(ASCII_MARKDOWN);
    drawn.set_content_arrangement(ContentArrangement::Dynamic);
    drawn.set_width(COLUMNS);
    if is_coloured() {
        drawn.enforce_styling();
    } else {
        drawn.force_no_tty();
    }
    drawn.set_header(table.columns.iter().map(heading).collect::<Vec<_>>());
    for row in table.groups.iter().flat_map(rows) {
        drawn.add_row(row.iter().map(painted));
    }
    let bounds = bounds(&drawn, &table.columns);
    for ((place, column), of) in drawn.column_iter_mut().enumerate().zip(&table.columns) {
        if let Some(bound) = bounds.get(place) {
            column.set_constraint(*bound);
        }
        if of.is_number {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    drawn.trim_fmt()
}

/// Bounds of the columns where the table is wider than a line: numbers stay whole below a heading that
/// breaks, and of texts the words.
fn bounds(drawn: &comfy_table::Table, columns: &[Column]) -> Vec<ColumnConstraint> {
    let widths = drawn.column_max_content_widths();
    let whole: u16 = widths.iter().map(|width| width + PADDING + 1).sum();
    if whole < COLUMNS {
        return Vec::new();
    }
    let column = |(place, of): (usize, &Column)| {
        let head = longest_word(drawn.header().into_iter(), place);
        if of.is_number {
            let cells = drawn
                .row_iter()
                .filter_map(|row| row.cell_iter().nth(place));
            let cells = cells.map(|cell| cell.content().chars().count());
            ColumnConstraint::Absolute(wide(cells.max().max(head)))
        } else {
            let cells = longest_word(drawn.row_iter(), place);
            ColumnConstraint::LowerBoundary(wide(cells.max(head)))
        }
    };
    columns.iter().enumerate().map(column).collect()
}

/// The longest word of a column in rows.
fn longest_word<'a>(rows: impl Iterator<Item = &'a Row>, place: usize) -> Option<usize> {
    let words = rows.filter_map(|row| {
        let text = row.cell_iter().nth(place)?.content();
        text.split_whitespace()
            .map(|word| word.chars().count())
            .max()
    });
    words.max()
}

/// The width of a column for so many characters.
fn wide(characters: Option<usize>) -> Width {
    let characters = u16::try_from(characters.unwrap_or(0)).unwrap_or(COLUMNS);
    Width::Fixed(characters + PADDING)
}

/// The name of a column below that of its group; variants break after their commas.
fn heading(column: &Column) -> String {
    let name = typed(&format!("{} {}", column.name, column.unit));
    let parts = [
        typed(&column.group),
        name.trim().replace(',', ",\n").replace(",\n ", ", "),
    ];
    let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    parts.join("\n")
}

/// The rows of a group, its label in their first column.
fn rows(group: &Group) -> Vec<Vec<Cell>> {
    let mut rows: Vec<Vec<Cell>> = group.rows.iter().map(|row| spread(row)).collect();
    match &group.label {
        Label::None => {}
        Label::Above(label) => rows.insert(0, vec![label.clone()]),
        Label::Beside(label) => {
            for (place, row) in rows.iter_mut().enumerate() {
                let label = if place == 0 {
                    label.clone()
                } else {
                    Cell::default()
                };
                row.insert(0, label);
            }
        }
    }
    rows
}

/// A cell per column: behind one over several columns stand empty ones.
fn spread(row: &[Cell]) -> Vec<Cell> {
    let cells = row.iter().flat_map(|cell| {
        let behind = vec![Cell::default(); cell.columns.max(1) - 1];
        [cell.clone()].into_iter().chain(behind)
    });
    cells.collect()
}

/// The cell's text on the ground of its tone, in the 256 colours of terminals; pale ones bear dark
/// ink.
fn painted(cell: &Cell) -> comfy_table::Cell {
    let mut text = typed(&cell.text);
    if !cell.detail.is_empty() && !cell.detail.starts_with('\n') {
        text = format!("{text} ({})", typed(&cell.detail));
    }
    let drawn = comfy_table::Cell::new(text);
    let (ground, ink) = match cell.tone {
        Tone::None | Tone::Good | Tone::Missed | Tone::Muted => return drawn,
        Tone::Slight => (230, 16),
        Tone::Marked => (221, 16),
        Tone::Strong => (208, 16),
        Tone::Broken => (124, 231),
    };
    drawn.bg(Color::AnsiValue(ground)).fg(Color::AnsiValue(ink))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_and_wide_cells_keep_to_their_columns() {
        let columns = [
            Column::text("Drive"),
            Column::text("Model"),
            Column::number("Mean", "Nm").of("400 rpm"),
            Column::number("Limit", "%"),
        ];
        let mut runs = Table::new("", columns);
        runs.group(Label::Beside("`pdcc`".into()));
        runs.row(["fixed", "3.30", "\u{2212}1"].map(Cell::from));
        runs.row([Cell::from("ideal"), Cell::from("trips").across(2)]);
        let lines = [
            "|        |       | 400 rpm |         |",
            "| Drive  | Model | Mean Nm | Limit % |",
            "|--------|-------|---------|---------|",
            "| `pdcc` | fixed |    3.30 |      -1 |",
            "|        | ideal |   trips |         |",
        ];
        let found = table(&runs);
        for line in &lines[2..] {
            assert!(
                found.lines().any(|found| found == *line),
                "{line} in\n{found}"
            );
        }
        assert!(
            found.contains("Mean Nm") && found.contains("400 rpm"),
            "{found}"
        );
    }

    #[test]
    fn a_wide_table_breaks_its_texts_between_words() {
        let columns = [
            Column::text("Drive"),
            Column::number("Number of trips", "of all"),
        ];
        let mut wide = Table::new("", columns);
        wide.row([Cell::from("word ".repeat(30)), "123456".into()]);
        let found = table(&wide);
        assert!(
            found.lines().all(|line| line.chars().count() <= 100),
            "{found}"
        );
        let words = found.split([' ', '|']).filter(|word| *word == "word");
        assert_eq!(words.count(), 30, "{found}");
        assert!(found.contains(" 123456 |"), "{found}");
    }
}
