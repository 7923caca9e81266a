//! The step and the setters: stage calls in order, then what they leave behind.

use super::super::expression::Scope;
use super::super::path::{
    Kept, StageCode as _, beside, inputs_read, kept, leaves_behind, output, params_read,
    words_read, writes,
};
use super::super::plan::{Context, StagePlan};
use super::super::set_point::shared;
use super::super::signal::{Code, Shape};
use super::super::texts::GIVEN_UP;
use super::expression::{Printer, coded};
use super::layout::{INDENT, wrapped};
use super::names::{Names, typed_number};
use super::stage::StageFunction;
use crate::ir::{Function, Paths, Program};
use std::fmt::Write as _;

/// The static functions of a step: its stages, what takes over where it rests, and the step itself.
pub(super) fn emit_step(program: &Program, names: &Names) -> String {
    let Paths { normal, exit } = program.step.paths(&program.tables);
    let context = Context::new(program, &normal);
    let path = PathFunctions::new(&context, names, &[]);
    let exit = exit.as_ref().map(|exit| Context::new(program, exit));
    let exit = exit
        .as_ref()
        .map(|exit| PathFunctions::new(exit, names, &path.stages));
    let kept: Vec<usize> = exit
        .iter()
        .flat_map(|exit| params_read(exit.context.function))
        .collect();
    let mut text = path.definitions();
    let leave = exit.as_ref().map(|exit| {
        text.push_str(&exit.definitions());
        text.push_str(&exit.rest());
        exit.call_rest()
    });
    let inputs = normal.inputs.iter();
    let inputs = inputs.map(|input| format!("int32_t {}", names.local(&input.name)));
    let own = [
        format!("{} *state", names.type_of("state")),
        format!("{} *set_point", names.type_of("set_point")),
    ];
    let parameters: Vec<String> = own.into_iter().chain(inputs).collect();
    let head = format!(
        "static inline {} step({})",
        names.type_of("legs"),
        parameters.join(", ")
    );
    text.push_str(&names.comment("", &normal.doc));
    text.push_str(&wrapped("", &head));
    text.push_str("{\n");
    text.push_str(&read_params(program, &normal, &kept, names));
    text.push_str(&path.body(leave.as_deref()));
    text.push('\n');
    text.push_str(&path.legs());
    text + "}\n\n"
}

/// One path of the step.
struct PathFunctions<'a> {
    context: &'a Context<'a>,
    names: &'a Names,
    stages: Vec<StageFunction<'a>>,
    /// Which stages are functions of the other path.
    shared: Vec<bool>,
}

impl<'a> PathFunctions<'a> {
    /// The functions of a path beside those of another.
    fn new(context: &'a Context<'a>, names: &'a Names, others: &[StageFunction<'a>]) -> Self {
        let make = |plan: StagePlan<'a>, name: &str| StageFunction::new(context, names, plan, name);
        let (stages, shared) = beside(context, others, make);
        Self {
            context,
            names,
            stages,
            shared,
        }
    }

    /// Names of the set-point words and inputs that it reads.
    fn arguments(&self) -> Vec<String> {
        let words = words_read(self.context.program, self.context.function).into_iter();
        let names = words.chain(inputs_read(self.context.function));
        names.map(|name| self.names.local(name)).collect()
    }

    /// The statement that leaves the step for this path.
    fn call_rest(&self) -> String {
        let own = ["state", "set_point"].map(str::to_owned);
        let arguments: Vec<String> = own.into_iter().chain(self.arguments()).collect();
        format!("return legs_at_rest(rest({}));", arguments.join(", "))
    }

    /// This path as a function of its own. No leg pulses at rest, and all are alike.
    fn rest(&self) -> String {
        let names = self.names;
        let own = [
            format!("{} *state", names.type_of("state")),
            format!("{} *set_point", names.type_of("set_point")),
        ];
        let arguments = self.arguments().into_iter();
        let arguments = arguments.map(|name| format!("int32_t {name}"));
        let parameters: Vec<String> = own.into_iter().chain(arguments).collect();
        let mut text = names.comment(
            "",
            &[
                "One control period without current control, in start-up or with a fault: what all legs do. Publishes",
                "what the drive is doing from here on.",
            ],
        );
        let head = format!(
            "static {} rest({})",
            names.type_of("leg"),
            parameters.join(", ")
        );
        text.push_str(&names.cold());
        text.push_str(&wrapped("", &head));
        text.push_str("{\n");
        text.push_str(&self.body(None));
        let _ = writeln!(text, "{INDENT}set_point->status = status_of(state);");
        text.push_str(&wrapped(INDENT, &format!("return {};", self.leg("leg_a"))));
        text + "}\n\n"
    }

    /// What is seen behind the stages: old state words that go out of the step are read under their names before
    /// any is written.
    fn printer(&self, reads_state: bool) -> Printer<'a> {
        Printer {
            scope: Scope {
                context: self.context,
                reads_state,
            },
            names: self.names,
        }
    }

    fn leg(&self, name: &str) -> String {
        match output(self.context.function, name) {
            None => coded(Code::Off, self.names),
            Some(value) => self.printer(false).shaped(value, Shape::Leg),
        }
    }

    fn legs(&self) -> String {
        let printer = self.printer(false);
        let compare = ["compare_a", "compare_b", "compare_c"].map(|name| {
            let value = output(self.context.function, name);
            match value.map(|value| (value, printer.scope.literal(value))) {
                None => "0".to_owned(),
                Some((_, Some(literal))) => literal.to_string(),
                Some((value, None)) => printer.cast("uint16_t", value),
            }
        });
        let state = ["leg_a", "leg_b", "leg_c"].map(|name| self.leg(name));
        let kind = self.names.type_of("legs");
        let inner = INDENT.repeat(2);
        [
            format!("{INDENT}const {kind} legs = {{\n"),
            wrapped(&inner, &format!("{{ {} }},", compare.join(", "))),
            wrapped(&inner, &format!("{{ {} }}", state.join(", "))),
            format!("{INDENT}}};\n{INDENT}return legs;\n"),
        ]
        .concat()
    }

    /// Stage calls in order, with `leave` behind those that find a reason for it; then the new state.
    fn body(&self, leave: Option<&str>) -> String {
        let (function, outside) = (self.context.function, self.printer(true));
        let mut text = String::new();
        for stage in &self.stages {
            text.push_str(&stage.call());
            let flags = leaves_behind(function, stage.plan());
            let flags = flags.into_iter().map(|flag| outside.alternative(flag));
            let flags: Vec<String> = flags.collect();
            if let (false, Some(leave)) = (flags.is_empty(), leave) {
                let line = format!("if ({}) {{", flags.join(" || "));
                text.push_str(&wrapped(INDENT, &line));
                text.push_str(&wrapped(&INDENT.repeat(2), leave));
                let _ = writeln!(text, "{INDENT}}}");
            }
        }
        text + &self.keep_state()
    }

    /// The new state words, each written once at the end.
    fn keep_state(&self) -> String {
        let (outside, named) = (self.printer(true), self.printer(false));
        let Kept { reads, words } = kept(self.context, &self.stages);
        let mut text = String::new();
        for value in reads {
            let name = self.names.local(&self.context.function.node(value).name);
            let value = outside.whole(value);
            text.push_str(&wrapped(
                INDENT,
                &format!("const int32_t {name} = {value};"),
            ));
        }
        text.push('\n');
        for (word, value) in words {
            let field = self.names.local(&word.name);
            let line = format!("state->{field} = {};", named.kept(word, value));
            text.push_str(&wrapped(INDENT, &line));
        }
        text
    }

    fn definitions(&self) -> String {
        let own = self.stages.iter().zip(&self.shared);
        let own = own.filter(|&(_, &shared)| !shared);
        own.map(|(stage, _)| stage.definition()).collect()
    }
}

/// Reads the set-point words that a function uses or keeps, under their names.
fn read_params(program: &Program, function: &Function, kept: &[usize], names: &Names) -> String {
    let read = params_read(function);
    let is_read = |word: usize| read.contains(&word) || kept.contains(&word);
    let mut text = String::new();
    for shared in shared(program) {
        let field = names.local(&shared.name);
        let words = shared.words.iter().enumerate();
        let words: Vec<_> = words.filter(|(_, (word, _))| is_read(*word)).collect();
        if words.is_empty() {
            continue;
        }
        let bank = format!("{field}_bank");
        if shared.words.len() > 1 {
            let _ = writeln!(
                text,
                "{INDENT}const volatile int32_t *{bank} = set_point->{field}.banks[(set_point->{field}.published == 0) ? 0 : 1];"
            );
        }
        for (place, (_, word)) in words {
            let name = names.local(&word.name);
            let value = if shared.words.len() > 1 {
                format!("{bank}[{place}]")
            } else {
                format!("set_point->{field}")
            };
            let _ = writeln!(text, "{INDENT}const int32_t {name} = {value};");
        }
    }
    text
}

/// A setter, as a static function of the set-point, and its stages where it has several.
pub(super) fn emit_setter(program: &Program, function: &Function, names: &Names) -> String {
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
    let mut stores = String::new();
    let is_bus = function.name == "set_bus";
    let told = format!("{INDENT}set_point->bus_told = 1;\n");
    let mut kept_words = vec![];
    for (shared, values) in writes(program, function) {
        let field = names.local(&shared.name);
        let words = shared.words.iter().zip(values);
        let values = words.map(|(&(word, known), value)| {
            value.map_or_else(
                // Of words that are replaced together, what this setter leaves alone stays.
                || {
                    kept_words.push(word);
                    names.local(&known.name)
                },
                |value| printer.whole(value),
            )
        });
        let values: Vec<String> = values.collect();
        match values.as_slice() {
            [only] => {
                let line = format!("set_point->{field} = {only};");
                stores.push_str(&wrapped(INDENT, &line));
                if is_bus {
                    stores.push_str(&told);
                }
            }
            many => {
                let call = format!(
                    "store_{}(&set_point->{field}, {})",
                    shared.name,
                    many.join(", ")
                );
                if is_bus {
                    stores.push_str(&wrapped(INDENT, &format!("if ({call}) {{")));
                    let _ = writeln!(stores, "{INDENT}{told}{INDENT}}}");
                } else {
                    stores.push_str(&wrapped(INDENT, &format!("(void){call};")));
                }
            }
        }
    }
    let mut text = String::new();
    if !single {
        text.extend(stages.iter().map(StageFunction::definition));
    }
    let inputs = function.inputs.iter();
    let inputs = inputs.map(|input| format!("int32_t {}", names.local(&input.name)));
    let own = format!("{} *set_point", names.type_of("set_point"));
    let parameters: Vec<String> = std::iter::once(own).chain(inputs).collect();
    let head = format!(
        "static void {}({})",
        names.local(&function.name),
        parameters.join(", ")
    );
    let doc = format!("What `{}()` writes.", function.name);
    text.push_str(&names.comment("", &[doc]));
    text.push_str(&wrapped("", &head));
    text.push_str("{\n");
    text.push_str(&read_params(program, function, &kept_words, names));
    for stage in &stages {
        if single {
            let statements = stage.statements().into_iter();
            text.extend(statements.map(|statement| wrapped(INDENT, &statement)));
        } else {
            text.push_str(&stage.call());
        }
    }
    text.push_str(&stores);
    text + "}\n\n"
}

/// The functions that replace words which belong together: each fills the bank that is not in use, and then publishes
/// it, so that a reader that interrupts it gets the old words whole.
pub(super) fn emit_stores(program: &Program, names: &Names) -> String {
    let mut text = String::new();
    for shared in shared(program) {
        if shared.words.len() < 2 {
            continue;
        }
        let words = shared.words.iter();
        let words: Vec<String> = words.map(|(_, word)| names.local(&word.name)).collect();
        let parameters: Vec<String> = words.iter().map(|word| format!("int32_t {word}")).collect();
        let kind = names.type_of(&shared.name);
        text.push_str(&names.comment(
            "",
            &[
                "Replaces words as one: fills the bank that is not in use, and then publishes it. A reader that interrupts this",
                "gets the old words whole; a call that interrupts this one does nothing, as its bank would be filled further.",
                "Whether it did something.",
            ],
        ));
        let head = format!(
            "static bool store_{}({kind} *buffer, {})",
            shared.name,
            parameters.join(", ")
        );
        text.push_str(&wrapped("", &head));
        let inner = INDENT.repeat(2);
        let _ = writeln!(
            text,
            "{{\n{INDENT}if (buffer->storing != 0) {{\n{inner}return false;\n{INDENT}}}\n\
             {INDENT}buffer->storing = {};\n\
             {INDENT}const int32_t spare = (buffer->published == 0) ? 1 : 0;",
            typed_number(GIVEN_UP)
        );
        for (place, word) in words.iter().enumerate() {
            let _ = writeln!(text, "{INDENT}buffer->banks[spare][{place}] = {word};");
        }
        let _ = write!(
            text,
            "{INDENT}buffer->published = spare;\n{INDENT}buffer->storing = 0;\n{INDENT}return true;\n}}\n\n"
        );
    }
    text
}
