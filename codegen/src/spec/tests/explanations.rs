//! The explanation of each code shows lines that make it, and lines that are accepted.

use super::diagnostics::{COMPLETE, found_in_file};
use crate::diagnostics::Code;
use crate::spec::fields;

/// What no motor file makes by itself.
const ELSEWHERE: [Code; 6] = [
    Code::UnknownBoard,
    Code::OutsideOfBoard,
    Code::GainUnlikeBoard,
    Code::MotorFile,
    Code::Variant,
    Code::Internal,
];

/// The complete file with some lines: each replaces the field of its name, or is added to the
/// section that takes it. `other`: the lines that they stand in place of.
fn with_lines(lines: &str, other: &str) -> String {
    if !lines.is_empty() && COMPLETE.contains(lines) {
        return COMPLETE.to_owned();
    }
    if lines.is_empty() || (lines.starts_with('[') && COMPLETE.contains(other)) {
        // What is left out, and a section of another name.
        assert!(COMPLETE.contains(other), "{other}");
        let rest = lines.split_once('\n').map_or("", |(_, rest)| rest);
        let head = format!("{other}\n{rest}");
        let kept = if lines.starts_with(other) {
            &head
        } else {
            lines
        };
        return COMPLETE.replacen(other, kept, 1);
    }
    if let Some((head, rest)) = lines.split_once('\n')
        && head.starts_with('[')
    {
        return COMPLETE.replacen(head, &format!("{head}\n{rest}"), 1);
    }
    let mut text = COMPLETE.to_owned();
    let mut added: Vec<&str> = Vec::new();
    for line in lines.lines().filter(|line| !line.starts_with('[')) {
        let name = line.split(" =").next().unwrap_or_default();
        let present = text
            .lines()
            .position(|there| there.starts_with(&format!("{name} =")));
        let mut all: Vec<&str> = text.lines().collect();
        match (present, fields::section_of(name)) {
            (Some(at), _) if !added.contains(&name) => all[at] = line,
            (Some(at), _) => all.insert(at, line),
            (None, Some(section)) => {
                // One of two that say the same.
                for (one, other) in [("adc_gain", "adc_range"), ("speed_constant", "back_emf")] {
                    all.retain(|there| name != one || !there.starts_with(other));
                }
                let head = all
                    .iter()
                    .position(|there| *there == format!("[{section}]"));
                all.insert(head.expect("the section is there") + 1, line);
            }
            (None, None) => {
                // A field that there is not, in place of the one that is meant.
                let meant = other.split(" =").next().unwrap_or_default();
                let at = all.iter().position(|there| there.starts_with(meant));
                all[at.expect("the field is there")] = line;
            }
        }
        added.push(name);
        text = all.join("\n") + "\n";
    }
    text
}

#[test]
fn every_example_makes_its_code_and_its_remedy_does_not() {
    let mut wrongly = Vec::new();
    for code in Code::ALL {
        let told = code.explanation();
        for text in [told.cause, told.remedy] {
            assert!(text.ends_with('.'), "{code}: {text}");
        }
        if ELSEWHERE.contains(code) {
            continue;
        }
        let of = |lines, other| {
            let found = found_in_file(&with_lines(lines, other));
            let codes: Vec<Code> = found.iter().map(|found| found.code).collect();
            codes
        };
        let wrong = of(told.wrong, told.right);
        if !wrong.contains(code) {
            wrongly.push(format!("{code} {}: {wrong:?}", told.wrong));
        }
        // Warnings of something else do no harm to an example of an error.
        let mut right = of(told.right, told.wrong);
        right.retain(|found| code.is_warning() || !found.is_warning());
        if !right.is_empty() {
            wrongly.push(format!("{code} {}: {right:?}", told.right));
        }
    }
    assert_eq!(wrongly, Vec::<String>::new());
}

#[test]
fn each_code_has_an_explanation_of_its_own() {
    for (index, code) in Code::ALL.iter().enumerate() {
        let cause = code.explanation().cause;
        for other in &Code::ALL[..index] {
            assert_ne!(other.explanation().cause, cause, "{other} and {code}");
        }
    }
}

#[test]
fn codes_are_found_by_their_text() {
    for text in [
        "HX0302",
        "hx0302",
        "HX302",
        "302",
        " 0302 ",
        "error[HX0302]:",
    ] {
        assert_eq!(Code::from_text(text), Some(Code::BusTooLow), "{text}");
    }
    for text in ["", "HX", "HX9999", "bus"] {
        assert_eq!(Code::from_text(text), None, "{text}");
    }
}
