//! Faults planted in emitted text: a wrong constant, shift, sign, rounding or comparison.

use crate::options::Drive;
use std::ops::Range;

/// Drives for faults in the text: together they have every stage of a step.
pub const MUTATED: &[Drive] = &[
    Drive {
        kind: "pdcc",
        motor: "trivedi-keshri-660w",
        settings: &[
            ("saturation", "torque_priority"),
            ("hall_capture", "timer"),
            ("emf", "watched"),
        ],
    },
    Drive {
        kind: "pdcc",
        motor: "anaheim-bly341s",
        settings: &[
            ("modulation", "pair"),
            ("saturation", "nearest"),
            ("advance", "1.5"),
            ("v_bus", "measured"),
            ("stall_timeout", "100ms"),
            ("start_up", "short"),
        ],
    },
    Drive {
        kind: "pdcc",
        motor: "estun-emj-04apb22",
        settings: &[
            ("saturation", "keep_angle"),
            ("emf", "model"),
            ("reference", "proportional"),
            ("adc_inverted", "on"),
        ],
    },
    Drive {
        kind: "fcs-mpc",
        motor: "mit-mini-cheetah",
        settings: &[("off_leg", "nominal"), ("v_bus", "measured")],
    },
    Drive {
        kind: "phcc",
        motor: "trivedi-keshri-660w",
        settings: &[("start_up", "brief")],
    },
    Drive {
        kind: "pi-pwm",
        motor: "velineon-3500",
        settings: &[("saturation", "nearest"), ("word", "16")],
    },
];

/// A mutated module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mutant {
    /// Change, and line or table entry.
    pub what: String,
    /// The module's text.
    pub text: String,
}

/// An edit of the text.
#[derive(Clone, Debug)]
struct Edit {
    range: Range<usize>,
    new: String,
}

/// A kind of fault: its name, and a function that lists its places.
type Kind = (&'static str, fn(&str, &[Range<usize>]) -> Vec<Edit>);

const KINDS: &[Kind] = &[
    ("constant one more", |text, code| {
        constants(text, code, |raw| raw + 1)
    }),
    ("constant one less", |text, code| {
        constants(text, code, |raw| raw - 1)
    }),
    ("wrong bit in a constant", |text, code| {
        constants(text, code, |raw| raw ^ 1 << 9)
    }),
    ("table entry one more", table_entries),
    ("shift one more", |text, code| shifts(text, code, 1)),
    ("shift one less", |text, code| shifts(text, code, -1)),
    ("rounded down", |text, code| {
        replaced(text, code, "mul_round(", "::hexagen::arith::mul_floor(")
    }),
    ("right shift one more", right_shifts),
    ("- for +", |text, code| replaced(text, code, " + ", " - ")),
    ("+ for -", |text, code| replaced(text, code, " - ", " + ")),
    ("min for max", |text, code| {
        let near = replaced(text, code, ".greater(", ".lesser(");
        [replaced(text, code, ".max(", ".min("), near].concat()
    }),
    ("max for min", |text, code| {
        let near = replaced(text, code, ".lesser(", ".greater(");
        [replaced(text, code, ".min(", ".max("), near].concat()
    }),
    ("<= for <", |text, code| replaced(text, code, " < ", " <= ")),
    ("< for <=", |text, code| replaced(text, code, " <= ", " < ")),
    ("!= for ==", |text, code| {
        replaced(text, code, " == ", " != ")
    }),
    ("|| for &&", |text, code| {
        replaced(text, code, " && ", " || ")
    }),
    ("branches swapped", swapped_branches),
];

/// Mutants of an emitted drive, `per_kind` of every kind with sites in it, spread evenly.
pub fn mutants(text: &str, per_kind: usize) -> Vec<Mutant> {
    let code = code_lines(text);
    let mut found = vec![];
    for (kind, sites) in KINDS {
        let edits = sites(text, &code);
        let wanted = per_kind.min(edits.len());
        for number in 0..wanted {
            // The middle of each of `wanted` equal parts.
            let Edit { range, new } = &edits[(2 * number + 1) * edits.len() / (2 * wanted)];
            let line = text[..range.start].matches('\n').count();
            let old_line = text.lines().nth(line).unwrap_or_default().trim();
            let place = table_entry(text, range.start).unwrap_or_else(|| format!("`{old_line}`"));
            found.push(Mutant {
                what: format!("{kind}: {place}"),
                text: format!("{}{new}{}", &text[..range.start], &text[range.end..]),
            });
        }
    }
    found
}

/// Lines of the law: its constants, tables, entries and stages, without documentation, interface
/// and signals.
fn code_lines(text: &str) -> Vec<Range<usize>> {
    let mut lines = vec![];
    let (mut start, mut in_step) = (0, true);
    for line in text.split_inclusive('\n') {
        let trimmed = line.trim_start();
        let begins = |starts: &[&str]| starts.iter().any(|start| line.starts_with(start));
        // Items for the user and the runtime are `pub`, the law's are private; of the runtime's
        // input only the functions that it runs are included.
        if begins(&["    pub ", "    impl", "        const ", "        type "]) {
            in_step = false;
        } else if begins(&["    fn ", "    const ", "    static ", "        fn "]) {
            in_step = true;
        }
        if in_step && !trimmed.starts_with("//") && !trimmed.starts_with('#') {
            lines.push(start..start + line.len());
        }
        start += line.len();
    }
    lines
}

fn replaced(text: &str, code: &[Range<usize>], old: &str, new: &str) -> Vec<Edit> {
    let mut edits = vec![];
    for line in code {
        for (at, _) in text[line.clone()].match_indices(old) {
            let start = line.start + at;
            edits.push(Edit {
                range: start..start + old.len(),
                new: new.to_owned(),
            });
        }
    }
    edits
}

/// The number literal at the start of `text`, with its length.
fn literal(text: &str) -> Option<(i64, usize)> {
    let length = text
        .char_indices()
        .take_while(|(at, c)| c.is_ascii_digit() || *c == '_' || (*at == 0 && *c == '-'))
        .count();
    Some((text[..length].replace('_', "").parse().ok()?, length))
}

fn constants(text: &str, code: &[Range<usize>], wrong: impl Fn(i64) -> i64) -> Vec<Edit> {
    const OPEN: &str = ": Word = Word(";
    let sites = code.iter().filter_map(|line| {
        let start = line.start + text[line.clone()].find(OPEN)? + OPEN.len();
        let (raw, length) = literal(&text[start..])?;
        Some(Edit {
            range: start..start + length,
            new: wrong(raw).to_string(),
        })
    });
    sites.collect()
}

/// Name and index of the table entry at this place, with its field in tables of rows, if there is a
/// table.
fn table_entry(text: &str, at: usize) -> Option<String> {
    let declaration = text[..at].rfind("static ")?;
    let (head, entries) = text[declaration..at].split_once("] = [")?;
    if entries.contains(';') {
        return None;
    }
    let name = head.strip_prefix("static ")?.split(':').next()?;
    let Some((rows, row)) = entries.rsplit_once('{') else {
        return Some(format!("{name}[{}]", entries.matches(',').count()));
    };
    let field = row.rsplit([',', '\n']).next()?.trim().strip_suffix(':')?;
    Some(format!("{name}[{}].{field}", rows.matches('{').count()))
}

fn table_entries(text: &str, code: &[Range<usize>]) -> Vec<Edit> {
    let mut edits = vec![];
    for line in code {
        let Some(open) = text[line.clone()].find("] = [") else {
            continue;
        };
        let start = line.start + open + "] = [".len();
        let Some(length) = text[start..].find(']') else {
            continue;
        };
        let entries = &text[start..start + length];
        // A row's entries follow their fields' names.
        let mut at = start;
        for piece in entries.split_inclusive(',') {
            let begin = match piece.rfind(": ") {
                Some(colon) => colon + ": ".len(),
                None => piece.len() - piece.trim_start().len(),
            };
            if let Some((value, size)) = literal(&piece[begin..]) {
                let place = at + begin;
                edits.push(Edit {
                    range: place..place + size,
                    new: (value + 1).to_string(),
                });
            }
            at += piece.len();
        }
    }
    edits
}

/// Calls of `name` in code: the ranges of their arguments.
fn calls(text: &str, code: &[Range<usize>], name: &str) -> Vec<Vec<Range<usize>>> {
    let mut found = vec![];
    for line in code {
        for (at, _) in text[line.clone()].match_indices(name) {
            let start = line.start + at + name.len();
            let (mut depth, mut begin, mut arguments) = (0, start, vec![]);
            for (offset, c) in text[start..].char_indices() {
                let here = start + offset;
                match c {
                    '(' | '[' | '{' => depth += 1,
                    ')' if depth == 0 => {
                        arguments.push(begin..here);
                        break;
                    }
                    ')' | ']' | '}' => depth -= 1,
                    ',' if depth == 0 => {
                        arguments.push(begin..here);
                        begin = here + 1;
                    }
                    _ => {}
                }
            }
            arguments.retain(|argument| !text[argument.clone()].trim().is_empty());
            found.push(arguments);
        }
    }
    found
}

fn shifts(text: &str, code: &[Range<usize>], change: i64) -> Vec<Edit> {
    let arguments = [
        "mul_round(",
        "mul_round_narrow(",
        "mul_floor(",
        "mul_add_floor(",
        "divide(",
        "remainder(",
    ]
    .iter()
    .flat_map(|name| calls(text, code, name))
    .filter_map(|arguments| arguments.last().cloned());
    let mut edits: Vec<Edit> = arguments
        .filter_map(|range| {
            let (shift, _) = literal(text[range.clone()].trim())?;
            Some(Edit {
                range,
                new: format!(" {}", shift + change),
            })
        })
        .collect();
    edits.sort_by_key(|edit| edit.range.start);
    edits
}

fn right_shifts(text: &str, code: &[Range<usize>]) -> Vec<Edit> {
    let sites = replaced(text, code, " >> ", " >> ");
    let edits = sites.into_iter().filter_map(|site| {
        let (shift, length) = literal(&text[site.range.end..])?;
        Some(Edit {
            range: site.range.end..site.range.end + length,
            new: (shift + 1).to_string(),
        })
    });
    edits.collect()
}

fn swapped_branches(text: &str, code: &[Range<usize>]) -> Vec<Edit> {
    let edits = calls(text, code, "select(")
        .into_iter()
        .filter_map(|arguments| {
            let [_, then, otherwise] = arguments.as_slice() else {
                return None;
            };
            Some(Edit {
                range: then.start..otherwise.end,
                new: format!("{},{}", &text[otherwise.clone()], &text[then.clone()]),
            })
        });
    edits.collect()
}

#[cfg(test)]
mod tests {
    use super::mutants;

    const TEXT: &str = "pub struct Drive;\nconst _: () = {\n    /// K - 1 is < 2.\n    const K: Word = Word(1_000);\n    \
        static TABLE: [i8; 2] = [0, -1];\n    static ROWS: [Row; 2] = [\n        Row {\n            first: 1,\n        },\n        Row {\n            \
        first: 2,\n        },\n    ];\n    fn step(a: Word) -> Word {\n        \
        let b = mul_round(K, a - 1, 14) + (a >> 2);\n        select(a < b, a.max(b), b)\n    }\n    \
        impl Drive {\n        pub const T: Word = Word(1);\n    }\n    impl Control for Drive {\n        const SET_POINT: Word = Word(1);\n        \
        fn current(bits: Word) -> Word {\n            bits >> 4\n        }\n    }\n};\n";

    fn changed(kind: &str) -> Vec<String> {
        let all = mutants(TEXT, 9);
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let of_kind = all.iter().filter(|mutant| mutant.what.starts_with(kind));
        of_kind
            .map(|mutant| {
                let (old, new) = (lines(TEXT), lines(&mutant.text));
                let different = old.iter().zip(&new).filter(|(old, new)| old != new);
                different
                    .map(|(_, new)| new.trim().to_owned())
                    .collect::<Vec<_>>()
                    .join("|")
            })
            .collect()
    }

    #[test]
    fn table_entries_are_told_by_name() {
        let all = mutants(TEXT, 9);
        let told = all.iter().map(|mutant| mutant.what.as_str());
        let entries: Vec<&str> = told
            .filter(|what| what.contains("TABLE") || what.contains("ROWS"))
            .collect();
        assert_eq!(
            entries,
            [
                "table entry one more: TABLE[0]",
                "table entry one more: TABLE[1]",
                "table entry one more: ROWS[0].first",
                "table entry one more: ROWS[1].first"
            ]
        );
    }

    #[test]
    fn faults_are_planted_in_code_only() {
        assert_eq!(
            changed("constant one more"),
            ["const K: Word = Word(1001);"]
        );
        assert_eq!(changed("wrong bit"), ["const K: Word = Word(488);"]);
        assert_eq!(
            changed("table"),
            [
                "static TABLE: [i8; 2] = [1, -1];",
                "static TABLE: [i8; 2] = [0, 0];",
                "first: 2,",
                "first: 3,"
            ]
        );
        assert_eq!(
            changed("shift one more"),
            ["let b = mul_round(K, a - 1, 15) + (a >> 2);"]
        );
        assert_eq!(
            changed("rounded down"),
            ["let b = ::hexagen::arith::mul_floor(K, a - 1, 14) + (a >> 2);"]
        );
        assert_eq!(
            changed("right shift"),
            ["let b = mul_round(K, a - 1, 14) + (a >> 3);", "bits >> 5"]
        );
        assert_eq!(
            changed("- for +"),
            ["let b = mul_round(K, a - 1, 14) - (a >> 2);"]
        );
        assert_eq!(
            changed("+ for -"),
            ["let b = mul_round(K, a + 1, 14) + (a >> 2);"]
        );
        assert_eq!(changed("min for max"), ["select(a < b, a.min(b), b)"]);
        assert_eq!(changed("<= for <"), ["select(a <= b, a.max(b), b)"]);
        assert_eq!(changed("branches"), ["select(a < b, b, a.max(b))"]);
    }
}
