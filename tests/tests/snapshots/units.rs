//! Emitted texts split into units (items of code, stages of a program, sections of a data sheet),
//! and these into lines: statements and sentences, however broken and indented.

use crate::prose::Prose;
use crate::shape::{Shape, shape, shape_in};

/// A named piece of an emitted text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unit {
    /// The kind of the text.
    kind: &'static str,
    /// Its name in every drive.
    pub name: String,
    /// Its text as emitted.
    pub text: String,
    /// Statements and sentences of it.
    pub lines: Vec<String>,
}

impl Unit {
    fn of(kind: &'static str, name: &str, text: &[&str], lines: Vec<String>) -> Self {
        Self {
            kind,
            name: shape(name),
            text: text.join("\n"),
            lines,
        }
    }

    /// The shape of each of its lines.
    pub fn shapes(&self) -> impl Iterator<Item = Shape> {
        let shapes = self
            .lines
            .iter()
            .map(|line| shape_in(self.kind, &self.name, line));
        shapes.map(|shape| (self.name.clone(), shape))
    }
}

/// Units of every kind of text; of C only the code, since Rust has the same comments.
pub fn units(kind: &str, text: &str) -> Vec<Unit> {
    match kind {
        "c99" => with_definitions_joined(&items(kind, text)),
        "ir" => of_program(text),
        "datasheet" => of_sheet(text),
        _ => items(kind, text),
    }
}

/// Items of a text of code, as many as were emitted; of C without comments.
pub fn items(kind: &str, text: &str) -> Vec<Unit> {
    match kind {
        "c99" => of_code("c99", &without_comments(text)),
        _ => of_code("rust", text),
    }
}

fn without_comments(code: &str) -> String {
    let mut reader = Reader::default();
    let code = code
        .lines()
        .filter(|line| reader.read(line) != Part::Comment);
    code.collect::<Vec<_>>().join("\n")
}

/// Items of Rust or C, with their documentation. Blocks of items are not items themselves.
fn of_code(kind: &'static str, text: &str) -> Vec<Unit> {
    let (mut units, mut taken, mut depth) = (vec![], vec![], 0);
    let mut open = 0;
    let mut reader = Reader::default();
    for line in text.lines() {
        let part = reader.read(line);
        let indent = line.len() - line.trim_start().len();
        if line.is_empty() && taken.is_empty() {
            continue;
        }
        if taken.is_empty() && indent < depth && part == Part::Code {
            // The end of a block of items.
            depth = indent;
            continue;
        }
        taken.push(
            line.get(depth..)
                .filter(|_| indent >= depth)
                .unwrap_or(line),
        );
        let opens = ["impl ", "const _: ()", "extern "];
        let opens = opens.iter().any(|start| line.trim().starts_with(start));
        if part == Part::Code && !opens {
            open += balance(line);
        }
        let ends = match part {
            Part::Comment => false,
            Part::Text => line.ends_with("\"#;"),
            Part::Macro => open <= 0 && !line.ends_with('\\'),
            Part::Code => opens || open <= 0 && line.ends_with([';', '}']),
        };
        if ends {
            if opens && line.ends_with('{') && !line.starts_with("extern") {
                depth += 4;
            }
            units.push(Unit::of(
                kind,
                &item_name(&taken),
                &taken,
                code_lines(&taken),
            ));
            taken.clear();
            open = 0;
        }
    }
    assert!(taken.is_empty(), "an item without end: {taken:?}");
    units
}

/// Brackets opened by a line, minus those closed.
pub fn balance(line: &str) -> i32 {
    let count = |brackets: [char; 3]| line.matches(brackets).count() as i32;
    count(['(', '[', '{']) - count([')', ']', '}'])
}

/// Definitions of C that follow each other become one unit.
fn with_definitions_joined(units: &[Unit]) -> Vec<Unit> {
    let is_definition = |unit: &Unit| unit.text.starts_with("#define ") && unit.lines.len() == 1;
    let runs = units.chunk_by(|unit, next| is_definition(unit) && is_definition(next));
    let joined = runs.map(|run| {
        let texts: Vec<&str> = run.iter().map(|unit| &*unit.text).collect();
        let lines = run.iter().flat_map(|unit| unit.lines.clone()).collect();
        let is_joined = is_definition(&run[0]);
        let name = if is_joined { "#define" } else { &run[0].name };
        Unit::of("c99", name, &texts, lines)
    });
    joined.collect()
}

/// The name declared by an item of Rust or C; the whole line if it declares none.
fn item_name(lines: &[&str]) -> String {
    let mut reader = Reader::default();
    // An attribute of C is a word alone.
    let is_code = |line: &&&str| match reader.read(line) {
        Part::Code => line.trim().contains(' '),
        part => part == Part::Macro,
    };
    let code = lines.iter().find(is_code).map_or("", |line| line.trim());
    let code = match lines {
        [.., last] if code.starts_with("typedef struct") => last.trim_start_matches('}'),
        _ => code,
    };
    if code.starts_with("impl ") {
        return code.to_owned();
    }
    let mut words = code.split(['(', '[', '{', '=', ';', ':', '<']);
    let mut words = words.next().unwrap_or_default().split_whitespace();
    let name = if code.starts_with('#') {
        words.nth(1)
    } else {
        words.next_back()
    };
    name.unwrap_or(code).to_owned()
}

/// Context of a line of code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Code,
    /// A preprocessor's line, or an attribute's.
    Macro,
    Comment,
    /// A string of several lines.
    Text,
}

/// State of the lines read so far.
#[derive(Default)]
struct Reader {
    open: Option<Part>,
}

impl Reader {
    fn read(&mut self, line: &str) -> Part {
        let (text, end) = (line.trim(), |end| line.trim_end().ends_with(end));
        let part = match self.open {
            Some(part) => part,
            None if text.starts_with("//") || text.starts_with("/*") || text.starts_with("#[") => {
                Part::Comment
            }
            None if text.starts_with('#') => Part::Macro,
            None => Part::Code,
        };
        let goes_on = match part {
            Part::Comment => !end("*/") && (self.open.is_some() || text.starts_with("/*")),
            Part::Macro => end("\\"),
            Part::Text => !end("\"#;"),
            Part::Code => false,
        };
        self.open = goes_on.then_some(part);
        if part == Part::Code && text.contains("= r#\"") {
            self.open = Some(Part::Text);
        }
        part
    }
}

/// Statements of code and sentences of its documentation.
fn code_lines(text: &[&str]) -> Vec<String> {
    let (mut lines, mut statement) = (vec![], String::new());
    let mut prose = Prose::default();
    let mut reader = Reader::default();
    for line in text {
        let part = reader.read(line);
        let line = line.trim();
        if part == Part::Comment && !line.starts_with("#[") {
            let words = line.trim_start_matches(['/', '*']).trim_end_matches("*/");
            prose.read(words.trim_end().strip_prefix(' ').unwrap_or(words));
            continue;
        }
        lines.append(&mut prose.finish());
        if part == Part::Comment {
            lines.push(line.to_owned());
            continue;
        }
        if part == Part::Text {
            // The specification, which is the data sheet's.
            continue;
        }
        let space = if statement.is_empty() { "" } else { " " };
        statement = statement + space + line.trim_end_matches(" \\");
        if is_whole(&statement) {
            lines.push(std::mem::take(&mut statement));
        }
    }
    lines.append(&mut prose.finish());
    lines.extend(Some(statement).filter(|statement| !statement.is_empty()));
    if lines.iter().any(|line| line.starts_with("use ")) {
        lines = vec![lines.join(" ")];
    }
    lines.iter().flat_map(|line| by_element(line)).collect()
}

/// A long list, and the tracked words, by element, except a function's head, whose parameters are used in its body; any
/// other line unchanged.
fn by_element(line: &str) -> Vec<String> {
    const LONG: usize = 6;
    let heads = ["fn ", "static inline ", "HEXAGEN_COLD static "];
    let is_sentence = line.ends_with('.');
    if line.ends_with('{') && heads.iter().any(|head| line.starts_with(head)) {
        return vec![];
    }
    let is_list = line.starts_with("use ") || line.contains(": ") && !line.contains('(');
    let elements = line.split_inclusive([',', ':']).map(str::trim);
    let is_rotor = line.starts_with("let Rotor {") || line.starts_with("Rotor {");
    if is_rotor || is_list && !is_sentence && elements.clone().count() > LONG {
        elements
            .filter(|element| !element.is_empty())
            .map(str::to_owned)
            .collect()
    } else {
        vec![line.to_owned()]
    }
}

/// Whether a statement, or an element of a list, is complete.
fn is_whole(statement: &str) -> bool {
    let count = |bracket| statement.matches(bracket).count();
    let is_closed = count('(') == count(')') && count('[') == count(']');
    statement.ends_with([';', '{', '}'])
        || statement.starts_with('#')
        || statement.ends_with(',') && is_closed
        || (statement.ends_with("= [") || statement.ends_with("= &["))
            && !statement.starts_with("let")
}

/// Declarations and stages of a program's text.
fn of_program(text: &str) -> Vec<Unit> {
    let lines: Vec<&str> = text
        .lines()
        .filter(|line| !line.trim().is_empty())
        .collect();
    let name = |line: &str| {
        let mut words = line.split([' ', ':', '(']).filter(|word| !word.is_empty());
        words.next().unwrap_or_default().to_owned()
    };
    let is_operation = |line: &str| line.starts_with("    ");
    let is_declaration = |line: &str| !is_operation(line) && !line.ends_with(':');
    // Constants are one unit, and so are tables, parameters and words of the state.
    let stages = lines.chunk_by(|line, next| {
        is_operation(next)
            || is_declaration(line) && is_declaration(next) && name(line) == name(next)
    });
    stages
        .map(|stage| {
            let lines = stage.iter().map(|line| line.trim().to_owned()).collect();
            Unit::of("ir", &name(stage[0]), stage, lines)
        })
        .collect()
}

/// Sections of a data sheet.
fn of_sheet(text: &str) -> Vec<Unit> {
    let lines: Vec<&str> = text.lines().filter(|line| !line.is_empty()).collect();
    let sections = lines.chunk_by(|_, next| !next.starts_with('#'));
    sections
        .map(|section| {
            let mut prose = Prose::default();
            let mut is_specification = false;
            for line in section {
                is_specification |= line.starts_with("```");
                if is_specification {
                    prose.keep(line);
                } else {
                    prose.read(line);
                }
            }
            Unit::of("datasheet", section[0], section, prose.finish())
        })
        .collect()
}
