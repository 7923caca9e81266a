//! The entries of the law and the setters: stage calls in order, then the new state words.

use super::super::expression::Scope;
use super::super::path::{
    Kept, Part, SINGLE, demands_read, inputs_used, kept, kept_at_rest, writes,
};
use super::super::plan::Context;
use super::super::signal::Shape;
use super::expression::{Printer, leg_state};
use super::layout::{INDENT, words, wrapped};
use super::names::Names;
use super::stage::{StageFunction, kind};
use crate::emit::signal::Leg;
use crate::ir::{AtRest, Demand, Function, Op, Output, Phase, Program, Told, Value};
use std::fmt::Write as _;

/// The static functions of a step, and their arguments.
pub(super) struct Step {
    /// The stages, in order of their calls, then `track`, `rest` and `step`.
    pub definitions: String,
    /// Whether `track` returns something.
    pub has_rotor: bool,
    /// Whether there is something to track.
    pub tracks: bool,
    /// Names of the arguments of `track`, `rest` and `step`; none for an empty function.
    pub arguments: [Vec<&'static str>; 3],
}

/// The entries of a program's step.
pub(super) fn emit_step(program: &Program, names: &Names) -> Step {
    let context = Context::of_step(program, None);
    let plans = context.plan();
    let stages = plans
        .iter()
        .map(|plan| StageFunction::new(&context, names, plan.clone(), &plan.stage.name));
    let step = StepFunctions {
        context: &context,
        names,
        stages: stages.collect(),
        rotor: context.handed_over(),
    };
    let entries = [step.track(), step.rest(), step.control()];
    let mut definitions: String = step.stages.iter().map(StageFunction::definition).collect();
    definitions.push_str(&step.rotor_definition());
    for entry in &entries {
        definitions.push_str(&entry.definition);
    }
    Step {
        definitions,
        has_rotor: step.has_rotor(),
        tracks: !entries[0].definition.is_empty(),
        arguments: entries.map(|entry| entry.arguments),
    }
}

/// An entry of the law.
struct Entry {
    /// Empty if there is nothing to do.
    definition: String,
    arguments: Vec<&'static str>,
}

struct StepFunctions<'a> {
    context: &'a Context<'a>,
    names: &'a Names,
    stages: Vec<StageFunction<'a>>,
    /// Values that the tracking hands over.
    rotor: Vec<Value>,
}

impl<'a> StepFunctions<'a> {
    fn function(&self) -> &'a Function {
        self.context.function
    }

    fn stages(&self, part: Part) -> impl Iterator<Item = &StageFunction<'a>> {
        let function = self.function();
        self.stages
            .iter()
            .filter(move |stage| part.has(function, stage.plan()))
    }

    fn has_rotor(&self) -> bool {
        !self.rotor.is_empty()
    }

    fn local(&self, value: Value) -> String {
        self.names.local(&self.function().node(value).name)
    }

    fn printer(&self, reads_state: bool) -> Printer<'a> {
        Printer {
            scope: Scope {
                context: self.context,
                reads_state,
            },
            names: self.names,
        }
    }

    fn rotor_definition(&self) -> String {
        if !self.has_rotor() {
            return String::new();
        }
        let fields = self.rotor.iter().map(|&value| {
            let (kind, name) = (kind(self.context.shape(value)), self.local(value));
            format!("{INDENT}{kind} {name};\n")
        });
        let comment = self
            .names
            .comment("", &["Rotor angle and speed from tracking."]);
        format!(
            "{comment}typedef struct {{\n{}}} tracked;\n\n",
            fields.collect::<String>()
        )
    }

    /// Reads of the sample's words among the values.
    fn inputs(&self, values: impl Iterator<Item = Value>) -> String {
        let names = inputs_used(self.function(), values).into_iter();
        let read = |name: &str| {
            let local = self.names.local(name);
            format!("{INDENT}const int32_t {local} = sample->{name};\n")
        };
        names.map(read).collect()
    }

    /// Reads of the tracking's results.
    fn rotor_words<'v>(&self, values: impl Iterator<Item = &'v Value>) -> String {
        let read = |&value: &Value| {
            let (kind, name) = (kind(self.context.shape(value)), self.local(value));
            format!("{INDENT}const {kind} {name} = rotor.{name};\n")
        };
        values.map(read).collect()
    }

    fn kept(&self, part: Part) -> Kept<'a> {
        let plans: Vec<_> = self
            .stages
            .iter()
            .map(|stage| stage.plan().clone())
            .collect();
        kept(self.context, &plans, part)
    }

    /// Calls of a part's stages, and its new state words.
    fn body(&self, part: Part, kept: &Kept<'_>) -> String {
        let mut text: String = self.stages(part).map(StageFunction::call).collect();
        for &value in &kept.reads {
            let (name, old) = (self.local(value), self.printer(true).whole(value));
            text.push_str(&wrapped(INDENT, &format!("const int32_t {name} = {old};")));
        }
        for &(word, value) in &kept.words {
            let field = self.names.local(&word.name);
            let printer = self.printer(kept.is_moved(self.function(), value));
            let line = format!("state->{field} = {};", printer.kept(word, value));
            text.push_str(&wrapped(INDENT, &line));
        }
        text
    }

    /// A function of this body, with the arguments that it uses.
    fn entry(
        &self,
        [result, name, doc]: [&str; 3],
        arguments: &[&'static str],
        body: &str,
    ) -> Entry {
        let state = self.names.state();
        let is_whole = arguments.contains(&"drive");
        let mut body = body.to_owned();
        if is_whole && words(&body).contains("state") {
            body.insert_str(
                0,
                &format!("{INDENT}{state} *const state = &drive->state;\n"),
            );
        }
        let named = words(&body);
        let arguments = arguments.iter().copied();
        let arguments: Vec<&str> = arguments.filter(|&name| named.contains(name)).collect();
        let parameters = arguments.iter().map(|&argument| match argument {
            "drive" => format!("{} *drive", self.names.prefix),
            "state" => format!("{state} *state"),
            "rotor" => "tracked rotor".to_owned(),
            "observation" => "hexagen_observation *observation".to_owned(),
            _ => "const hexagen_checked *sample".to_owned(),
        });
        let parameters = match parameters.collect::<Vec<String>>() {
            none if none.is_empty() => "void".to_owned(),
            some => some.join(", "),
        };
        let head = wrapped("", &format!("static inline {result} {name}({parameters})"));
        let comment = self.names.comment("", &[doc]);
        Entry {
            definition: format!("{comment}{head}{{\n{body}}}\n\n"),
            arguments,
        }
    }

    /// The tracking.
    fn track(&self) -> Entry {
        let kept = self.kept(Part::Tracking);
        let mut body = self.inputs(kept.used.iter().copied()) + &self.body(Part::Tracking, &kept);
        let result = if self.has_rotor() {
            let names: Vec<String> = self.rotor.iter().map(|&value| self.local(value)).collect();
            body.push_str(&wrapped(
                INDENT,
                &format!("const tracked rotor = {{ {} }};", names.join(", ")),
            ));
            let _ = writeln!(body, "{INDENT}return rotor;");
            "tracked"
        } else {
            "void"
        };
        if body.is_empty() {
            return Entry {
                definition: String::new(),
                arguments: vec![],
            };
        }
        let doc = "Tracks the rotor: runs in every period, at rest too.";
        self.entry([result, "track", doc], &["state", "sample"], &body)
    }

    /// A period without control.
    fn rest(&self) -> Entry {
        let kept = kept_at_rest(self.context);
        let tracked = kept.iter().filter_map(|&(_, at_rest)| match at_rest {
            AtRest::Tracked(value) => Some(value),
            AtRest::Forgotten => None,
        });
        let tracked: Vec<Value> = tracked.collect();
        let mut body = String::new();
        let handed = self.rotor.iter().filter(|value| tracked.contains(value));
        body.push_str(&self.rotor_words(handed));
        let printer = self.printer(false);
        for (word, at_rest) in kept {
            let value = match at_rest {
                AtRest::Tracked(value) => match self.function().node(value).op {
                    Op::Input(n) => format!("sample->{}", self.function().inputs[n as usize].name),
                    _ => printer.kept(word, value),
                },
                AtRest::Forgotten => "0".to_owned(),
            };
            let field = self.names.local(&word.name);
            body.push_str(&wrapped(INDENT, &format!("state->{field} = {value};")));
        }
        if body.is_empty() {
            return Entry {
                definition: String::new(),
                arguments: vec![],
            };
        }
        let doc = "A period without control: clears the state of past commands.";
        self.entry(["void", "rest", doc], &["state", "sample", "rotor"], &body)
    }

    /// A controlled period.
    fn control(&self) -> Entry {
        let kept = self.kept(Part::Control);
        let mut body = read_words(self.context.program, self.function(), self.names);
        body.push_str(&self.inputs(kept.used.iter().copied()));
        body.push_str(&self.rotor_words(self.rotor.iter()));
        body.push_str(&self.body(Part::Control, &kept));
        body.push_str(&self.observation());
        body.push('\n');
        let command = if self.context.program.has_intervals() {
            body.push_str(&self.intervals());
            "hexagen_intervals"
        } else {
            body.push_str(&self.legs());
            "hexagen_legs"
        };
        let head = [command, "step", "A controlled period."];
        let arguments = ["drive", "sample", "rotor", "observation"];
        self.entry(head, &arguments, &body)
    }

    /// The observations.
    fn observation(&self) -> String {
        let printer = self.printer(false);
        let tell = |told: Told| {
            let value = printer.whole(self.function().told(told)?);
            Some(wrapped(INDENT, &format!("observation->{told} = {value};")))
        };
        let all = [Told::Emf(Phase::A), Told::Emf(Phase::B), Told::Speed];
        all.into_iter().filter_map(tell).collect()
    }

    /// A word of the command in 16 bits, without sign.
    fn half(&self, output: Output) -> String {
        let printer = self.printer(false);
        let value = self.function().output(output);
        match value.map(|value| (value, printer.scope.literal(value))) {
            None => "0".to_owned(),
            Some((_, Some(literal))) => literal.to_string(),
            Some((value, None)) => printer.cast("uint16_t", value),
        }
    }

    /// A command of intervals.
    fn intervals(&self) -> String {
        let ends = [0, 1].map(|interval| self.half(Output::End(interval)));
        let states = [0, 1, 2].map(|interval| self.half(Output::States(interval)));
        returned("intervals", &ends, &states)
    }

    /// The command; old state words in it are read before any is written.
    fn legs(&self) -> String {
        let printer = self.printer(false);
        let compare = Phase::ALL.map(|phase| self.half(Output::Compare(phase)));
        let state = Phase::ALL.map(|phase| {
            let state = self.function().output(Output::Leg(phase));
            state.map_or_else(
                || leg_state(Leg::Off).to_owned(),
                |value| printer.shaped(value, Shape::Leg),
            )
        });
        returned("legs", &compare, &state)
    }
}

/// Returns a command: instants, then states of the legs. `name`: the type's behind `hexagen_`.
fn returned(name: &str, instants: &[String], states: &[String]) -> String {
    let inner = INDENT.repeat(2);
    [
        format!("{INDENT}const hexagen_{name} {name} = {{\n"),
        wrapped(&inner, &format!("{{ {} }},", instants.join(", "))),
        wrapped(&inner, &format!("{{ {} }}", states.join(", "))),
        format!("{INDENT}}};\n{INDENT}return {name};\n"),
    ]
    .concat()
}

/// Reads the set-point words that a function uses, under their names.
fn read_words(program: &Program, function: &Function, names: &Names) -> String {
    let read = demands_read(program, function);
    let name_where_read = |demand: Demand| {
        let word = program.param(demand).filter(|_| read.contains(&demand))?;
        Some(names.local(&word.name))
    };
    let single = SINGLE.into_iter().filter_map(|(demand, field)| {
        let name = name_where_read(demand)?;
        Some(format!("{INDENT}const int32_t {name} = drive->{field};\n"))
    });
    let mut text: String = single.collect();
    let fresh = name_where_read(Demand::BusIsFresh).map(|name| {
        format!("{INDENT}const int32_t {name} = !hexagen_bus_is_stale(&drive->bus);\n")
    });
    text.extend(fresh);
    let bus = Demand::OF_BUS.map(name_where_read);
    if bus.iter().any(Option::is_some) {
        text.push_str(INDENT);
        text.push_str("const volatile int32_t *const bus = hexagen_bus_words(&drive->bus);\n");
    }
    let told = bus.into_iter().enumerate().filter_map(|(place, name)| {
        let name = name?;
        Some(format!("{INDENT}const int32_t {name} = bus[{place}];\n"))
    });
    text.extend(told);
    text
}

/// A setter: its code, and its words.
pub(super) struct SetterCode {
    /// Its stages, if they are functions of their own.
    pub stages: String,
    /// Statements.
    pub body: String,
    /// The words, in the order of the program's set-point words.
    pub words: Vec<String>,
}

pub(super) fn emit_setter(program: &Program, function: &Function, names: &Names) -> SetterCode {
    let context = Context::new(program, function);
    let plans = context.plan();
    let single = matches!(plans.as_slice(), [only] if only.stage.guard.is_none());
    let stages: Vec<StageFunction<'_>> = plans
        .into_iter()
        .map(|plan| {
            let name = format!("{}_{}", function.name, plan.stage.name);
            StageFunction::new(&context, names, plan, &name)
        })
        .collect();
    let printer = Printer {
        scope: Scope {
            context: &context,
            reads_state: true,
        },
        names,
    };
    let written = writes(function);
    let mut words: Vec<String> = written.iter().map(|&value| printer.whole(value)).collect();
    if single {
        let statements = stages.iter().flat_map(StageFunction::statements);
        let mut statements: Vec<String> = statements.collect();
        // The last value is not bound to its name first.
        let last = function.values().last();
        if let ([only], [word]) = (written.as_slice(), words.as_mut_slice())
            && last == Some(*only)
        {
            statements.pop();
            *word = printer.bound(*only);
        }
        return SetterCode {
            stages: String::new(),
            body: statements
                .iter()
                .map(|line| wrapped(INDENT, line))
                .collect(),
            words,
        };
    }
    SetterCode {
        stages: stages.iter().map(StageFunction::definition).collect(),
        body: stages.iter().map(StageFunction::call).collect(),
        words,
    }
}
