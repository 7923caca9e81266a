//! Pages, parts of them and tables as plain text; tables in Markdown, coloured where a terminal
//! shows it.

use super::lines::{COLUMNS, paragraph};
use anstream::{AutoStream, ColorChoice};
use comfy_table::presets::ASCII_MARKDOWN;
use comfy_table::{CellAlignment, Color, ColumnConstraint, ContentArrangement, Width};
use hexagen_lab::report::{Block, Cell, Column, Group, Key, Label, Sign, Table, Tone, plain};

/// Spaces beside a cell's text.
const PADDING: usize = 2;

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

/// A table in Markdown, with the first line of each cell only. One that is too wide for a line is drawn in parts
/// below each other, which all begin with the table's first columns of texts.
pub fn table(table: &Table) -> String {
    let rows: Vec<Vec<Cell>> = table.groups.iter().flat_map(rows).collect();
    let of = |(place, column)| Drawn::of(place, column, &rows);
    let columns: Vec<Drawn> = table.columns.iter().enumerate().map(of).collect();
    let parts = parts(&columns);
    let parts = parts.iter().map(|part| part_of(part, &rows));
    parts.collect::<Vec<_>>().join("\n\n")
}

/// A column and the characters of its lines.
#[derive(Clone)]
struct Drawn {
    /// Its number in the table.
    place: usize,
    heading: String,
    is_number: bool,
    /// Characters of its longest word or, of numbers, which stay whole, its longest cell.
    least: usize,
    /// Characters of its longest line.
    whole: usize,
}

impl Drawn {
    fn of(place: usize, column: &Column, rows: &[Vec<Cell>]) -> Self {
        let characters = |text: &str| text.chars().count();
        let cells = rows.iter().filter_map(|row| row.get(place)).map(shown);
        let cells: Vec<String> = cells.collect();
        let longest_cell = cells.iter().map(|cell| characters(cell)).max();
        let heading = heading(column);
        let words = heading.split_whitespace();
        let head = words.map(characters).max();
        let of_cells = if column.is_number {
            longest_cell
        } else {
            let words = cells.iter().flat_map(|cell| cell.split_whitespace());
            words.map(characters).max()
        };
        let whole = heading.lines().map(characters).max().max(longest_cell);
        Self {
            place,
            is_number: column.is_number,
            least: of_cells.max(head).unwrap_or(0),
            whole: whole.unwrap_or(0),
            heading,
        }
    }
}

/// Characters of a line with columns of these widths.
fn line(widths: impl Iterator<Item = usize>) -> usize {
    widths.map(|width| width + PADDING + 1).sum::<usize>() + 1
}

/// The columns of each part of a table: as many as a line holds.
fn parts(columns: &[Drawn]) -> Vec<Vec<Drawn>> {
    let (texts, others) = columns.split_at(columns.iter().take_while(|of| !of.is_number).count());
    let mut parts = vec![texts.to_vec()];
    for column in others {
        let is_begun = parts.last().is_some_and(|part| part.len() > texts.len());
        let with = |part: &Vec<Drawn>| line(part.iter().chain([column]).map(|of| of.least));
        if is_begun && parts.last().is_some_and(|part| with(part) > COLUMNS) {
            parts.push(texts.to_vec());
        }
        parts
            .last_mut()
            .expect("begins with one")
            .push(column.clone());
    }
    parts
}

/// Some columns of rows.
fn part_of(columns: &[Drawn], rows: &[Vec<Cell>]) -> String {
    let mut drawn = comfy_table::Table::new();
    drawn.load_style(ASCII_MARKDOWN);
    drawn.set_content_arrangement(ContentArrangement::Dynamic);
    drawn.set_width(width(COLUMNS));
    if is_coloured() {
        drawn.enforce_styling();
    } else {
        drawn.force_no_tty();
    }
    drawn.set_header(columns.iter().map(|column| &column.heading));
    for row in rows {
        let cells = columns.iter().map(|column| row.get(column.place));
        drawn.add_row(cells.map(|cell| painted(&cell.cloned().unwrap_or_default())));
    }
    let breaks = line(columns.iter().map(|column| column.whole)) > COLUMNS;
    let has_room = line(columns.iter().map(|column| column.least)) <= COLUMNS;
    for (drawn, column) in drawn.column_iter_mut().zip(columns) {
        if breaks && (has_room || column.is_number) {
            drawn.set_constraint(bound(column));
        }
        if column.is_number {
            drawn.set_cell_alignment(CellAlignment::Right);
        }
    }
    drawn.trim_fmt()
}

/// The bound of a column whose table is wider than a line: numbers stay whole below a heading that breaks, and of texts
/// the words.
fn bound(column: &Drawn) -> ColumnConstraint {
    let least = Width::Fixed(width(column.least + PADDING));
    if column.is_number {
        ColumnConstraint::Absolute(least)
    } else {
        ColumnConstraint::LowerBoundary(least)
    }
}

fn width(characters: usize) -> u16 {
    u16::try_from(characters).unwrap_or(u16::MAX)
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

/// A cell in plain characters, its detail in parentheses unless that stands on a further line.
fn shown(cell: &Cell) -> String {
    let text = typed(&cell.text);
    if cell.detail.is_empty() || cell.detail.starts_with('\n') {
        text
    } else {
        format!("{text} ({})", typed(&cell.detail))
    }
}

/// The cell's text on the ground of its tone, in the 256 colours of terminals; pale ones bear dark
/// ink.
fn painted(cell: &Cell) -> comfy_table::Cell {
    let drawn = comfy_table::Cell::new(shown(cell));
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

    #[test]
    fn a_table_of_many_numbers_is_drawn_in_parts_of_a_line() {
        let numbers = ["speed", "torque", "current", "losses"];
        let mut many = Table::listed(["motor"], numbers);
        let number = "1".repeat(40);
        many.row(["hub", &number, &number, &number, "2"]);
        // Fewer cells than columns.
        many.row(["wheel", "refused"]);
        let found = table(&many);
        assert!(
            found.lines().all(|line| line.chars().count() <= 100),
            "{found}"
        );
        let (first, second) = found.split_once("\n\n").expect("two parts");
        for (part, names) in [(first, &numbers[..2]), (second, &numbers[2..])] {
            let head = part.lines().next().expect("a heading");
            let words: Vec<&str> = head
                .split([' ', '|'])
                .filter(|word| !word.is_empty())
                .collect();
            assert_eq!(words, [&["motor"], names].concat(), "{found}");
            assert!(
                part.contains("| hub ") && part.contains("| wheel "),
                "{found}"
            );
        }
        assert_eq!(found.matches(&number).count(), 3, "{found}");
    }

    #[test]
    fn a_word_that_is_wider_than_a_line_breaks() {
        let mut wide = Table::listed(["controller"], ["word"]);
        wide.row(["x".repeat(150), "16".to_owned()]);
        let found = table(&wide);
        assert!(
            found.lines().all(|line| line.chars().count() <= 100),
            "{found}"
        );
        assert_eq!(found.matches('x').count(), 150, "{found}");
    }
}
