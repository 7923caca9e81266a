//! The header: constants, types, and the heads of the public functions.

use super::super::texts;
use super::drive::{Drive, Method, SIGNALS, VERIFICATION, where_defined};
use super::layout::INDENT;
use super::names::{number, typed_number};
use crate::emit::path::SINGLE;
use crate::interface::{PublicConstant, PublicValue};
use crate::ir::Word;
use std::fmt::Write as _;

impl Drive<'_> {
    /// The whole header.
    pub(super) fn header(&self) -> String {
        let names = self.names;
        let doc = texts::of_type(self.program, self.interface);
        let place = format!("the specification in `{}.c`", names.prefix);
        let doc: Vec<String> = doc
            .iter()
            .map(|line| line.replace("`SPEC`", &place))
            .collect();
        let mut text = names.comment("", &doc);
        let guard = names.public_upper("H");
        let prefix = &names.prefix;
        let _ = write!(
            text,
            "#ifndef {guard}\n#define {guard}\n\n#include \"hexagen.h\"\n\n\
             #if HEXAGEN_ABI != {abi}\n\
             #error \"{prefix}.h and hexagen.h are of different versions of hexagen: take both from one.\"\n\
             #endif\n\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n",
            abi = hexagen_c99::ABI
        );
        let constants = self.interface.constants.iter();
        text.extend(constants.map(|constant| self.constant(constant)));
        text.push_str(&self.types());
        let doc =
            "Files that differ in HEXAGEN_SIGNALS, and so in the size of a drive, do not link.";
        text.push_str(&names.comment("", &[doc]));
        let init = names.public("init");
        let other = format!("#define {init} {init}_with_signals");
        text.push_str(&where_defined(SIGNALS, &other));
        let declare = |method: &Method| {
            let comment = names.comment("", &method.doc);
            format!("{comment}{};\n\n", method.head())
        };
        text.extend(self.methods().iter().map(declare));
        text.push_str(&where_defined(SIGNALS, &declare(&self.signals())));
        let own: String = self.verification().iter().map(declare).collect();
        text.push_str(&where_defined(VERIFICATION, &own));
        text + "#ifdef __cplusplus\n}\n#endif\n\n#endif\n"
    }

    /// A constant: a number, or an array's initialiser.
    fn constant(&self, constant: &PublicConstant) -> String {
        let name = self.names.public_upper(&constant.name);
        let mut doc = constant.doc.clone();
        let row = |row: &[i32]| {
            let numbers: Vec<String> = row.iter().copied().map(number).collect();
            format!("{{ {} }}", numbers.join(", "))
        };
        let rows = |rows: Vec<String>| {
            let rows = rows.join(&format!(", \\\n{INDENT}"));
            format!("{{ \\\n{INDENT}{rows} \\\n}}")
        };
        let value = match &constant.value {
            PublicValue::Integer { value, .. } => value.to_string(),
            PublicValue::Fixed { bits, .. } => typed_number(*bits),
            PublicValue::Vectors { bits, frac_bits } => {
                doc.push(format!(
                    "Initialises an `int32_t [{}][2]`, each number with {frac_bits} fraction bits.",
                    bits.len()
                ));
                rows(bits.iter().map(|vector| row(vector)).collect())
            }
            PublicValue::Integers { values, .. } => {
                doc.push(format!("Initialises an `int16_t [{}]`.", values.len()));
                let lines = values.chunks(16).map(|values| {
                    let values: Vec<String> = values.iter().map(i64::to_string).collect();
                    values.join(", ")
                });
                rows(lines.collect())
            }
            PublicValue::Text(text) => format!("\"{}\"", text.escape_default()),
        };
        format!("{}#define {name} {value}\n\n", self.names.comment("", &doc))
    }

    /// The state, and the drive around it.
    fn types(&self) -> String {
        let names = self.names;
        let mut text = names.comment("", &["State kept from one control period to the next."]);
        text.push_str("typedef struct {\n");
        let mut before = String::new();
        for word in &self.program.states {
            let meaning = meaning(word);
            // Phases of one quantity stand together.
            if meaning != before {
                text.push_str(&names.comment(INDENT, &[&meaning]));
            }
            before = meaning;
            let kind = if word.storage_bits == 16 {
                "uint16_t"
            } else {
                "int32_t"
            };
            let _ = writeln!(text, "{INDENT}{kind} {};", names.local(&word.name));
        }
        let _ = write!(text, "}} {};\n\n", names.state());
        text.push_str(&self.trip_record());
        let doc = "A drive; its fields are private. hexagen.h says which function may be called from where.";
        text.push_str(&names.comment("", &[doc]));
        text.push_str("typedef struct {\n");
        for (demand, field) in SINGLE {
            if let Some(word) = self.program.param(demand) {
                text.push_str(&names.comment(INDENT, &[meaning(word)]));
                let _ = writeln!(text, "{INDENT}volatile int32_t {field};");
            }
        }
        if self.has_bus() {
            let doc = "Bus voltage set by `set_bus()`.";
            text.push_str(&names.comment(INDENT, &[doc]));
            let _ = writeln!(text, "{INDENT}hexagen_bus bus;");
        }
        let state = names.state();
        for (doc, field) in [
            ("Status of the control loop.", "volatile int32_t status"),
            (
                "Owned by the control loop.",
                "hexagen_supervisor supervisor",
            ),
            (
                "State of the law; owned by the control loop.",
                &format!("{state} state"),
            ),
            (
                "Odd: the drive has tripped, and the record is that trip's as long as the number stays.",
                "volatile uint32_t trip_number",
            ),
            (
                "The control period in which it tripped.",
                &format!("volatile {} trip", self.names.trip_record()),
            ),
        ] {
            text.push_str(&names.comment(INDENT, &[doc]));
            let _ = writeln!(text, "{INDENT}{field};");
        }
        let mut signals = names.comment(INDENT, &["Port of the signals."]);
        let _ = write!(signals, "{INDENT}hexagen_port signals;");
        text.push_str(where_defined(SIGNALS, &signals).trim_end());
        text + &format!("\n}} {};\n\n", names.prefix)
    }

    /// What is kept of a trip.
    fn trip_record(&self) -> String {
        let names = self.names;
        let doc = "The control period in which a drive tripped: a step is a function of these words, so it can be computed again from them, bit for bit.";
        let mut text = names.comment("", &[doc]);
        text.push_str("typedef struct {\n");
        let mut field = |doc: &str, field: &str| {
            text.push_str(&names.comment(INDENT, &[doc]));
            let _ = writeln!(text, "{INDENT}{field};");
        };
        field("What was sampled.", "hexagen_sample sample");
        field(
            "The supervisor behind that period: its fault, the offsets of the currents.",
            "hexagen_supervisor supervisor",
        );
        field(
            "The law's state before that period.",
            &format!("{} state", names.state()),
        );
        for (demand, name) in SINGLE {
            if self.program.param(demand).is_some() {
                field(
                    &format!("Set-point word of the {name}."),
                    &format!("int32_t {name}"),
                );
            }
        }
        if self.has_bus() {
            field("Words of the bus voltage.", "int32_t bus[2]");
        }
        text + &format!("}} {};\n\n", names.trip_record())
    }
}

fn meaning(word: &Word) -> String {
    format!("{} In `{}`.", word.doc, word.interval)
}
