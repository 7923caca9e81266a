//! The public functions: init, step and setters, from the law and the runtime.

use super::function::{Step, emit_setter};
use super::layout::{INDENT, wrapped};
use super::limits::limits_of;
use super::names::{Names, number, typed_number};
use crate::emit::path::SINGLE;
use crate::interface::{AngleSensor, Interface, Unit, Watch};
use crate::ir::{Demand, Function, Program, Setter};
use std::fmt::Write as _;

/// Input of the header and of the public functions.
pub(super) struct Drive<'a> {
    pub program: &'a Program,
    pub interface: &'a Interface,
    pub names: &'a Names,
    pub step: &'a Step,
}

/// Macro that programs define for observation signals.
pub(super) const SIGNALS: &str = "HEXAGEN_SIGNALS";

/// Macro that bit-for-bit comparisons define.
pub(super) const VERIFICATION: &str = "HEXAGEN_VERIFICATION";

/// Code under `#ifdef symbol`.
pub(super) fn where_defined(symbol: &str, code: &str) -> String {
    format!("#ifdef {symbol}\n{}\n#endif\n\n", code.trim_end())
}

/// A public function.
pub(super) struct Method {
    pub doc: Vec<String>,
    pub head: String,
    pub body: String,
}

impl Method {
    /// Its head, for declaration and definition.
    pub(super) fn head(&self) -> String {
        wrapped("", &self.head).trim_end().to_owned()
    }

    fn definition(&self) -> String {
        format!("{}\n{{\n{}}}\n\n", self.head(), self.body)
    }
}

pub(super) fn lines(lines: &[&str]) -> String {
    lines.iter().map(|line| wrapped(INDENT, line)).collect()
}

pub(super) fn doc(lines: &[&str]) -> Vec<String> {
    lines.iter().map(|&line| line.to_owned()).collect()
}

impl Drive<'_> {
    pub(super) fn has_speed(&self) -> bool {
        self.program.param(Demand::Speed).is_some()
    }

    pub(super) fn has_bus(&self) -> bool {
        self.interface.bus_periods.is_some()
    }

    /// The set-point word that is 0 if nothing is demanded of the motor.
    pub(super) fn demand(&self) -> &'static str {
        if self.has_speed() { "speed" } else { "current" }
    }

    /// Initial value of a set-point word; 0 if the drive does not have it.
    fn initial(&self, demand: Demand) -> String {
        let word = self.program.param(demand);
        number(word.map_or(0, |word| word.initial))
    }

    /// Limits, units and initial state.
    pub(super) fn constants(&self) -> String {
        let Interface { limits, units, .. } = self.interface;
        let (macro_name, arguments) = limits_of(limits);
        let arguments = arguments.into_iter();
        let limits: Vec<String> = arguments
            .map(|(value, name)| format!("{value} /* {name} */"))
            .collect();
        let limits = limits.join(&format!(",\n{INDENT}"));
        let comment = "Limits of samples, and start-up.";
        let mut text = self.names.comment("", &[comment]);
        let _ = write!(text, "{macro_name}(limits,\n{INDENT}{limits});\n\n");

        let mut signals = self.names.comment("", &["Units of the signals."]);
        let sectors = units.sectors.map(|sector| sector.to_string()).join(", ");
        let unit = |unit: Unit| format!("{{ {}, {} }}", number(unit.factor), unit.shift);
        let fields = [
            ("ampere", unit(units.ampere)),
            ("volt", unit(units.volt)),
            ("volt_per_count", unit(units.volt_per_count)),
            ("rpm", unit(units.rpm)),
            ("sectors", format!("{{ {sectors} }}")),
        ];
        let fields = fields.map(|(name, value)| format!("{INDENT}.{name} = {value}"));
        signals.push_str("static const hexagen_units units = {\n");
        signals.push_str(&fields.join(",\n"));
        signals.push_str("\n};\n");
        text.push_str(&where_defined(SIGNALS, &signals));

        let state = self.names.state();
        text.push_str(&self.names.comment("", &["Initial state of the law."]));
        let words = self.program.states.iter().map(|word| {
            let (name, value) = (self.names.local(&word.name), number(word.initial));
            format!("{INDENT}.{name} = {value}")
        });
        let words: Vec<String> = words.collect();
        let _ = writeln!(text, "static const {state} initial = {{");
        text.push_str(&words.join(",\n"));
        text + "\n};\n\n"
    }

    /// The public functions, and the private ones that they call.
    pub(super) fn functions(&self) -> String {
        let mut text = self.examine() + &self.keep_trip() + &self.step_at_rest();
        let setters = self.program.setters.iter();
        text.extend(
            setters.map(|(_, setter)| emit_setter(self.program, setter, self.names).stages),
        );
        let methods = self.methods();
        text.extend(methods.iter().map(Method::definition));
        text.push_str(&where_defined(SIGNALS, &self.signals().definition()));
        let own: String = self.verification().iter().map(Method::definition).collect();
        text.push_str(&where_defined(VERIFICATION, &own));
        text.trim_end().to_owned() + "\n"
    }

    /// The public functions, in the order of the header.
    pub(super) fn methods(&self) -> Vec<Method> {
        let mut methods = vec![self.init(), self.period()];
        for (set, function) in &self.program.setters {
            methods.push(self.setter(*set, function));
            methods.extend(
                (self.interface.torque_ratio)
                    .filter(|_| *set == Setter::Torque)
                    .map(|word| self.torque_constant_ratio(word)),
            );
            methods.extend(self.other_unit(*set));
        }
        methods.extend(self.commands());
        let shifts = self.interface.hall_shifts;
        methods.extend(shifts.map(|words| self.hall_offsets(words)));
        methods
    }

    pub(super) fn drive(&self) -> String {
        format!("{} *drive", self.names.prefix)
    }

    /// A call of an entry of the law; `checked` points to the checked sample.
    fn call(&self, entry: usize, name: &str, checked: &str, rotor: &str) -> String {
        let arguments = self.step.arguments[entry].iter();
        let arguments = arguments.map(|&argument| match argument {
            "state" => "&drive->state",
            "sample" => checked,
            "rotor" => rotor,
            "observation" => "&observation",
            other => other,
        });
        let arguments: Vec<&str> = arguments.collect();
        format!("{name}({})", arguments.join(", "))
    }

    /// The statements that track; the result is bound if `is_named`.
    fn track(&self, checked: &str, is_named: bool) -> String {
        if !self.step.tracks {
            return String::new();
        }
        let call = self.call(0, "track", checked, "");
        if !self.step.has_rotor {
            lines(&[&format!("{call};")])
        } else if is_named {
            lines(&[&format!("const tracked rotor = {call};")])
        } else {
            lines(&[&format!("(void){call};")])
        }
    }

    /// The statement that makes an angle the electrical one; the sample for the supervisor.
    fn resolve(&self, body: &mut String) -> &'static str {
        let Some(AngleSensor { turns, offset }) = self.interface.limits.angle else {
            return "sample";
        };
        body.push_str(&lines(&[&format!(
            "const hexagen_sample seen = hexagen_resolve_angle(sample, {}, UINT32_C({offset:#010x}));",
            typed_number(turns)
        )]));
        "&seen"
    }

    /// What becomes of a period that is not fit for control.
    fn examine(&self) -> String {
        let mut body = String::new();
        let seen = self.resolve(&mut body);
        body.push_str(&lines(&[
            "const hexagen_unfit unfit",
            &format!(
                "{INDENT}= hexagen_examine(&drive->supervisor, &limits, {seen}, known, checked);"
            ),
        ]));
        let inner = INDENT.repeat(2);
        let demand = if self.has_speed() {
            "drive->speed = 0".to_owned()
        } else {
            format!(
                "{}(drive, -INT32_MAX * unfit.against)",
                self.names.public(Setter::Current.name())
            )
        };
        let _ = write!(
            body,
            "{INDENT}if (unfit.is_controlled) {{\n\
             {inner}drive->status = hexagen_status_word(&drive->supervisor);\n{INDENT}}}\n\
             {INDENT}if (unfit.is_braking) {{\n{inner}{demand};\n{INDENT}}}\n"
        );
        body.push_str(&lines(&["return unfit;"]));
        let told = "A period that is not fit for control. The drive controls nevertheless to brake a fast rotor, and where a disturbed Hall code is bridged.";
        let head = format!(
            "static hexagen_unfit examine({}, const hexagen_sample *sample, hexagen_fault known, hexagen_checked *checked)",
            self.drive()
        );
        self.cold(told, &head, &body)
    }

    /// A private function off the normal path.
    fn cold(&self, told: &str, head: &str, body: &str) -> String {
        let comment = self.names.comment("", &[told]);
        let head = wrapped("", head);
        format!("{comment}HEXAGEN_COLD\n{head}{{\n{body}}}\n\n")
    }

    /// The period without control.
    fn step_at_rest(&self) -> String {
        let takes_rotor = self.step.arguments[1].contains(&"rotor");
        let inner = INDENT.repeat(2);
        let mut body = lines(&[
            "const bool was_tripped = drive->supervisor.mode == HEXAGEN_MODE_TRIPPED;",
            "const hexagen_leg leg = hexagen_rest(&drive->supervisor, &limits, sample, fault);",
            "if (drive->supervisor.mode == HEXAGEN_MODE_TRIPPED && !was_tripped) {",
        ]);
        let _ = write!(body, "{inner}keep_trip(drive, sample);\n{INDENT}}}\n");
        body.push_str(&lines(&[
            "drive->status = hexagen_status_word(&drive->supervisor);",
        ]));
        body.push_str(&self.track("checked", takes_rotor));
        if !self.step.arguments[1].is_empty() {
            let call = self.call(1, "rest", "checked", "rotor");
            body.push_str(&lines(&[&format!("{call};")]));
        }
        let has_intervals = self.program.has_intervals();
        let all = if has_intervals {
            "hexagen_all_intervals"
        } else {
            "hexagen_all_legs"
        };
        body.push_str(&lines(&[&format!("return {all}(leg);")]));
        let checked = if self.rest_takes_checked() {
            ", const hexagen_checked *checked"
        } else {
            ""
        };
        let told = "A period with all legs in one state: start-up, a fault, or off on purpose. Apart from `examine`, so that no way leads from here to control.";
        let head = format!(
            "static {} step_at_rest({}, const hexagen_sample *sample, hexagen_fault fault{checked})",
            self.command(),
            self.drive()
        );
        self.cold(told, &head, &body)
    }

    /// Whether a period without control takes the checked sample.
    fn rest_takes_checked(&self) -> bool {
        let [tracks, rests, _] = &self.step.arguments;
        (self.step.tracks && tracks.contains(&"sample")) || rests.contains(&"sample")
    }

    /// The type of a command.
    fn command(&self) -> &'static str {
        if self.program.has_intervals() {
            "hexagen_intervals"
        } else {
            "hexagen_legs"
        }
    }

    /// The function that keeps the period of a trip.
    fn keep_trip(&self) -> String {
        let mut kept = vec!["sample = *sample".to_owned()];
        // Word by word, as `hexagen_keep` does it.
        let state = self.program.states.iter().map(|word| {
            let name = self.names.local(&word.name);
            format!("state.{name} = drive->state.{name}")
        });
        kept.extend(state);
        let single = SINGLE.into_iter();
        let single = single.filter(|(demand, _)| self.program.param(*demand).is_some());
        kept.extend(single.map(|(_, name)| format!("{name} = drive->{name}")));
        if self.has_bus() {
            kept.extend(
                [0, 1].map(|word| format!("bus[{word}] = hexagen_bus_words(&drive->bus)[{word}]")),
            );
        }
        let mut body = lines(&["hexagen_keep(&drive->trip.supervisor, &drive->supervisor);"]);
        for kept in kept {
            let _ = writeln!(body, "{INDENT}drive->trip.{kept};");
        }
        body.push_str(&lines(&[
            "drive->trip_number = (drive->trip_number + 1U) | 1U;",
        ]));
        let head = format!(
            "static void keep_trip({}, const hexagen_sample *sample)",
            self.drive()
        );
        self.cold("Keeps the period of a trip.", &head, &body)
    }

    /// What the law watches itself, with its fault.
    fn watches(&self) -> impl Iterator<Item = (Watch, &'static str)> {
        let Interface {
            residual,
            over_speed,
            ..
        } = *self.interface;
        let watches = [(residual, "RESIDUAL"), (over_speed, "OVER_SPEED")].into_iter();
        watches.filter_map(|(watch, fault)| Some((watch?, fault)))
    }

    fn init(&self) -> Method {
        let mut body = lines(&[&format!(
            "drive->current = {};",
            self.initial(Demand::Current)
        )]);
        if self.has_speed() {
            let speed = self.initial(Demand::Speed);
            body.push_str(&lines(&[&format!("drive->speed = {speed};")]));
        }
        if self.has_bus() {
            let [volts, ratio] = Demand::OF_BUS.map(|demand| self.initial(demand));
            let line = format!("hexagen_start_bus(&drive->bus, {volts}, {ratio});");
            body.push_str(&lines(&[&line]));
        }
        body.push_str(&lines(&[
            "hexagen_start(&drive->supervisor, &limits);",
            "drive->state = initial;",
            "drive->trip_number = 0;",
            "drive->status = hexagen_status_word(&drive->supervisor);",
        ]));
        let signals = lines(&["hexagen_start_port(&drive->signals);"]);
        body.push_str(where_defined(SIGNALS, &signals).trim_end());
        body.push('\n');
        Method {
            doc: doc(&[
                "Initialises a drive: it controls currents at set-point 0 with nominal current offsets, behind a start in which it finds the angle of a turning rotor, where it needs that.",
                "Before any other call. If the current offsets or the inverter's bootstrap capacitors require it, call `calibrate()` before the first period.",
            ]),
            head: format!("void {}({})", self.names.public("init"), self.drive()),
            body,
        }
    }

    /// The statements that find the first fault that no sample shows; empty without any.
    fn unsampled_faults(&self) -> String {
        let periods = self.interface.bus_periods;
        if periods.is_none() && self.watches().next().is_none() {
            return String::new();
        }
        let first = periods.map_or("HEXAGEN_FAULT_NONE".to_owned(), |periods| {
            format!(
                "hexagen_pass_period(&drive->bus, {})",
                typed_number(periods)
            )
        });
        let mut body = lines(&[&format!("hexagen_fault fault = {first};")]);
        for (number, (Watch { word, most }, fault)) in self.watches().enumerate() {
            let word = self.names.local(word);
            let is_found = format!("drive->state.{word} >= {}", typed_number(most));
            let is_next = if periods.is_some() || number > 0 {
                format!("fault == HEXAGEN_FAULT_NONE && {is_found}")
            } else {
                is_found
            };
            body.push_str(&lines(&[
                &format!("if ({is_next}) {{"),
                &format!("{INDENT}fault = HEXAGEN_FAULT_{fault};"),
                "}",
            ]));
        }
        body
    }

    fn period(&self) -> Method {
        let mut body = lines(&["hexagen_checked checked;"]);
        let seen = self.resolve(&mut body);
        let faults = self.unsampled_faults();
        body.push_str(&faults);
        let check = format!(
            "!hexagen_check(&drive->supervisor, &limits, {seen}, &drive->{}, &checked)",
            self.demand()
        );
        let (condition, known) = if faults.is_empty() {
            (check, "HEXAGEN_FAULT_NONE")
        } else {
            // The supervisor follows its sample in any case.
            (format!("{check} || fault != HEXAGEN_FAULT_NONE"), "fault")
        };
        let checked = if self.rest_takes_checked() {
            ", &checked"
        } else {
            ""
        };
        let inner = INDENT.repeat(2);
        body.push_str(&lines(&[
            &format!("if ({condition}) {{"),
            &format!(
                "{INDENT}const hexagen_unfit unfit = examine(drive, sample, {known}, &checked);"
            ),
            &format!("{INDENT}if (!unfit.is_controlled) {{"),
            &format!("{inner}return step_at_rest(drive, sample, unfit.fault{checked});"),
            &format!("{INDENT}}}"),
            "}",
        ]));
        let has_intervals = self.program.has_intervals();
        let kind = self.command();
        let command = if has_intervals { "intervals" } else { "legs" };
        let takes_rotor = self.step.arguments[2].contains(&"rotor");
        body.push_str(&self.track("&checked", takes_rotor));
        let observation = lines(&["hexagen_observation observation = HEXAGEN_UNOBSERVED;"]);
        let mut signals = String::new();
        if self.step.arguments[2].contains(&"observation") {
            body.push_str(&observation);
        } else {
            signals.push_str(&observation);
        }
        let step = self.call(2, "step", "&checked", "rotor");
        body.push_str(&lines(&[&format!("const {kind} {command} = {step};")]));
        let third = self.interface.limits.sensors.third;
        if third.is_some_and(|third| third.readable.is_some()) {
            body.push_str(&lines(&[
                "hexagen_follow_legs(&drive->supervisor, &limits, &legs);",
            ]));
        }
        let shown = if has_intervals {
            "hexagen_legs_of(intervals)"
        } else {
            command
        };
        let _ = write!(
            signals,
            "{INDENT}if (hexagen_is_asked(&drive->signals)) {{\n\
             {INDENT}{INDENT}hexagen_answer(&drive->signals, checked, {shown}, observation);\n{INDENT}}}\n"
        );
        body.push_str(where_defined(SIGNALS, &signals).trim_end());
        let _ = write!(body, "\n{INDENT}return {command};\n");
        let effect = match self.interface.delay {
            0 => "The command takes effect at once.",
            _ => "The command takes effect in the next period.",
        };
        let mut text = doc(&[
            "Runs one control period: takes the measurements of its beginning, returns the inverter's command.",
            effect,
        ]);
        if self.interface.limits.angle.is_some() {
            text.push("The sample has a sensor's angle (hexagen_with_angle).".to_owned());
        }
        if self.interface.timer_capture {
            text.push(
                "The sample has a Hall code and the ticks since its edge (hexagen_with_ticks)."
                    .to_owned(),
            );
        }
        if self.interface.limits.sensors.third.is_some() {
            text.push("It has the third current's count, too (hexagen_with_third).".to_owned());
        }
        Method {
            doc: text,
            head: format!(
                "{kind} {}({}, const hexagen_sample *sample)",
                self.names.public("step"),
                self.drive()
            ),
            body,
        }
    }

    fn setter(&self, set: Setter, setter: &Function) -> Method {
        let mut text = setter.doc.clone();
        let code = emit_setter(self.program, setter, self.names);
        let mut body = code.body;
        if let (Setter::Torque, Some(ratio)) = (set, self.interface.torque_ratio) {
            text.extend(doc(&[
                "The torque constant learnt so far makes the current.",
            ]));
            let scale = format!(
                "bits = hexagen_scaled_torque(bits, hexagen_shared(&drive->state.{ratio}));"
            );
            body = lines(&[&scale]) + &body;
        }
        let field = match set {
            Setter::Current | Setter::Torque => Some("current"),
            Setter::Speed => Some("speed"),
            Setter::Bus => None,
        };
        if let Some(field) = field {
            text.extend(doc(&["", "`bits` has 16 fraction bits: 65536 is one."]));
            for word in code.words {
                body.push_str(&lines(&[&format!("drive->{field} = {word};")]));
            }
        } else {
            text.extend(doc(&[
                "",
                "A call that interrupts another one has no effect; one that never resumes after an interruption blocks later calls for 65,536 control periods.",
                "From an interrupt that can interrupt the control loop: at most once per control period.",
            ]));
            let mut words = code.words;
            words.resize(Demand::OF_BUS.len(), "0".to_owned());
            let counts = setter
                .inputs
                .iter()
                .map(|input| self.names.local(&input.name));
            words.push(format!(
                "hexagen_judge_bus(&limits, {})",
                counts.collect::<Vec<_>>().join(", ")
            ));
            let line = format!("hexagen_tell_bus(&drive->bus, {});", words.join(", "));
            body.push_str(&lines(&[&line]));
        }
        let inputs = setter.inputs.iter().map(|input| {
            let is_narrow = input.interval.low >= 0 && input.interval.high <= i64::from(u16::MAX);
            let kind = if is_narrow { "uint16_t" } else { "int32_t" };
            format!("{kind} {}", self.names.local(&input.name))
        });
        let parameters: Vec<String> = std::iter::once(self.drive()).chain(inputs).collect();
        Method {
            doc: text,
            head: format!(
                "void {}({})",
                self.names.public(&setter.name),
                parameters.join(", ")
            ),
            body,
        }
    }

    /// The function that returns the learnt torque constant.
    fn torque_constant_ratio(&self, word: &str) -> Method {
        Method {
            doc: doc(&[
                "The learnt torque constant over the stated one, with 16 fraction bits: 65536 is one.",
            ]),
            head: format!(
                "int32_t {}(const {} *drive)",
                self.names.public("torque_constant_ratio"),
                self.names.prefix
            ),
            body: lines(&[&format!(
                "return hexagen_torque_constant_ratio(hexagen_shared(&drive->state.{word}));"
            )]),
        }
    }

    /// The function that tells how far the Hall sensors stand from their places, as learnt.
    fn hall_offsets(&self, words: [&str; 3]) -> Method {
        let words = words.map(|word| format!("hexagen_shared(&drive->state.{word})"));
        Method {
            doc: doc(&[
                "How far the edges of the three Hall sensors stand from `hall_angles`, electrical degrees with 16 fraction bits: those at which sectors 1 and 4, 2 and 5, 3 and 6 begin. 0 before anything is learnt and behind a reset. An edge may change them between two reads: call it from the interrupt that calls the step, or until two results agree.",
            ]),
            head: format!(
                "void {}(const {} *drive, int32_t degrees[3])",
                self.names.public("hall_offsets"),
                self.names.prefix
            ),
            body: lines(&[
                &format!("const int32_t first = {};", words[0]),
                &format!("const int32_t second = {};", words[1]),
                &format!("const int32_t all = {};", words[2]),
                "hexagen_hall_offsets(first, second, all, degrees);",
            ]),
        }
    }

    /// The same setter in an integer unit.
    fn other_unit(&self, setter: Setter) -> Option<Method> {
        let (suffix, parameter, unit, make) = match setter {
            Setter::Current => ("ma", "milliamperes", "milliamperes", "thousandths"),
            Setter::Torque => (
                "mnm",
                "millinewtonmetres",
                "millinewton metres",
                "thousandths",
            ),
            Setter::Speed => ("rpm", "rpm", "whole rpm", "whole"),
            Setter::Bus => return None,
        };
        let setter = setter.name();
        let call = self.names.public(setter);
        Some(Method {
            doc: vec![format!("`{setter}()` in {unit}.")],
            head: format!(
                "void {call}_{suffix}({}, int32_t {parameter})",
                self.drive()
            ),
            body: lines(&[&format!("{call}(drive, hexagen_{make}({parameter}));")]),
        })
    }

    /// The function that returns observation signals.
    pub(super) fn signals(&self) -> Method {
        Method {
            doc: doc(&[
                "Signals of one controlled period, consistent with each other: true if they are available. Else requests those of the next one.",
                "",
                "The control loop answers in its next controlled period, so a program that polls until true has signals of a period that began after its first request.",
                "From one context of the main program; neither side ever waits for the other.",
            ]),
            head: format!(
                "bool {}({}, hexagen_signals *signals)",
                self.names.public("signals"),
                self.drive()
            ),
            body: lines(&["return hexagen_take(&drive->signals, &units, signals);"]),
        }
    }

    /// Access to all words, for bit-for-bit comparisons.
    pub(super) fn verification(&self) -> [Method; 2] {
        let names = self.names;
        let states = &self.program.states;
        let list: Vec<&str> = states.iter().map(|word| word.name.as_str()).collect();
        let list = list.join(", ");
        let mut read = lines(&["hexagen_words(&drive->supervisor, words);"]);
        let mut write = lines(&["hexagen_set_words(&drive->supervisor, words);"]);
        for (place, word) in states.iter().enumerate() {
            let field = names.local(&word.name);
            let cast = if word.storage_bits == 16 {
                "(uint16_t)"
            } else {
                ""
            };
            let _ = writeln!(
                read,
                "{INDENT}words[HEXAGEN_WORDS + {place}] = drive->state.{field};"
            );
            let _ = writeln!(
                write,
                "{INDENT}drive->state.{field} = {cast}words[HEXAGEN_WORDS + {place}];"
            );
        }
        write.push_str(&lines(&[
            "drive->status = hexagen_status_word(&drive->supervisor);",
        ]));
        [
            Method {
                doc: vec![format!(
                    "Copies the supervisor's words, then the law's: {list}."
                )],
                head: format!(
                    "void {}(const {}, int32_t *words)",
                    names.public("state_words"),
                    self.drive()
                ),
                body: read,
            },
            Method {
                doc: doc(&["Overwrites those words with values inside their ranges."]),
                head: format!(
                    "void {}({}, const int32_t *words)",
                    names.public("set_state_words"),
                    self.drive()
                ),
                body: write,
            },
        ]
    }
}
