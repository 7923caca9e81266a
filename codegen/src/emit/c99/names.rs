//! Names, numbers and comments in emitted C.

use super::super::comment::comments;
use super::super::names::module_name;
use super::layout::WIDTH;
use crate::interface::Interface;
use crate::ir::Program;

/// Keywords of C99 and C++, which may include a header, and names of the included headers.
const KEYWORDS: [&str; 69] = [
    "and",
    "asm",
    "auto",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "class",
    "const",
    "continue",
    "default",
    "delete",
    "do",
    "double",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "inline",
    "int",
    "int16_t",
    "int32_t",
    "int64_t",
    "long",
    "mutable",
    "namespace",
    "new",
    "not",
    "operator",
    "or",
    "private",
    "protected",
    "public",
    "register",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "struct",
    "switch",
    "template",
    "this",
    "throw",
    "true",
    "try",
    "typedef",
    "typename",
    "uint16_t",
    "uint32_t",
    "uint64_t",
    "union",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "while",
    "xor",
    "main",
];

/// Local names, types and functions of every emitted source.
const RESERVED: [&str; 28] = [
    "bus",
    "checked",
    "drive",
    "examine",
    "fault",
    "initial",
    "known",
    "leg",
    "legs",
    "limits",
    "number",
    "observation",
    "rest",
    "result",
    "rotor",
    "sample",
    "signals",
    "state",
    "step",
    "step_at_rest",
    "tell",
    "track",
    "tracked",
    "trip",
    "unfit",
    "units",
    "was_tripped",
    "words",
];

/// Functions that every header declares with the drive's prefix, besides the setters.
const FUNCTIONS: [&str; 13] = [
    "brake",
    "calibrate",
    "coast",
    "hall_offsets",
    "init",
    "precharge",
    "reset",
    "resume",
    "signals",
    "status",
    "step",
    "torque_constant_ratio",
    "trip",
];

/// Other names that a type may not take: headers of the language, and library functions whose names
/// suit a drive.
const STANDARD: [&str; 11] = [
    "abs", "floor", "index", "log", "pow", "round", "signal", "sin", "stdbool", "stdint", "time",
];

/// The names of one drive's header and source.
#[derive(Debug)]
pub(super) struct Names {
    /// `hub_drive` of `HubDrive`: the type, and prefix of every other public name.
    pub prefix: String,
    /// `HUB_DRIVE`
    pub upper: String,
    setters: Vec<String>,
    constants: Vec<String>,
}

impl Names {
    pub(super) fn new(type_name: &str, program: &Program, interface: &Interface) -> Self {
        let mut prefix = module_name(type_name);
        let lists = [&KEYWORDS[..], &RESERVED, &STANDARD];
        let is_taken = lists.iter().any(|list| list.contains(&prefix.as_str()));
        if is_taken || prefix.starts_with("hexagen") {
            prefix.insert_str(0, "drive_");
        }
        let constants = interface.constants.iter();
        let setters = program.setters.iter();
        Self {
            upper: prefix.to_uppercase(),
            prefix,
            setters: setters.map(|(_, setter)| setter.name.clone()).collect(),
            constants: constants.map(|constant| constant.name.clone()).collect(),
        }
    }

    /// `hub_drive_step` of `step`
    pub(super) fn public(&self, name: &str) -> String {
        format!("{}_{name}", self.prefix)
    }

    /// `HUB_DRIVE_V_BUS` of `V_BUS`
    pub(super) fn public_upper(&self, name: &str) -> String {
        format!("{}_{name}", self.upper)
    }

    /// The type of the law's state.
    pub(super) fn state(&self) -> String {
        self.public("state")
    }

    /// The type of what is kept of a trip.
    pub(super) fn trip_record(&self) -> String {
        self.public("trip_record")
    }

    /// The identifier of a signal, state word, input or stage: its name, with an underscore
    /// appended if that is taken.
    pub(super) fn local(&self, name: &str) -> String {
        let is_public = || {
            let rest = name.strip_prefix(&self.prefix);
            rest.is_some_and(|rest| {
                let rest = rest.strip_prefix('_');
                rest.is_none_or(|rest| {
                    ["state", "trip_record"].contains(&rest)
                        || FUNCTIONS.contains(&rest)
                        || self.is_setter(rest)
                })
            })
        };
        if KEYWORDS.contains(&name) || RESERVED.contains(&name) || is_public() {
            format!("{name}_")
        } else {
            name.to_owned()
        }
    }

    /// The identifier of a constant or table of the source.
    pub(super) fn constant(&self, name: &str) -> String {
        let name = name.to_uppercase();
        let rest = name.strip_prefix(&self.upper);
        let rest = rest.and_then(|rest| rest.strip_prefix('_'));
        let is_public = rest.is_some_and(|rest| self.constants.iter().any(|known| known == rest));
        if is_public { format!("{name}_") } else { name }
    }

    fn is_setter(&self, name: &str) -> bool {
        let base = ["_ma", "_mnm", "_rpm"];
        let base = base.iter().find_map(|unit| name.strip_suffix(unit));
        let name = base.unwrap_or(name);
        self.setters.iter().any(|setter| setter == name)
    }

    /// A line of documentation with the names of C.
    fn text(&self, line: &str) -> String {
        let mut parts = line.split('`');
        let mut text = parts.next().unwrap_or_default().to_owned();
        for (number, part) in parts.enumerate() {
            text.push('`');
            // Every other part is between two of them.
            let is_quoted = number % 2 == 0;
            let function = part.strip_suffix("()").unwrap_or(part);
            if is_quoted && (FUNCTIONS.contains(&function) || self.is_setter(function)) {
                text.push_str(&self.public(part));
            } else if is_quoted && self.constants.iter().any(|constant| constant == part) {
                text.push_str(&self.public_upper(part));
            } else {
                text.push_str(if is_quoted { type_name(part) } else { part });
            }
        }
        closed(&text)
    }

    /// A documentation comment.
    pub(super) fn comment<S: AsRef<str>>(&self, indent: &str, lines: &[S]) -> String {
        let lines: Vec<String> = lines.iter().map(|line| self.text(line.as_ref())).collect();
        match lines.as_slice() {
            [] => String::new(),
            [only] if indent.len() + only.chars().count() + 7 <= WIDTH => {
                format!("{indent}/** {only} */\n")
            }
            many => {
                let body = comments(&format!("{indent} *"), WIDTH, many);
                format!("{indent}/**\n{body}{indent} */\n")
            }
        }
    }
}

/// A comment with unchanged lines.
pub(super) fn verbatim(lines: &[String]) -> String {
    let mut text = "/*\n".to_owned();
    for line in lines {
        text.push_str(format!(" * {}", closed(line)).trim_end());
        text.push('\n');
    }
    text + " */\n"
}

/// A text without the ends and begins of comments and without trigraphs.
fn closed(text: &str) -> String {
    text.replace("*/", "* /")
        .replace("/*", "/ *")
        .replace("??", "? ?")
}

/// The C name of a Rust type; other words unchanged.
fn type_name(word: &str) -> &str {
    match word {
        "i8" | "i16" => "int16_t",
        "i32" => "int32_t",
        "hexagen::Supervisor" => "hexagen_supervisor",
        other => other,
    }
}

/// A number of 32 bits.
pub(super) fn number(value: i32) -> String {
    if value == i32::MIN {
        // The literal 2147483648 has a wider type.
        return "(-2147483647 - 1)".to_owned();
    }
    value.to_string()
}

/// A number of 32 bits whose type does not depend on its size.
pub(super) fn typed_number(value: i32) -> String {
    if value == i32::MIN {
        "(-INT32_C(2147483647) - 1)".to_owned()
    } else if value < 0 {
        format!("(-INT32_C({}))", value.unsigned_abs())
    } else {
        format!("INT32_C({value})")
    }
}
