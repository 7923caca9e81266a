//! The data sheet of one controller, in Markdown, from the interface and the verified graph alone:
//! it cannot differ from the code.

use super::times;
use crate::diagnostics::{engineering, rpm, significant};
use crate::interface::{Interface, PublicValue, Rounding};
use crate::ir::{
    Cost, ErrorInterval, Function, Kind, PathCost, Program, Stage, Table, VerifiedGraph, cases,
    live_words,
};

/// The data sheet as Markdown text.
pub fn emit_datasheet(graph: &VerifiedGraph, interface: &Interface) -> String {
    let program = graph.program();
    let mut sheet = Sheet::default();
    sheet.heading(1, &interface.type_name);
    sheet.lines(&interface.doc);
    sheet.heading(2, "Derived values");
    sheet.lines(&interface.header);
    envelope(&mut sheet, interface);
    options(&mut sheet, interface);
    constants_of_the_type(&mut sheet, interface);
    formats(&mut sheet, interface);
    constants_of_the_step(&mut sheet, program);
    memory(&mut sheet, program);
    operations(&mut sheet, program);
    sheet.heading(2, "Time of a step");
    sheet.lines(&times::list(interface.times.iter()));
    ranges(&mut sheet, program);
    decisions(&mut sheet, program);
    sheet.heading(2, "Specification");
    sheet.line("```toml");
    sheet.line(interface.spec_toml.trim_end());
    sheet.line("```");
    sheet.text
}

/// Markdown under construction.
#[derive(Default)]
struct Sheet {
    text: String,
}

impl Sheet {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn heading(&mut self, level: usize, title: &str) {
        if !self.text.is_empty() {
            self.text.push('\n');
        }
        self.line(&format!("{} {title}\n", "#".repeat(level)));
    }

    /// Documentation lines; their headings go two levels down, under those of the sheet.
    fn lines(&mut self, lines: &[String]) {
        for line in lines {
            let deeper = if line.starts_with('#') {
                format!("##{line}")
            } else {
                line.clone()
            };
            self.line(&deeper);
        }
    }

    fn table<const N: usize>(&mut self, columns: [&str; N]) {
        self.row(columns.map(str::to_owned));
        self.line(&format!("|{}", "---|".repeat(N)));
    }

    fn row<const N: usize>(&mut self, cells: [String; N]) {
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        self.line(&format!("| {} |", cells.join(" | ")));
    }
}

fn envelope(sheet: &mut Sheet, interface: &Interface) {
    sheet.heading(2, "Envelope");
    sheet.line(
        "Greatest motoring torque for which the nominal bus drives the whole shape of the current; beyond it the torque ripples, then falls.\n",
    );
    sheet.table(["speed", "torque"]);
    for [omega_m, torque] in &interface.envelope {
        sheet.row([rpm(*omega_m), engineering(*torque, "Nm")]);
    }
}

fn options(sheet: &mut Sheet, interface: &Interface) {
    sheet.heading(2, "Options of the controller");
    sheet.line("In SI units and time-outs in control periods, defaults included; an option not listed is off or has no effect here. Where a rule chose the value of one that was not stated, its reason stands there.\n");
    sheet.table(["option", "value", "chosen by a rule because", "meaning"]);
    for option in &interface.options {
        sheet.row([
            format!("`{}`", option.name),
            option.value.replace('"', ""),
            option.reason.unwrap_or_default().to_owned(),
            format!("{}.", option.meaning),
        ]);
    }
}

fn constants_of_the_type(sheet: &mut Sheet, interface: &Interface) {
    sheet.heading(2, "Constants of the type");
    sheet.table(["name", "value", "meaning"]);
    for constant in &interface.constants {
        let value = public_value(&constant.value);
        sheet.row([
            format!("`{}`", constant.name),
            value,
            paragraph(&constant.doc),
        ]);
    }
}

/// Decisions on inexact values, with their tie bands over all cases.
fn decisions(sheet: &mut Sheet, program: &Program) {
    let step = &program.step;
    let cases = cases(program, step);
    let bands: Vec<(&str, ErrorInterval)> = step
        .values()
        .filter(|value| !step.node(*value).name.is_empty())
        .filter_map(|value| {
            let bands = cases.iter().filter_map(|case| case.bounds.band(value));
            let band = bands.reduce(ErrorInterval::union)?;
            Some((step.node(value).name.as_str(), band))
        })
        .collect();
    if bands.is_empty() {
        return;
    }
    sheet.heading(2, "Decisions on rounded values");
    sheet.line(
        "Each equals that of the ideal step unless the compared values are within its tie band.\n",
    );
    sheet.table(["decision", "tie band, words"]);
    for (name, band) in bands {
        let text = if band.is_unbounded() {
            "not bounded".to_owned()
        } else {
            significant(band.magnitude())
        };
        sheet.row([format!("`{name}`"), text]);
    }
}

fn public_value(value: &PublicValue) -> String {
    match value {
        PublicValue::Integer { value, .. } => value.to_string(),
        PublicValue::Fixed { bits, frac_bits } => decimal(*bits, *frac_bits),
        PublicValue::Vectors { bits, frac_bits } => {
            let vectors: Vec<String> = bits
                .iter()
                .map(|[alpha, beta]| {
                    format!(
                        "({}, {})",
                        decimal(*alpha, *frac_bits),
                        decimal(*beta, *frac_bits)
                    )
                })
                .collect();
            vectors.join(", ")
        }
        PublicValue::Integers { values, .. } => {
            let values: Vec<String> = values.iter().map(ToString::to_string).collect();
            values.join(", ")
        }
        PublicValue::Text(text) => text.clone(),
    }
}

/// A fixed-point number in decimals, down to its ulp, at most nine.
fn decimal(bits: i32, frac_bits: u32) -> String {
    let decimals = (frac_bits * 3 / 10).min(9) as usize;
    let text = format!(
        "{:.decimals$}",
        f64::from(bits) / f64::from(frac_bits).exp2()
    );
    if decimals == 0 {
        text
    } else {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

fn formats(sheet: &mut Sheet, interface: &Interface) {
    sheet.heading(2, "Formats");
    sheet.line("For signals, the bits of their state words; within a step all are 32-bit words.\n");
    sheet.table([
        "signal, coefficient or table",
        "format",
        "rounding",
        "meaning",
    ]);
    for entry in &interface.formats {
        let rounding = match entry.rounding {
            Rounding::Floor => "floor",
            Rounding::RoundHalfUp => "round half up",
        };
        sheet.row([
            format!("`{}`", entry.name),
            format!("i{}, {} fraction bits", entry.storage_bits, entry.frac_bits),
            rounding.to_owned(),
            entry.meaning.clone(),
        ]);
    }
}

fn constants_of_the_step(sheet: &mut Sheet, program: &Program) {
    sheet.heading(2, "Constants of the step");
    sheet.table(["name", "raw", "meaning"]);
    for constant in &program.constants {
        sheet.row([
            format!("`{}`", constant.name),
            constant.raw.to_string(),
            paragraph(&constant.doc),
        ]);
    }
    for table in &program.tables {
        let name = format!("`{}[{}]`", table.name, table.values.len());
        sheet.row([name, entries(table), paragraph(&table.doc)]);
    }
}

/// The entries of a short table; the range of a long one.
fn entries(table: &Table) -> String {
    if table.values.len() <= 16 {
        let values: Vec<String> = table.values.iter().map(ToString::to_string).collect();
        values.join(", ")
    } else {
        format!("in {}", table.interval())
    }
}

/// The storage type of a word of `bits`.
fn storage(bits: u32) -> &'static str {
    if bits == 16 { "u16" } else { "i32" }
}

fn memory(sheet: &mut Sheet, program: &Program) {
    // Fields are in the order of least size; the total is padded to the alignment of the largest
    // word.
    let bytes = || program.states.iter().map(|word| word.storage_bits / 8);
    let state = bytes()
        .sum::<u32>()
        .next_multiple_of(bytes().max().unwrap_or(1));
    let tables = super::rows::bytes(program);
    sheet.heading(2, "Memory");
    sheet.line(&format!(
        "State of the law: {} words in {state} bytes, padding included. Supervisor and set-point are the runtime's.",
        program.states.len()
    ));
    sheet.line(&format!("Tables, in flash: {tables} bytes."));
    sheet.line(&format!(
        "Stack: at most {} words are alive at once in a step (registers included).\n",
        live_words(&program.step)
    ));
    sheet.table(["word", "stored as", "initially", "range", "meaning"]);
    for word in program.words() {
        sheet.row([
            format!("`{}`", word.name),
            storage(word.storage_bits).to_owned(),
            word.initial.to_string(),
            word.interval.to_string(),
            word.doc.clone(),
        ]);
    }
}

fn operations(sheet: &mut Sheet, program: &Program) {
    sheet.heading(2, "Operations");
    sheet.table([
        "stage",
        "runs",
        "additions",
        "multiplications",
        "comparisons",
        "look-ups",
        "divisions",
    ]);
    let step = &program.step;
    for stage in &step.stages {
        row_of_costs(
            sheet,
            &format!("`{}`", stage.name),
            &runs(step, stage),
            Cost::of_stage(step, stage),
        );
    }
    let cost = PathCost::of_function(step);
    row_of_costs(sheet, "step, normal path", "", cost.normal);
    row_of_costs(sheet, "step, worst case", "", cost.worst);
    for (_, setter) in &program.setters {
        row_of_costs(
            sheet,
            &format!("`{}`", setter.name),
            "outside the step",
            PathCost::of_function(setter).worst,
        );
    }
}

fn runs(function: &Function, stage: &Stage) -> String {
    match &stage.guard {
        None => "always".to_owned(),
        Some(guard) => {
            let path = if guard.rare {
                "off the normal path, "
            } else {
                ""
            };
            format!("{path}if `{}`", function.node(guard.condition).name)
        }
    }
}

fn row_of_costs(sheet: &mut Sheet, name: &str, runs: &str, cost: Cost) {
    let counts = [
        cost.additions,
        cost.multiplications,
        cost.comparisons,
        cost.lookups,
        cost.divisions,
    ];
    let [additions, multiplications, comparisons, lookups, divisions] =
        counts.map(|count| count.to_string());
    sheet.row([
        name.to_owned(),
        runs.to_owned(),
        additions,
        multiplications,
        comparisons,
        lookups,
        divisions,
    ]);
}

/// Proven ranges of the step's inputs and of all words that have a name.
fn ranges(sheet: &mut Sheet, program: &Program) {
    let step = &program.step;
    sheet.heading(2, "Proven ranges");
    sheet.line("All named words of the step, for any input and any state within its range.\n");
    sheet.table(["stage", "words"]);
    for stage in &step.stages {
        let joins = stage
            .guard
            .iter()
            .flat_map(|guard| guard.joins.iter().map(|join| join.index()));
        let words: Vec<String> = (stage.first..stage.end)
            .chain(joins)
            .map(|index| &step.nodes[index])
            .filter(|node| node.kind == Kind::Word && !node.name.is_empty())
            .map(|node| format!("`{}` {}", node.name, node.interval))
            .collect();
        if !words.is_empty() {
            sheet.row([format!("`{}`", stage.name), words.join(", ")]);
        }
    }
}

/// Documentation lines as one paragraph.
fn paragraph(lines: &[String]) -> String {
    let lines: Vec<&str> = lines
        .iter()
        .map(String::as_str)
        .filter(|line| !line.is_empty())
        .collect();
    lines.join(" ")
}

#[cfg(test)]
mod tests {
    use super::decimal;

    #[test]
    fn fixed_point_numbers_show_no_more_than_they_hold() {
        assert_eq!(decimal(48 << 24, 24), "48");
        assert_eq!(decimal(3, 1), "2");
        assert_eq!(decimal(-(1 << 29), 30), "-0.5");
    }
}
