//! The public functions: start, step, setters and commands, and what they share.

use super::super::set_point::shared;
use super::super::signal::{Code, Shape};
use super::super::texts;
use super::expression::coded;
use super::interface::Types;
use super::layout::{INDENT, wrapped};
use super::names::{number, typed_number};
use crate::ir::{Function, Word};
use std::fmt::Write as _;

/// A public function: its comment, its head, and the lines of its body.
pub(super) struct Method {
    pub(super) doc: Vec<String>,
    head: String,
    body: Vec<String>,
}

impl Method {
    /// Its head, as declarations and definitions have it.
    pub(super) fn head(&self) -> String {
        wrapped("", &self.head).trim_end().to_owned()
    }
}

impl Types<'_> {
    /// The public functions of the source, behind its static ones.
    pub(super) fn functions(&self) -> String {
        let define = |method: Method| {
            let body = method.body.join("\n");
            format!("{}\n{{\n{body}\n}}\n\n", method.head())
        };
        let all: String = self.methods().into_iter().map(define).collect();
        let own: String = self.verification().into_iter().map(define).collect();
        let verification = self.names.public_upper("VERIFICATION");
        format!("{all}#ifdef {verification}\n{own}#endif /* {verification} */\n")
    }

    /// The public functions.
    pub(super) fn methods(&self) -> Vec<Method> {
        let mut methods = vec![self.init(), self.step()];
        methods.extend(
            self.program
                .setters
                .iter()
                .map(|setter| self.setter(setter)),
        );
        methods.extend(self.commands());
        methods
    }

    fn drive(&self) -> String {
        format!("{}_t *drive", self.names.prefix)
    }

    fn init(&self) -> Method {
        let mut body = vec![];
        for group in shared(self.program) {
            let field = format!("drive->set_point.{}", self.names.local(&group.name));
            let initial = |word: &Word| number(word.initial);
            if let [(_, only)] = group.words.as_slice() {
                body.push(format!("{INDENT}{field} = {};", initial(only)));
                continue;
            }
            for bank in 0..2 {
                let words = group.words.iter().enumerate();
                body.extend(words.map(|(place, (_, word))| {
                    format!(
                        "{INDENT}{field}.banks[{bank}][{place}] = {};",
                        initial(word)
                    )
                }));
            }
            body.push(format!("{INDENT}{field}.published = 0;"));
            body.push(format!("{INDENT}{field}.storing = 0;"));
        }
        if self.interface.bus_periods.is_some() {
            body.extend(
                ["bus_told", "bus_left"]
                    .map(|field| format!("{INDENT}drive->set_point.{field} = 0;")),
            );
        }
        body.push(format!("{INDENT}drive->state = initial_state;"));
        body.push(format!("{INDENT}publish(drive);"));
        Method {
            doc: [
                "Makes a drive that controls currents from its first step on, with set-point 0 and nominal current offsets. Before",
                "any other call. Where offsets or bootstrap capacitors need it, `calibrate()` comes before the first step.",
            ]
            .map(str::to_owned)
            .to_vec(),
            head: format!("void {}({})", self.names.public("init"), self.drive()),
            body,
        }
    }

    fn step(&self) -> Method {
        let measurements = texts::measurements(self.program, self.interface);
        let typed = measurements.iter();
        let typed = typed.map(|(name, _)| format!("uint16_t {}", self.names.local(name)));
        let parameters: Vec<String> = std::iter::once(self.drive()).chain(typed).collect();
        let mut body = vec![];
        for (name, input) in &measurements {
            if input.is_none() {
                body.push(format!("{INDENT}(void){};", self.names.local(name)));
            }
        }
        let inputs = self.program.step.inputs.iter().map(|input| {
            let name = self.names.local(&input.name);
            // Bits that the specification's hardware does not have are not looked at.
            match u16::try_from(input.interval.high) {
                Ok(most) if most < u16::MAX => format!("(int32_t)({name} & {most}U)"),
                _ => format!("(int32_t){name}"),
            }
        });
        if self.interface.bus_periods.is_some() {
            body.push(format!("{INDENT}pass_period(&drive->set_point);"));
        }
        let own = ["&drive->state", "&drive->set_point"].map(str::to_owned);
        let arguments: Vec<String> = own.into_iter().chain(inputs).collect();
        let call = wrapped(INDENT, &format!("return step({});", arguments.join(", ")));
        body.push(call.trim_end().to_owned());
        Method {
            doc: texts::step(self.interface, &measurements),
            head: format!(
                "{} {}({})",
                self.names.type_of("legs"),
                self.names.public("step"),
                parameters.join(", ")
            ),
            body,
        }
    }

    fn setter(&self, setter: &Function) -> Method {
        let quantity = setter.name.strip_prefix("set_").unwrap_or_default();
        let is_quantity = ["current", "torque", "speed"].contains(&quantity);
        let mut doc = setter.doc.clone();
        let mut parameters = vec![self.drive()];
        let mut arguments = vec!["&drive->set_point".to_owned()];
        for input in &setter.inputs {
            let is_narrow = input.interval.low >= 0 && input.interval.high <= i64::from(u16::MAX);
            let kind = if is_narrow { "uint16_t" } else { "int32_t" };
            let name = if is_quantity {
                doc.extend([
                    String::new(),
                    format!("`{quantity}` has 16 fraction bits: 65536 is one."),
                ]);
                quantity.to_owned()
            } else {
                self.names.local(&input.name)
            };
            parameters.push(format!("{kind} {name}"));
            arguments.push(name);
        }
        Method {
            doc,
            head: format!(
                "void {}({})",
                self.names.public(&setter.name),
                parameters.join(", ")
            ),
            body: vec![format!(
                "{INDENT}{}({});",
                self.names.local(&setter.name),
                arguments.join(", ")
            )],
        }
    }

    /// What the owner of a drive does besides stepping.
    fn commands(&self) -> [Method; 6] {
        let names = self.names;
        let (drive, status) = (self.drive(), names.type_of("status"));
        let line = |text: &str| format!("{INDENT}{text}");
        let inner = |text: &str| format!("{INDENT}{INDENT}{text}");
        let mode = |code| coded(code, names);
        let command = |name: &str, doc: Vec<String>, body: Vec<String>| Method {
            doc,
            head: format!("void {}({drive})", names.public(name)),
            body: body.into_iter().chain([line("publish(drive);")]).collect(),
        };
        let offsets = ["offset_a", "offset_b"].into_iter();
        let offsets: Vec<&str> = offsets.filter(|name| self.word(name).is_some()).collect();
        let mut reset = vec![
            line(&format!(
                "{} *const state = &drive->state;",
                names.type_of("state")
            )),
            wrapped(
                INDENT,
                &format!(
                    "if (state->mode == {} || state->mode == {}) {{",
                    mode(Code::Run),
                    mode(Code::Tripped)
                ),
            )
            .trim_end()
            .to_owned(),
        ];
        reset.extend(
            offsets
                .iter()
                .map(|name| inner(&format!("const int32_t {name} = state->{name};"))),
        );
        reset.push(inner("*state = initial_state;"));
        reset.extend(offsets.iter().map(|name| {
            let is_narrow = self.word(name).is_some_and(|word| word.storage_bits == 16);
            let cast = if is_narrow { "(uint16_t)" } else { "" };
            inner(&format!("state->{name} = {cast}{name};"))
        }));
        reset.push(line("}"));
        let mut calibrate = vec![line(&format!(
            "if (drive->state.mode != {}) {{",
            mode(Code::Tripped)
        ))];
        calibrate.push(inner(&format!(
            "drive->state.mode = {};",
            mode(Code::Calibrate)
        )));
        let (_, samples) = self.own_constant(&self.calibration());
        calibrate.push(inner(&self.assign("countdown", &samples)));
        calibrate.extend(["sum_a", "sum_b"].map(|name| inner(&self.assign(name, "0"))));
        calibrate.push(line("}"));
        let periods = self.interface.precharge_periods;
        let precharge = if periods == 0 {
            vec![]
        } else {
            vec![
                wrapped(
                    INDENT,
                    &format!(
                        "if (drive->state.mode == {} || drive->state.mode == {}) {{",
                        mode(Code::Run),
                        mode(Code::Precharge)
                    ),
                )
                .trim_end()
                .to_owned(),
                inner(&format!("drive->state.mode = {};", mode(Code::Precharge))),
                inner(&self.assign("countdown", &self.own_constant(&self.charging()).1)),
                line("}"),
            ]
        };
        let read = |kind: &str, name: &str, doc: &str, body: &[&str]| Method {
            doc: vec![doc.to_owned()],
            head: format!("{kind} {}(const {drive})", names.public(name)),
            body: body.iter().copied().map(line).collect(),
        };
        let own_status = format!("{}(drive)", names.public("status"));
        let bus_is_stale = self
            .interface
            .bus_periods
            .map(|_| "status.bus_is_stale = drive->set_point.bus_left == 0;");
        let mut status_body = vec![
            "const uint32_t word = drive->set_point.status;".to_owned(),
            format!("{status} status;"),
            format!("status.mode = ({})(word & 0xffffU);", names.type_of("mode")),
            format!("status.fault = ({})(word >> 16);", names.type_of("fault")),
        ];
        status_body.extend(bus_is_stale.map(str::to_owned));
        status_body.push("return status;".to_owned());
        let status_body: Vec<&str> = status_body.iter().map(String::as_str).collect();
        let running = format!("return {own_status}.mode == {};", mode(Code::Run));
        [
            command(
                "reset",
                vec![
                    "Clears a trip and all control state; keeps calibrated offsets and the set-point, at which the next step".to_owned(),
                    "goes on. Ignored while calibrating and pre-charging.".to_owned(),
                ],
                reset,
            ),
            command("calibrate", vec![texts::calibrate(self.interface)], calibrate),
            command("precharge", vec![texts::precharge(self.interface)], precharge),
            read(
                &status,
                "status",
                "What the drive is doing, and what tripped it: from any context.",
                &status_body,
            ),
            read(
                &names.type_of("fault"),
                "fault",
                "What tripped the drive: from any context.",
                &[&format!("return {own_status}.fault;")],
            ),
            read(
                "bool",
                "is_running",
                "Whether currents are controlled, neither calibrating, pre-charging nor tripped: from any context.",
                &[&running],
            ),
        ]
    }

    /// What a bit-for-bit comparison reads and writes.
    pub(super) fn verification(&self) -> [Method; 2] {
        let names = self.names;
        let states = &self.program.states;
        let list: Vec<&str> = states.iter().map(|word| word.name.as_str()).collect();
        let read = states.iter().enumerate().map(|(place, word)| {
            format!(
                "{INDENT}words[{place}] = drive->state.{};",
                names.local(&word.name)
            )
        });
        let write = states.iter().enumerate().map(|(place, word)| {
            let inner = INDENT.repeat(2);
            let cast = if word.storage_bits == 16 {
                "(uint16_t)"
            } else {
                ""
            };
            format!(
                "{INDENT}case {place}:\n{inner}drive->state.{} = {cast}value;\n{inner}break;",
                names.local(&word.name)
            )
        });
        let mut body = vec![format!("{INDENT}switch (index) {{")];
        body.extend(write);
        body.push(format!(
            "{INDENT}default:\n{INDENT}{INDENT}break;\n{INDENT}}}"
        ));
        body.push(format!("{INDENT}publish(drive);"));
        [
            Method {
                doc: vec![
                    format!("Copies the {} state words: {}.", states.len(), list.join(", ")),
                ],
                head: format!(
                    "void {}(const {}, int32_t *words)",
                    names.public("state_words"),
                    self.drive()
                ),
                body: read.collect(),
            },
            Method {
                doc: vec!["Overwrites a state word, by its place among them, with a value inside its range.".to_owned()],
                head: format!(
                    "void {}({}, uint16_t index, int32_t value)",
                    names.public("set_state_word"),
                    self.drive()
                ),
                body,
            },
        ]
    }

    /// What all functions share: the initial state, and small steps between the boundary and words.
    pub(super) fn common(&self) -> String {
        let names = self.names;
        let (leg, legs) = (names.type_of("leg"), names.type_of("legs"));
        let mut text = names.comment("", &["The state of a drive that begins."]);
        let _ = writeln!(
            text,
            "static const {} initial_state = {{",
            names.type_of("state")
        );
        let words = self.program.states.iter().map(|word| {
            let code = Shape::of_state(word).code(word.initial);
            let value = code.map_or_else(|| number(word.initial), |code| coded(code, names));
            format!("{INDENT}.{} = {value}", names.local(&word.name))
        });
        let words: Vec<String> = words.collect();
        let _ = write!(text, "{}\n}};\n\n", words.join(",\n"));
        text.push_str(&names.comment("", &["Mode and fault as one word."]));
        let _ = write!(
            text,
            "static inline uint32_t status_of(const {} *state)\n{{\n\
             {INDENT}return (uint32_t)state->mode | ((uint32_t)state->fault << 16);\n}}\n\n",
            names.type_of("state")
        );
        text.push_str(&names.comment(
            "",
            &["Says what the drive is doing to those who hold the set-point."],
        ));
        let _ = write!(
            text,
            "static inline void publish({})\n{{\n{INDENT}drive->set_point.status = status_of(&drive->state);\n}}\n\n",
            self.drive()
        );
        text.push_str(&self.pass_period());
        text.push_str(&names.comment("", &["All legs alike, without pulses."]));
        let _ = write!(
            text,
            "static inline {legs} legs_at_rest({leg} leg)\n{{\n\
             {INDENT}const {legs} legs = {{ {{ 0, 0, 0 }}, {{ leg, leg, leg }} }};\n{INDENT}return legs;\n}}\n\n"
        );
        text
    }

    /// Where the bus voltage is told, the function that lets it grow older.
    fn pass_period(&self) -> String {
        if self.interface.bus_periods.is_none() {
            return String::new();
        }
        let names = self.names;
        let mut text = names.comment(
            "",
            &[
                "A control period begins: the bus voltage is that much older, and so is a call that replaces words as one and has",
                "not come to its end.",
            ],
        );
        let _ = writeln!(
            text,
            "static inline void pass_period({} *set_point)\n{{",
            names.type_of("set_point")
        );
        let inner = INDENT.repeat(2);
        for group in shared(self.program) {
            if group.words.len() > 1 {
                let field = format!("set_point->{}.storing", names.local(&group.name));
                let _ = writeln!(
                    text,
                    "{INDENT}const int32_t storing = {field};\n\
                     {INDENT}if (storing != 0) {{\n{inner}{field} = storing - 1;\n{INDENT}}}"
                );
            }
        }
        let periods = self.own_constant(&self.freshness()).1;
        let _ = write!(
            text,
            "{INDENT}const int32_t left = set_point->bus_left;\n\
             {INDENT}if (set_point->bus_told != 0) {{\n\
             {inner}set_point->bus_told = 0;\n{inner}set_point->bus_left = {periods};\n\
             {INDENT}}} else if (left != 0) {{\n{inner}set_point->bus_left = left - 1;\n{INDENT}}}\n}}\n\n"
        );
        text
    }

    /// The state of a leg that a word stands for: for sources that ask.
    pub(super) fn leg_of(&self) -> String {
        let [pulsed, low, off] =
            [Code::Pulsed, Code::Low, Code::Off].map(|code| coded(code, self.names));
        let choice =
            format!("return (word == {pulsed}) ? {pulsed} : (word == {low}) ? {low} : {off};");
        let comment = self
            .names
            .comment("", &["The state of a leg that a word stands for."]);
        format!(
            "{comment}static inline {} leg_of(int32_t word)\n{{\n{}}}\n\n",
            self.names.type_of("leg"),
            wrapped(INDENT, &choice)
        )
    }

    fn word(&self, name: &str) -> Option<&Word> {
        self.program.states.iter().find(|word| word.name == name)
    }

    /// The statement that sets a state word.
    fn assign(&self, name: &str, value: &str) -> String {
        format!("drive->state.{} = {value};", self.names.local(name))
    }

    fn calibration(&self) -> OwnConstant {
        OwnConstant {
            name: "calibration_samples",
            value: self.interface.calibration_samples,
            doc: "Samples of the current-offset calibration.",
        }
    }

    fn charging(&self) -> OwnConstant {
        OwnConstant {
            name: "precharge_periods",
            value: self.interface.precharge_periods,
            doc: "Control periods of bootstrap pre-charge.",
        }
    }

    fn freshness(&self) -> OwnConstant {
        OwnConstant {
            name: "bus_periods",
            value: self.interface.bus_periods.unwrap_or_default(),
            doc: "Control periods after which a bus voltage that was told is stale.",
        }
    }

    /// Constants of the functions that the program does not have.
    pub(super) fn own_constants(&self) -> String {
        let all = [self.calibration(), self.charging(), self.freshness()];
        all.iter()
            .map(|constant| self.own_constant(constant).0)
            .collect()
    }

    /// A constant of the functions: its definition, unless the program has it already, and its use.
    fn own_constant(&self, constant: &OwnConstant) -> (String, String) {
        let name = self.names.constant(constant.name);
        let mut constants = self.program.constants.iter();
        let known = constants.find(|known| known.name == constant.name);
        match known.map(|known| known.raw == constant.value) {
            None if constant.value == 0 => (String::new(), name),
            None => {
                let comment = self.names.comment("", &[constant.doc]);
                let value = typed_number(constant.value);
                (format!("{comment}#define {name} {value}\n\n"), name)
            }
            Some(true) => (String::new(), name),
            Some(false) => (String::new(), number(constant.value)),
        }
    }
}

/// A number of the functions around the step.
struct OwnConstant {
    name: &'static str,
    value: i32,
    doc: &'static str,
}
