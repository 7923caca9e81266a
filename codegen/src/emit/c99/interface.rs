//! The header: constants, types, and the heads of the public functions.

use super::super::set_point::{Shared, shared};
use super::super::signal::Code;
use super::super::texts;
use super::expression::coded;
use super::layout::INDENT;
use super::names::{Names, number, typed_number};
use crate::interface::{Interface, PublicConstant, PublicValue};
use crate::ir::{Program, Word};
use std::fmt::Write as _;

/// What the header and the public functions are emitted from.
pub(super) struct Types<'a> {
    pub program: &'a Program,
    pub interface: &'a Interface,
    pub names: &'a Names,
}

impl Types<'_> {
    /// The whole header.
    pub(super) fn header(&self) -> String {
        let names = self.names;
        let mut text = names.comment("", &texts::header(self.program, self.interface));
        let guard = names.public_upper("H");
        let _ = write!(
            text,
            "#ifndef {guard}\n#define {guard}\n\n#include <stdbool.h>\n#include <stdint.h>\n\n\
             #ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n"
        );
        for constant in &self.interface.constants {
            text.push_str(&self.constant(constant));
        }
        text.push_str(&self.boundary());
        text.push_str(&self.drive_types());
        for method in self.methods() {
            let _ = writeln!(
                text,
                "{}{};\n",
                names.comment("", &method.doc),
                method.head()
            );
        }
        let verification = names.public_upper("VERIFICATION");
        let _ = writeln!(text, "#ifdef {verification}");
        for method in self.verification() {
            let _ = writeln!(
                text,
                "{}{};\n",
                names.comment("", &method.doc),
                method.head()
            );
        }
        let _ = writeln!(
            text,
            "#endif /* {verification} */\n\n#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {guard} */"
        );
        text
    }

    /// A constant: a number, or what initialises an array.
    fn constant(&self, constant: &PublicConstant) -> String {
        let name = self.names.public_upper(&constant.name);
        let mut doc = constant.doc.clone();
        let row = |row: &[i32]| {
            let numbers: Vec<String> = row.iter().copied().map(number).collect();
            format!("{{ {} }}", numbers.join(", "))
        };
        let rows = |rows: Vec<String>| {
            format!(
                "{{ \\\n{INDENT}{} \\\n}}",
                rows.join(&format!(", \\\n{INDENT}"))
            )
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

    /// Modes, faults, legs and the status: the hardware's and the caller's side.
    fn boundary(&self) -> String {
        let enumeration = |kind: &str, doc: &str, codes: &[(Code, &str)]| {
            let mut text = self.names.comment("", &[doc]) + "typedef enum {\n";
            for (number, (code, doc)) in codes.iter().enumerate() {
                text.push_str(&self.names.comment(INDENT, &[doc]));
                let comma = if number + 1 < codes.len() { "," } else { "" };
                let _ = writeln!(
                    text,
                    "{INDENT}{} = {number}{comma}",
                    coded(*code, self.names)
                );
            }
            text + &format!("}} {};\n\n", self.names.type_of(kind))
        };
        let modes = [
            (Code::Run, "Current control."),
            (
                Code::Calibrate,
                "Averaging the current offsets, all legs off.",
            ),
            (
                Code::Precharge,
                "Charging the bootstrap capacitors, all lower switches on.",
            ),
            (Code::Tripped, "Tripped, all legs off, until `reset()`."),
        ];
        let faults = [
            (Code::NoFault, "Not tripped."),
            (
                Code::AdcRange,
                "A current converter was at an end of its range: count 0, the largest count, or more.",
            ),
            (
                Code::OverCurrent,
                "A phase current exceeded the trip level.",
            ),
            (Code::Hall, "The Hall code was 000, 111 or above."),
            (
                Code::Stall,
                "No Hall edge within the stall time-out while a current was demanded.",
            ),
            (
                Code::Offset,
                "A calibrated current offset was too far from its nominal value.",
            ),
        ];
        let legs = [
            (
                Code::Pulsed,
                "Both switches follow the timer channel (complementary outputs).",
            ),
            (
                Code::Low,
                "The lower switch is on for the whole period, the upper one off.",
            ),
            (
                Code::Off,
                "Both switches are off: the leg floats or its diodes conduct.",
            ),
        ];
        let mut text = enumeration("mode", "What a drive is doing.", &modes);
        text.push_str(&enumeration(
            "fault",
            "Why a drive tripped. Latched until `reset()`.",
            &faults,
        ));
        text.push_str(&enumeration(
            "leg",
            "What a leg of the inverter does for one PWM period.",
            &legs,
        ));
        text.push_str(&self.names.comment("", &["What a drive is doing and what tripped it, as of the end of the last control period or call."]));
        let _ = write!(
            text,
            "typedef struct {{\n{INDENT}{} mode;\n{INDENT}{} fault;\n",
            self.names.type_of("mode"),
            self.names.type_of("fault"),
        );
        if let Some(periods) = self.interface.bus_periods {
            let doc = [
                format!(
                    "For {periods} control periods no call of `set_bus` took effect, so the controller goes by an old voltage; from the"
                ),
                "start to the first call by the nominal one. A warning, which trips nothing."
                    .to_owned(),
            ];
            text.push_str(&self.names.comment(INDENT, &doc));
            let _ = writeln!(text, "{INDENT}bool bus_is_stale;");
        }
        let _ = write!(text, "}} {};\n\n", self.names.type_of("status"));
        text.push_str(&self.names.comment(
            "",
            &[
                "The commands of legs a, b, c: compare values for a centre-aligned timer and a state per leg.",
                "",
                "A compare value is the time during which the upper switch is on, in counts, from 0 to the timer's period; it is",
                "0 for a leg that is not pulsed.",
            ],
        ));
        let _ = write!(
            text,
            "typedef struct {{\n{INDENT}uint16_t compare[3];\n{INDENT}{} state[3];\n}} {};\n\n",
            self.names.type_of("leg"),
            self.names.type_of("legs")
        );
        text
    }

    /// Set-point, state, and the drive of both.
    fn drive_types(&self) -> String {
        let names = self.names;
        let shared = shared(self.program);
        let mut text = String::new();
        for group in shared.iter().filter(|group| group.words.len() > 1) {
            let count = group.words.len();
            let mut doc = vec![
                format!(
                    "Words that `set_{}` replaces as one: two banks, of which one is published.",
                    group.name
                ),
                String::new(),
            ];
            let words = group.words.iter().enumerate();
            doc.extend(
                words
                    .map(|(place, (_, word))| format!("{place}. {}: {}", word.name, meaning(word))),
            );
            text.push_str(&names.comment("", &doc));
            let _ = write!(
                text,
                "typedef struct {{\n{INDENT}volatile int32_t banks[2][{count}];\n{INDENT}volatile int32_t published;\n\
                 {INDENT}volatile int32_t storing;\n}} {};\n\n",
                names.type_of(&group.name)
            );
        }
        text.push_str(&names.comment("", &texts::set_point(self.program, &shared)));
        text.push_str("typedef struct {\n");
        for group in &shared {
            text.push_str(&self.shared_field(group));
        }
        if self.interface.bus_periods.is_some() {
            let fields = [
                (
                    "bus_told",
                    "Not 0: `set_bus` took effect since the last control period.",
                ),
                (
                    "bus_left",
                    "Control periods until the bus voltage is stale; the control loop's own.",
                ),
            ];
            for (field, doc) in fields {
                text.push_str(&names.comment(INDENT, &[doc]));
                let _ = writeln!(text, "{INDENT}volatile int32_t {field};");
            }
        }
        text.push_str(&names.comment(
            INDENT,
            &["What the control loop last said: mode in the lower half, fault in the upper one."],
        ));
        let _ = write!(
            text,
            "{INDENT}volatile uint32_t status;\n}} {};\n\n",
            names.type_of("set_point")
        );
        text.push_str(&names.comment(
            "",
            &["What outlives a control period; the control loop's own."],
        ));
        text.push_str("typedef struct {\n");
        for word in &self.program.states {
            text.push_str(&names.comment(INDENT, &[meaning(word)]));
            let kind = if word.storage_bits == 16 {
                "uint16_t"
            } else {
                "int32_t"
            };
            let _ = writeln!(text, "{INDENT}{kind} {};", names.local(&word.name));
        }
        let _ = write!(text, "}} {};\n\n", names.type_of("state"));
        let mut doc = self.interface.doc.clone();
        doc.extend(
            [
                "",
                "# Sharing a drive",
                "",
                "One context, the control interrupt, calls `step()`, and `reset()`, `calibrate()` and `precharge()` where it runs, or",
                "others do while it does not. From all other contexts of the same core: the setters, `status()`, `fault()` and",
                "`is_running()`. A word that passes between them is `volatile int32_t`, and one instruction loads or stores it on a",
                "core of 32 bits and on a C2000; where it takes several, keep the interrupt out around setters and `status()`.",
            ]
            .map(str::to_owned),
        );
        text.push_str(&names.comment("", &doc));
        let _ = write!(
            text,
            "typedef struct {{\n{INDENT}{} set_point;\n{INDENT}{} state;\n}} {}_t;\n\n",
            names.type_of("set_point"),
            names.type_of("state"),
            names.prefix
        );
        text
    }

    fn shared_field(&self, group: &Shared<'_>) -> String {
        let name = self.names.local(&group.name);
        match group.words.as_slice() {
            [(_, only)] => {
                let comment = self.names.comment(INDENT, &[meaning(only)]);
                format!("{comment}{INDENT}volatile int32_t {name};\n")
            }
            _ => format!("{INDENT}{} {name};\n", self.names.type_of(&group.name)),
        }
    }
}

fn meaning(word: &Word) -> String {
    format!("{} In `{}`.", word.doc, word.interval)
}
