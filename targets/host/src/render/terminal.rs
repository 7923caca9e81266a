//! Pages, parts of them and tables as plain text; tables in Markdown, coloured where a terminal
//! shows it.

use anstream::{AutoStream, ColorChoice};
use comfy_table::presets::ASCII_MARKDOWN;
use comfy_table::{CellAlignment, Color};
use hexagen_lab::report::{Block, Cell, Column, Group, Key, Label, Sign, Table, Tone, plain};

/// Longest line in a column of text.
const WIDEST: usize = 60;

/// Blocks one after another; figures are represented by their captions.
pub fn text(blocks: &[Block]) -> String {
    let parts = blocks.iter().map(block).filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join("\n")
}

fn block(block: &Block) -> String {
    match block {
        Block::Heading(text) => format!("\n{}:", typed(text)),
        Block::Lead(text) | Block::Prose(text) | Block::Note(text) => typed(text),
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

/// A table in Markdown, with the first line of each cell only.
pub fn table(table: &Table) -> String {
    let mut drawn = comfy_table::Table::new();
    drawn.load_style(ASCII_MARKDOWN);
    // Depends on NO_COLOR, CLICOLOR and stdout.
    match AutoStream::choice(&std::io::stdout()) {
        ColorChoice::Never => drawn.force_no_tty(),
        _ => drawn.enforce_styling(),
    };
    drawn.set_header(table.columns.iter().map(heading).collect::<Vec<_>>());
    for row in table.groups.iter().flat_map(rows) {
        let cells = table.columns.iter().zip(&row);
        drawn.add_row(
            cells
                .map(|(column, cell)| painted(column, cell))
                .collect::<Vec<_>>(),
        );
    }
    for (column, of) in drawn.column_iter_mut().zip(&table.columns) {
        if of.is_number {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    drawn.trim_fmt()
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
fn painted(column: &Column, cell: &Cell) -> comfy_table::Cell {
    let mut text = typed(&cell.text);
    if !cell.detail.is_empty() && !cell.detail.starts_with('\n') {
        text = format!("{text} ({})", typed(&cell.detail));
    }
    let text = if column.is_number {
        text
    } else {
        wrapped(&text)
    };
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

/// A text with its lines broken between words.
fn wrapped(text: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for line in text.split('\n') {
        let mut words = line.split(' ');
        let mut last = words.next().unwrap_or_default().to_owned();
        for word in words {
            if last.chars().count() + 1 + word.chars().count() > WIDEST {
                lines.push(std::mem::take(&mut last));
                word.clone_into(&mut last);
            } else {
                last = format!("{last} {word}");
            }
        }
        lines.push(last);
    }
    lines.join("\n")
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
    fn long_texts_break_between_words() {
        let text = wrapped(&"word ".repeat(30));
        assert!(text.lines().count() > 1);
        assert!(
            text.lines().all(|line| line.chars().count() <= WIDEST),
            "{text}"
        );
    }
}
