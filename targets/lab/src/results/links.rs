//! What of the emitted code follows from each field of the specification.
//!
//! Nobody states it: each field is changed a little, the code is emitted again, and what differs
//! follows from the field. So it holds for this motor and cannot go stale. Fields that the file
//! leaves to their defaults are changed likewise ([`super::unstated`]).

use super::unstated::{self, unstated};
use crate::engine::SelectedMotor;
use hexagen_codegen::emit::rust::{Surface, emit_rust, readable_rust};
use hexagen_codegen::pipeline::generate;
use hexagen_codegen::spec::ast::{Number, Value};
use hexagen_codegen::spec::{KINDS, Kind, Rule, SpecAst, apply_variant, check};
use std::ops::Range;

/// A piece of emitted code with a name: a constant, a table or a function. Types have no formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// Its name.
    pub name: String,
    /// Its documentation, one paragraph.
    pub text: String,
    /// Its lines, without those of its documentation.
    pub lines: Range<usize>,
}

/// A field of the specification with what follows from it.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldLinks {
    /// `motor`, `inverter` or `controller`.
    pub section: &'static str,
    /// Its name.
    pub name: String,
    /// Its value as written, or as the default would be written.
    pub value: String,
    /// Who states it.
    pub origin: Origin,
    /// Places of the items of the emitted code that differ once the field does.
    pub items: Vec<usize>,
}

/// Who states a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The motor's file.
    File,
    /// The board's file.
    Board,
    /// Nobody: it is the default.
    Default,
}

/// Constants whose documentation is the trait's. (The trait's others are texts about the code.)
const OF_TRAIT: [(&str, &str); 2] = [
    ("LIMITS", "Limits of samples, set-point and times."),
    ("UNITS", "Factors between words and SI units."),
];

/// The items of emitted Rust that have a documentation, in order.
pub fn items(rust: &str) -> Vec<Item> {
    let lines: Vec<&str> = rust.lines().collect();
    let mut found = Vec::new();
    let mut doc: Vec<&str> = Vec::new();
    for (place, line) in lines.iter().map(|line| line.trim()).enumerate() {
        if let Some(text) = line.strip_prefix("///") {
            doc.push(text.trim());
        } else if line.starts_with("#[") {
            // Attributes stand between documentation and item.
        } else {
            if let Some(name) = item_name(line) {
                let of_trait = OF_TRAIT.iter().find(|(of, _)| *of == name);
                if let Some((_, text)) = of_trait.filter(|_| doc.is_empty()) {
                    doc.push(text);
                }
                if !doc.is_empty() {
                    found.push(Item {
                        name: name.to_owned(),
                        text: doc.join(" "),
                        lines: place..place + length(&lines[place..]),
                    });
                }
            }
            doc.clear();
        }
    }
    found
}

/// The name of the item that begins in a line.
fn item_name(line: &str) -> Option<&str> {
    let line = line.strip_prefix("pub ").unwrap_or(line);
    let kinds = ["const ", "static ", "fn "];
    let rest = kinds.iter().find_map(|kind| line.strip_prefix(kind))?;
    let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
    Some(&rest[..end.unwrap_or(rest.len())])
}

/// Number of lines of the item that begins here: up to where its brackets are closed.
fn length(lines: &[&str]) -> usize {
    let mut depth = 0_i32;
    for (place, line) in lines.iter().enumerate() {
        for letter in line.chars() {
            match letter {
                '(' | '[' | '{' => depth += 1,
                ')' | ']' | '}' => depth -= 1,
                _ => {}
            }
        }
        if depth == 0 && line.ends_with([';', '}']) {
            return place + 1;
        }
    }
    lines.len()
}

/// All fields of a motor file and of its board with what follows from each in its controller's code,
/// and those that they leave to their defaults, section by section.
pub fn links(motor: &SelectedMotor, rust: &str) -> Vec<FieldLinks> {
    let ast = &motor.ast;
    let mut fields = Vec::new();
    for (section, of) in sections(ast) {
        for field in of.fields.iter().filter(|field| field.name != "description") {
            let changed = changes(section, &field.name, &field.value, ast);
            let value = text(&field.value);
            fields.push((section, field.name.clone(), value, Origin::File, changed));
        }
        match section {
            "controller" => fields.extend(defaults(ast)),
            "inverter" => {
                fields.extend(of_board(ast));
                fields.extend(unstated_of(section, ast));
            }
            _ => fields.extend(unstated_of(section, ast)),
        }
    }
    let linked = fields.into_iter();
    let linked = linked.map(|(section, name, value, origin, changed)| FieldLinks {
        section,
        name,
        value,
        origin,
        items: changed
            .iter()
            .find_map(|ast| differing(ast, rust))
            .unwrap_or_default(),
    });
    linked.collect()
}

/// The board's fields that the motor file does not replace.
fn of_board(ast: &SpecAst) -> Vec<Changed> {
    let file = ast.board.as_ref().and_then(|board| board.file.as_ref());
    let fields = file.iter().flat_map(|file| &file.inverter.fields);
    let fields = fields.filter(|field| ast.inverter.field(&field.name).is_none());
    let changed = fields.map(|field| {
        let mut stated = ast.clone();
        stated.inverter.fields.push(field.clone());
        let others = changes("inverter", &field.name, &field.value, &stated);
        let value = text(&field.value);
        ("inverter", field.name.clone(), value, Origin::Board, others)
    });
    changed.collect()
}

/// The fields of motor or inverter that the file leaves to their defaults.
fn unstated_of(section: &'static str, ast: &SpecAst) -> Vec<Changed> {
    let Ok((spec, _)) = check(ast) else {
        return Vec::new();
    };
    let all = unstated(&spec).into_iter();
    let of_section = all.filter(|field| field.section == section && !field.is_stated_in(ast));
    let changed = of_section.map(|field| {
        let others = if let Some(other) = &field.other {
            vec![unstated::stating(ast, section, other)]
        } else {
            let stated = field.stated(ast);
            let value = &stated_value(&stated, section, field.name);
            changes(section, field.name, value, &stated)
        };
        let name = field.name.to_owned();
        (section, name, field.value, Origin::Default, others)
    });
    changed.collect()
}

/// The value of a field that is there.
fn stated_value(ast: &SpecAst, section: &str, name: &str) -> Value {
    let mut all = sections(ast).into_iter();
    let of = all.find(|(of, _)| *of == section).map(|(_, of)| of);
    let field = of.and_then(|of| of.field(name));
    field.map_or(Value::Integers(Vec::new()), |field| field.value.clone())
}

/// A field: section, name, value, who states it, and specifications that differ in it.
type Changed = (&'static str, String, String, Origin, Vec<SpecAst>);

/// The options of the controller that the file leaves to their defaults.
fn defaults(ast: &SpecAst) -> Vec<Changed> {
    let Some(Value::Word(kind)) = value_of(ast, "kind") else {
        return Vec::new();
    };
    let Some(of) = KINDS.iter().find(|of| of.name == kind) else {
        return Vec::new();
    };
    let rules = of.rules().into_iter();
    let rules = rules.filter(|rule| value_of(ast, rule.name).is_none());
    let with_default = rules.filter_map(|rule| {
        let preset = rule.preset_value()?;
        let words = rule.words().iter().map(|word| word.word);
        let others = words.filter(|word| *word != preset);
        let changed = others.filter_map(|word| with_option(ast, kind, rule.name, word));
        Some((
            "controller",
            rule.name.to_owned(),
            preset.to_owned(),
            Origin::Default,
            changed.collect(),
        ))
    });
    with_default.collect()
}

fn value_of<'a>(ast: &'a SpecAst, name: &str) -> Option<&'a Value> {
    ast.controller.field(name).map(|field| &field.value)
}

fn with_option(ast: &SpecAst, kind: &str, name: &str, value: &str) -> Option<SpecAst> {
    let mut changed = ast.clone();
    let done = apply_variant(&mut changed, &format!("{kind}:{name}={value}"));
    done.is_ok().then_some(changed)
}

fn sections(ast: &SpecAst) -> [(&'static str, &hexagen_codegen::spec::ast::Section); 3] {
    [
        ("motor", &ast.motor),
        ("inverter", &ast.inverter),
        ("controller", &ast.controller),
    ]
}

/// Words of fields of the motor, which have no table.
const WORDS: [(&str, &[&str]); 2] = [
    ("winding", &["star", "delta"]),
    ("emf_shape", &["trapezoidal", "sinusoidal"]),
];

/// Specifications in which a written field has another value; the nearest first.
fn changes(section: &str, name: &str, value: &Value, ast: &SpecAst) -> Vec<SpecAst> {
    let others: Vec<Value> = match value {
        Value::Number(number) => [1.01, 0.99]
            .into_iter()
            .map(|by| scaled(number, by))
            .collect(),
        Value::Word(_) => {
            let rules = KINDS.iter().flat_map(Kind::rules);
            let words = rules.filter(|rule| rule.name == name).flat_map(Rule::words);
            let words = words.map(|word| word.word);
            let of_motor = WORDS.iter().filter(|(of, _)| *of == name);
            let of_motor = of_motor.flat_map(|(_, words)| *words);
            let words = words.chain(of_motor.copied());
            let others = words.filter(|word| Some(*word) != word_of(value));
            others.map(|word| Value::Word(word.to_owned())).collect()
        }
        // Hall codes of the next sector each.
        Value::Integers(all) if !all.is_empty() => {
            let mut turned = all.clone();
            turned.rotate_left(1);
            vec![Value::Integers(turned)]
        }
        _ => Vec::new(),
    };
    let changed = others.into_iter().map(|value| {
        let mut changed = ast.clone();
        let of = match section {
            "motor" => &mut changed.motor,
            "inverter" => &mut changed.inverter,
            _ => &mut changed.controller,
        };
        for field in of.fields.iter_mut().filter(|field| field.name == name) {
            field.value = value.clone();
        }
        changed
    });
    changed.collect()
}

fn word_of(value: &Value) -> Option<&str> {
    match value {
        Value::Word(word) => Some(word),
        _ => None,
    }
}

/// A number a little off; a whole number is the next one.
fn scaled(number: &Number, by: f64) -> Value {
    let is_whole = number.unit.is_none() && number.value.fract() == 0.0;
    let value = if is_whole {
        number.value + (by - 1.0).signum()
    } else {
        number.value * by
    };
    Value::Number(Number {
        digits: value.to_string(),
        value,
        ..number.clone()
    })
}

/// A value as written in a file.
fn text(value: &Value) -> String {
    match value {
        Value::Number(number) => number.to_string(),
        Value::Word(text) | Value::Text(text) => text.clone(),
        Value::Integers(all) => format!("{all:?}"),
        Value::List(all) => all.iter().map(text).collect::<Vec<_>>().join(", "),
        Value::Malformed(_) => String::new(),
    }
}

/// The items that differ in the code of a changed specification, by their places; `None` if it
/// cannot be generated.
fn differing(changed: &SpecAst, rust: &str) -> Option<Vec<usize>> {
    let (spec, origins) = check(changed).ok()?;
    let generated = generate(&spec, &origins).ok()?;
    let interface = &generated.interface;
    let surface = Surface::public(&interface.type_name);
    let other = readable_rust(&emit_rust(&generated.graph, interface, &surface));
    // A name may be there twice: `V_BUS` in volts for users, and in words.
    let others = bodies(&other);
    let bodies = bodies(rust).into_iter().enumerate();
    let differing = bodies.filter(|(_, body)| !others.contains(body));
    Some(differing.map(|(place, _)| place).collect())
}

/// The items with their code alone: documentation inside of types repeats numbers.
fn bodies(rust: &str) -> Vec<(String, String)> {
    let lines: Vec<&str> = rust.lines().collect();
    let body = |item: &Item| {
        let lines = lines[item.lines.clone()].iter();
        let code = lines.filter(|line| !line.trim_start().starts_with("///"));
        code.copied().collect::<Vec<_>>().join("\n")
    };
    items(rust)
        .iter()
        .map(|item| (item.name.clone(), body(item)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{Origin, differing, items, links, unstated};
    use crate::engine::{PlantOptions, SelectedMotor};
    use hexagen_codegen::spec::check;

    const MOTORS: [&str; 3] = ["trivedi-keshri-660w", "linix-45zwn24-40", "hoverboard-hub"];

    fn motor(name: &str) -> (SelectedMotor, String) {
        let motor = SelectedMotor::find(name, &PlantOptions::default()).expect("is in the library");
        let own = motor.prepare_for_torque(None).expect("generates");
        let rust = own.rust();
        (motor, rust)
    }

    #[test]
    fn a_default_that_is_stated_leaves_the_code_as_it_is() {
        for name in MOTORS {
            let (motor, rust) = motor(name);
            let (spec, _) = check(&motor.ast).expect("is sound");
            for field in unstated(&spec) {
                if field.is_stated_in(&motor.ast) {
                    continue;
                }
                let stated = differing(&field.stated(&motor.ast), &rust);
                let (field, value) = (field.name, field.value);
                assert_eq!(stated, Some(vec![]), "{name}: {field} = {value}");
            }
        }
    }

    #[test]
    fn values_of_a_board_lead_to_their_formulas() {
        let (motor, rust) = motor("hoverboard-hub");
        let links = links(&motor, &rust);
        let items = items(&rust);
        for (name, formula) in [("adc_gain", "GAIN"), ("dead_time", "PULSE_TOP")] {
            let mut of = links.iter().filter(|of| of.name == name);
            let field = of.next().expect("is a field");
            assert_eq!((field.origin, of.next()), (Origin::Board, None), "{name}");
            let names: Vec<&str> = field
                .items
                .iter()
                .map(|k| items[*k].name.as_str())
                .collect();
            assert!(
                names.iter().any(|name| name.contains(formula)),
                "{name}: {names:?}"
            );
        }
    }

    #[test]
    fn defaults_of_motor_and_inverter_lead_to_their_formulas() {
        let (motor, rust) = motor("linix-45zwn24-40");
        let links = links(&motor, &rust);
        let items = items(&rust);
        for (name, formula) in [
            ("trip_current", "TRIP"),
            ("max_current", "MAX"),
            ("hall_codes", "SECTOR"),
            ("adc_offset", "OFFSET"),
            ("maximum_speed", "REV_MIN"),
            ("precharge", "LIMITS"),
            ("offset_tolerance", "LIMITS"),
        ] {
            let of = links.iter().find(|of| of.name == name).expect("is a field");
            assert_eq!(of.origin, Origin::Default, "{name}");
            let names: Vec<&str> = of.items.iter().map(|k| items[*k].name.as_str()).collect();
            assert!(
                names.iter().any(|name| name.contains(formula)),
                "{name}: {names:?}"
            );
        }
    }
}
