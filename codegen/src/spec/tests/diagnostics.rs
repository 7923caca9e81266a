//! The wording and the places of all diagnostics: what a change of a complete specification makes.
//!
//! `deltas/` lists the changes, name and delta a line: `field: text` in place of the field,
//! `+section field: text` at the end of a section, `-field` or `-section` removed, and `old => new`
//! for all else. The snapshots show them with the marked text and the message of what they make.
//! How the compiler renders errors is tested in `tests/ui`.

use crate::diagnostics::{Code, Diagnostic, Diagnostics, Location};
use crate::pipeline::{generate, warnings};
use crate::spec::{SpecAst, check, parse_macro, parse_toml};
use proc_macro2::TokenStream;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// A macro call without errors.
pub(super) const COMPLETE_CALL: &str = "pub Hub {
    motor: {
        pole_pairs: 4,
        resistance: 135 mohm per_phase,
        inductance: 0.22 mH per_phase,
        winding: star,
        back_emf: 0.1648 V/(rad/s) line_to_line peak,
        emf_shape: trapezoidal,
        rated_current: 20 A peak,
        rated_torque: 3.3 Nm,
        rated_speed: 2000 rpm,
    },
    inverter: {
        bus_voltage: 48 V,
        f_pwm: 20 kHz,
        timer_clock: 72 MHz,
        adc_bits: 12,
        adc_range: 40 A,
        current_sensing: in_phase,
    },
    controller: pdcc,
}
";

/// A motor file without errors.
pub(super) const COMPLETE: &str = r#"[motor]
pole_pairs = 4
resistance = "135 mohm per_phase"
inductance = "0.22 mH per_phase"
winding = "star"
back_emf = "0.1648 V/(rad/s) line_to_line peak"
emf_shape = "trapezoidal"
rated_current = "20 A peak"
rated_speed = "2000 rpm"
[inverter]
bus_voltage = "48 V"
f_pwm = "20 kHz"
timer_clock = "72 MHz"
adc_bits = 12
adc_range = "40 A"
current_sensing = "in_phase"
[controller]
kind = "pdcc"
"#;

/// Changes of the complete macro call.
const IN_CALLS: &str = include_str!("deltas/macro.txt");

/// Changes of the complete motor file.
const IN_FILES: &str = include_str!("deltas/file.txt");

/// Name and delta of each case.
fn cases(list: &'static str) -> impl Iterator<Item = (&'static str, &'static str)> {
    let cases = list.lines().map(|line| line.split_once('|'));
    cases
        .map(|case| case.expect("a name and a delta"))
        .map(|(name, delta)| (name.trim(), delta.trim()))
}

/// A complete specification after the changes of a delta.
pub(super) fn changed(complete: &str, delta: &str) -> String {
    delta.split("; ").fold(complete.to_owned(), |text, change| {
        if let Some((old, new)) = change.split_once(" => ") {
            assert!(text.contains(old), "{old} of {delta}");
            text.replacen(old, &new.replace("\\n", "\n"), 1)
        } else if let Some(field) = change.strip_prefix('-') {
            with_entry(&text, field, None)
        } else if let Some(addition) = change.strip_prefix('+') {
            let (section, field) = addition.split_once(' ').expect("a section and a field");
            with_addition(&text, section, field)
        } else {
            let field = change.split([':', ' ']).next().unwrap_or_default();
            with_entry(&text, field, Some(change))
        }
    })
}

/// A specification with another field or section of a name, or with none.
fn with_entry(text: &str, name: &str, entry: Option<&str>) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let is_entry = |line: &&str| {
        let rest = line.trim_start().strip_prefix(name);
        rest.is_some_and(|rest| rest.starts_with([':', ' ']))
    };
    let begin = lines
        .iter()
        .position(is_entry)
        .expect("an entry of this name");
    let end = begin
        + if lines[begin].ends_with('{') {
            length(&lines[begin..])
        } else {
            1
        };
    let indent = lines[begin].len() - lines[begin].trim_start().len();
    let comma = if text.starts_with('[') { "" } else { "," };
    let entry = entry.map(|entry| format!("{:indent$}{entry}{comma}", ""));
    joined(&lines[..begin], entry.as_deref(), &lines[end..])
}

/// A specification with another field at the end of a section.
fn with_addition(text: &str, section: &str, field: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    let heads = [format!("    {section}: {{"), format!("[{section}]")];
    let is_head = |line: &&str| heads.iter().any(|head| head == line);
    let begin = lines
        .iter()
        .position(is_head)
        .expect("a section of this name");
    let is_file = text.starts_with('[');
    let end = begin + length(&lines[begin..]) - usize::from(!is_file);
    let field = if is_file {
        field.to_owned()
    } else {
        format!("        {field},")
    };
    joined(&lines[..end], Some(&field), &lines[end..])
}

/// Number of lines of the section that lines begin with, its closing brace included.
fn length(lines: &[&str]) -> usize {
    let end = |line: &&str| *line == "    }," || line.starts_with('[');
    let end = lines[1..].iter().position(end);
    let is_file = lines[0].starts_with('[');
    end.map_or(lines.len(), |end| end + 1 + usize::from(!is_file))
}

fn joined(before: &[&str], entry: Option<&str>, after: &[&str]) -> String {
    let entry = entry.into_iter().collect::<Vec<_>>();
    let lines = [before, &entry, after, &[""]].concat();
    lines.join("\n")
}

/// What a macro call makes, errors or warnings.
pub(super) fn found_in_call(text: &str) -> Vec<Diagnostic> {
    let tokens = text.parse::<TokenStream>().expect("lexes");
    found(parse_macro(tokens).and_then(|input| input.load(Path::new("nowhere"), &mut vec![])))
}

/// What a motor file makes, errors or warnings.
pub(super) fn found_in_file(text: &str) -> Vec<Diagnostic> {
    found(parse_toml(text, "motors/hub.toml"))
}

fn found(ast: Result<SpecAst, Diagnostics>) -> Vec<Diagnostic> {
    let warnings = ast.and_then(|ast| {
        let (spec, origins) = check(&ast)?;
        let generated = generate(&spec, &origins)?;
        Ok(warnings(&spec, &origins, &generated.interface.times))
    });
    warnings.unwrap_or_else(|errors| errors.into_iter().collect())
}

/// Line and column of a place, and the text that is marked: in a file the rest of the line.
fn place(text: &str, location: &Location) -> String {
    let (line, begin, end) = match location {
        Location::Macro(tokens) => {
            let spans: Vec<_> = tokens
                .clone()
                .into_iter()
                .map(|token| token.span())
                .collect();
            let [first, .., last] = spans.iter().chain(spans.last()).collect::<Vec<_>>()[..] else {
                return "the whole call".to_owned();
            };
            let (first, last) = (first.start(), last.end());
            let is_one_line = first.line == last.line;
            (first.line, first.column, is_one_line.then_some(last.column))
        }
        Location::File { line, column, .. } => (*line, column - 1, None),
        Location::Variant { .. } => unreachable!("no variant is given"),
    };
    let marked = text.lines().nth(line - 1).unwrap_or_default();
    let marked = &marked[begin..end.unwrap_or(marked.len())];
    format!("{line}:{} [{marked}]", begin + 1)
}

/// The cases of a list with what they make.
fn table(list: &'static str, complete: &str, found: fn(&str) -> Vec<Diagnostic>) -> String {
    assert!(
        found(complete).is_empty(),
        "a complete specification has no errors"
    );
    let mut table = String::new();
    let mut line = |text: String| writeln!(table, "{text}").expect("a string takes all");
    for (name, delta) in cases(list) {
        let text = changed(complete, delta);
        let diagnostics = found(&text);
        assert!(!diagnostics.is_empty(), "{name} makes no diagnostic");
        line(format!("{name} | {delta}"));
        for diagnostic in diagnostics {
            let Diagnostic {
                code,
                message,
                location,
                notes,
            } = diagnostic;
            line(format!("    {} {code} {message}", place(&text, &location)));
            for note in notes {
                line(format!(
                    "    {} note: {}",
                    place(&text, &note.location),
                    note.message
                ));
            }
        }
    }
    table
}

#[test]
fn texts_and_places_in_macro_calls() {
    insta::assert_snapshot!("in_calls", table(IN_CALLS, COMPLETE_CALL, found_in_call));
}

#[test]
fn texts_and_places_in_files() {
    insta::assert_snapshot!("in_files", table(IN_FILES, COMPLETE, found_in_file));
}

#[test]
fn every_kind_of_diagnostic_has_a_case() {
    let calls = cases(IN_CALLS).map(|(_, delta)| found_in_call(&changed(COMPLETE_CALL, delta)));
    let seen: BTreeSet<Code> = calls.flatten().map(|found| found.code).collect();
    let unseen = Code::ALL.iter().filter(|code| !seen.contains(code));
    // Of two files (`boards`), of command lines, of hysteresis control beside a low trip level, of a board's sensors, and of the generator's own faults.
    let elsewhere = [
        Code::OutsideOfBoard,
        Code::Variant,
        Code::SwingAboveTrip,
        Code::GainUnlikeBoard,
        Code::Internal,
    ];
    assert_eq!(unseen.copied().collect::<Vec<_>>(), elsewhere);
}

#[test]
fn errors_are_told_at_once_and_in_order() {
    let (_, delta) = cases(IN_CALLS)
        .find(|(name, _)| *name == "several_errors")
        .expect("the case is there");
    let found = found_in_call(&changed(COMPLETE_CALL, delta));
    let codes: Vec<Code> = found.iter().map(|error| error.code).collect();
    assert_eq!(
        codes,
        [
            Code::NotPositive,
            Code::MissingBasis,
            Code::UnknownWord,
            Code::MissingUnit,
            Code::OutOfRange
        ]
    );
}

/// Text that was pasted together at random must never panic, whatever it says.
#[test]
fn garbage_is_refused_without_a_panic() {
    let pieces = [
        "motor",
        ":",
        "{",
        "}",
        "pole_pairs",
        "4",
        ",",
        "-",
        "\"x\"",
        "[1]",
        "controller",
        "pdcc",
        "1e400",
        "V/(rad/s)",
        "per_phase",
        "pub",
        "Hub",
        "(",
        ")",
        "'a'",
        "0x1F",
        "1.5.2",
    ];
    let mut state = 12_345_u64;
    for _ in 0..4000 {
        let mut text = String::from("Hub { ");
        for _ in 0..12 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            text.push_str(pieces[(state >> 33) as usize % pieces.len()]);
            text.push(' ');
        }
        text.push('}');
        if text.parse::<TokenStream>().is_ok() {
            assert!(!found_in_call(&text).is_empty(), "{text}");
        }
    }
}

/// What a remedy says must not lead into the next warning.
#[test]
fn remedies_of_a_bus_that_is_too_low_are_accepted_without_a_warning() {
    let codes = |delta: &str| {
        let found = found_in_call(&changed(COMPLETE_CALL, delta));
        found.iter().map(|found| found.code).collect::<Vec<_>>()
    };
    assert_eq!(codes("bus_voltage: 24 V"), [Code::BusTooLow]);
    assert_eq!(codes("bus_voltage: 44.08 V"), []);
    assert_eq!(codes("bus_voltage: 24 V; rated_speed: 982.4 rpm"), []);
    // A sine drops less between two terminals than two resistances do: 27.2 V of these 29.6 V.
    let sine = "resistance: 620 mohm line_to_line; inductance: 0.1 mH line_to_line; back_emf: 270 rpm/V line_to_line peak; emf_shape: sinusoidal; -rated_torque; rated_current: 30 A peak; rated_speed: 3000 rpm; bus_voltage: 29.6 V; f_pwm: 50 kHz; adc_range: 80 A";
    assert_eq!(codes(sine), []);
}

#[test]
fn an_empty_file_lacks_all_sections() {
    let codes: Vec<Code> = found_in_file("").iter().map(|error| error.code).collect();
    assert_eq!(codes, [Code::MissingSection; 3]);
}

/// A file that was cut or mangled anywhere gives errors or passes, and never panics.
#[test]
fn mangled_files_never_panic() {
    for position in 0..COMPLETE.len() {
        let without = format!("{}{}", &COMPLETE[..position], &COMPLETE[position + 1..]);
        let doubled = format!("{}{}", &COMPLETE[..=position], &COMPLETE[position..]);
        for text in [&COMPLETE[..position], &without, &doubled] {
            // What it finds does not matter.
            let _ = parse_toml(text, "hub.toml").and_then(|ast| check(&ast));
        }
    }
}

/// What a message says to write, as it is written there: nothing else is told then.
#[test]
fn remedies_work_as_they_are_pasted() {
    for (wrong, remedy, right) in [
        (
            "-back_emf; +motor no_load_speed = \"2700 rpm\"; +motor nominal_voltage = \"48 V\"",
            "speed_constant = \"56.25 rpm/V block_mean\"",
            "-back_emf; +motor no_load_speed = \"2700 rpm\"; +motor nominal_voltage = \"48 V\"; +motor {}",
        ),
        (
            "+inverter hall_timer_clock = \"170 MHz\"",
            "`hall_timer_clock` to 1.04 MHz",
            "+inverter hall_timer_clock = \"1.04 MHz\"",
        ),
        (
            "+controller target = \"stm32g431\"; +controller core_clock = \"170 MHz\"",
            "`cortex_m4`",
            "+controller target = \"cortex_m4\"; +controller core_clock = \"170 MHz\"",
        ),
        (
            "+motor rotor = \"angle\"; +motor angle_pole_pairs = 4; +motor angle_lines = 1024",
            "angle_bits = 12",
            "+motor rotor = \"angle\"; +motor angle_pole_pairs = 4; +motor {}",
        ),
        (
            "+motor rotor = \"angle\"; +motor angle_pole_pairs = 4; +motor cpr = 4000",
            "angle_bits = 11",
            "+motor rotor = \"angle\"; +motor angle_pole_pairs = 4; +motor {}",
        ),
    ] {
        let found = found_in_file(&changed(COMPLETE, wrong));
        let [error] = &found[..] else {
            panic!("{wrong}: one error, not {found:?}");
        };
        assert!(error.message.contains(remedy), "{}", error.message);
        let followed = changed(COMPLETE, &right.replace("{}", remedy));
        assert!(found_in_file(&followed).is_empty(), "{followed}");
    }
}

/// A speed above the rated one is refused as least one.
#[test]
fn a_least_speed_above_the_rated_one_is_no_remedy() {
    let told = |clock: &str| {
        let delta = format!("+inverter hall_timer_clock = \"{clock}\"");
        let found = found_in_file(&changed(COMPLETE, &delta));
        found[0].message.clone()
    };
    let far = told("170 MHz");
    assert!(far.contains("lower `hall_timer_clock` to"), "{far}");
    assert!(!far.contains("raise the speed"), "{far}");
    let near = told("3 MHz");
    assert!(near.contains("raise the speed to 115.4 rpm"), "{near}");
}
