//! How names, numbers and comments look in emitted C.

use super::super::names::module_name;
use super::helpers::HELPERS;
use crate::interface::Interface;

/// Words of C99 and of the two headers that emitted code includes.
const KEYWORDS: [&str; 40] = [
    "auto", "bool", "break", "case", "char", "const", "continue", "default", "do", "double",
    "else", "enum", "extern", "false", "float", "for", "goto", "if", "inline", "int", "long",
    "register", "restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch",
    "true", "typedef", "union", "unsigned", "void", "volatile", "while", "int16_t", "int32_t",
    "int64_t",
];

/// Local names and functions of every emitted source.
const RESERVED: [&str; 17] = [
    "bus_left",
    "bus_told",
    "buffer",
    "drive",
    "initial_state",
    "leg_of",
    "legs",
    "legs_at_rest",
    "pass_period",
    "publish",
    "rest",
    "result",
    "set_point",
    "spare",
    "state",
    "status_of",
    "step",
];

/// Functions that every header declares behind the drive's prefix; the setters come besides.
pub(super) const FUNCTIONS: [&str; 8] = [
    "calibrate",
    "fault",
    "init",
    "is_running",
    "precharge",
    "reset",
    "status",
    "step",
];

/// Headers of the language, whose names a drive's own must not take.
const STANDARD: [&str; 2] = ["stdbool", "stdint"];

/// The names of one drive's header and source.
#[derive(Debug)]
pub(super) struct Names {
    /// `hub_drive` of `HubDrive`: begin of every public name.
    pub prefix: String,
    /// `HUB_DRIVE`
    pub upper: String,
    setters: Vec<String>,
    constants: Vec<String>,
}

impl Names {
    pub(super) fn new(type_name: &str, interface: &Interface, setters: Vec<String>) -> Self {
        let mut prefix = module_name(type_name);
        if STANDARD.contains(&prefix.as_str()) {
            prefix.insert_str(0, "drive_");
        }
        let constants = interface.constants.iter();
        Self {
            upper: prefix.to_uppercase(),
            prefix,
            setters,
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

    /// `hub_drive_legs_t` of `legs`
    pub(super) fn type_of(&self, name: &str) -> String {
        format!("{}_{name}_t", self.prefix)
    }

    /// The line before a function off the normal path.
    pub(super) fn cold(&self) -> String {
        self.public_upper("COLD") + "\n"
    }

    /// The identifier of a signal, state word, input or stage: its own name, with an underscore behind it where that
    /// name is taken.
    pub(super) fn local(&self, name: &str) -> String {
        let is_public = || {
            let rest = name.strip_prefix(&self.prefix);
            let rest = rest.and_then(|rest| rest.strip_prefix('_'));
            rest.is_some_and(|rest| FUNCTIONS.contains(&rest) || self.is_setter(rest))
        };
        let is_taken = KEYWORDS.contains(&name)
            || RESERVED.contains(&name)
            || HELPERS.iter().any(|helper| helper.name == name)
            || is_public();
        if is_taken {
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
        self.setters.iter().any(|setter| setter == name)
    }

    /// A line of documentation, with the names that it mentions as they are here.
    fn text(&self, line: &str) -> String {
        let mut parts = line.split('`');
        let mut text = parts.next().unwrap_or_default().to_owned();
        for (number, part) in parts.enumerate() {
            text.push('`');
            // Every other part stands between two of them.
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
        // What would end the comment, begin another one, or spell another sign.
        text.replace("*/", "* /")
            .replace("/*", "/ *")
            .replace("??", "? ?")
    }

    /// A comment of these lines, which documentation tools read.
    pub(super) fn comment<S: AsRef<str>>(&self, indent: &str, lines: &[S]) -> String {
        let lines: Vec<String> = lines.iter().map(|line| self.text(line.as_ref())).collect();
        match lines.as_slice() {
            [] => String::new(),
            [only] => format!("{indent}/** {only} */\n"),
            many => {
                let mut text = format!("{indent}/**\n");
                for line in many {
                    text.push_str(format!("{indent} * {line}").trim_end());
                    text.push('\n');
                }
                text + indent + " */\n"
            }
        }
    }
}

/// A type of Rust that texts name, as C has it; other words as they are.
fn type_name(word: &str) -> &str {
    match word {
        "i8" | "i16" => "int16_t",
        "i32" => "int32_t",
        other => other,
    }
}

/// A number of 32 bits.
pub(super) fn number(value: i32) -> String {
    if value == i32::MIN {
        // The literal 2147483648 is of a wider type.
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
