//! One stage as one function, and its call.

use super::super::expression::Scope;
use super::super::plan::{Context, Outcome, StagePlan};
use super::super::signal::{Shape, Signal};
use super::super::texts;
use super::expression::Printer;
use super::layout::{INDENT, wrapped};
use super::names::Names;
use crate::ir::Guard;
use std::fmt::Write as _;

/// The function of a stage.
///
/// A stage with one result returns it. With several, a guarded stage, which may be off the normal
/// path, returns a structure, so that no word of the caller needs an address; any other writes
/// through pointers, which inlining removes.
pub(super) struct StageFunction<'a> {
    context: &'a Context<'a>,
    names: &'a Names,
    plan: StagePlan<'a>,
    own_name: String,
    arguments: Vec<Signal>,
}

impl<'a> StageFunction<'a> {
    /// The function `name` for a planned stage.
    pub(super) fn new(
        context: &'a Context<'a>,
        names: &'a Names,
        plan: StagePlan<'a>,
        name: &str,
    ) -> Self {
        let arguments = plan.arguments.iter().map(|&value| context.signal(value));
        Self {
            context,
            names,
            own_name: names.local(name),
            arguments: arguments.collect(),
            plan,
        }
    }

    /// Its plan.
    pub(super) fn plan(&self) -> &StagePlan<'a> {
        &self.plan
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

    /// Whether the stage computes or stores anything.
    fn has_body(&self) -> bool {
        !self.plan.body.is_empty() || !self.plan.stores.is_empty()
    }

    /// Whether it returns a structure.
    fn has_structure(&self) -> bool {
        self.plan.stage.guard.is_some() && self.plan.outcomes.len() > 1
    }

    fn structure(&self) -> String {
        format!("{}_results", self.own_name)
    }

    fn local(&self, outcome: &Outcome) -> String {
        self.names.local(&outcome.signal.name)
    }

    /// The call, with these results after its own arguments.
    fn call_with(&self, results: impl Iterator<Item = String>) -> String {
        let uses_state = !self.plan.reads.is_empty() || !self.plan.stores.is_empty();
        let state = uses_state.then(|| "state".to_owned()).into_iter();
        let arguments = self.arguments.iter();
        let arguments = arguments.map(|signal| self.names.local(&signal.name));
        let all: Vec<String> = state.chain(arguments).chain(results).collect();
        format!("{}({})", self.own_name, all.join(", "))
    }

    /// The statements that run the stage.
    pub(super) fn call(&self) -> String {
        match &self.plan.stage.guard {
            None => self.plain_call(),
            Some(guard) => self.guarded_call(guard),
        }
    }

    fn plain_call(&self) -> String {
        if !self.has_body() {
            return String::new();
        }
        if let [only] = self.plan.outcomes.as_slice() {
            let (kind, name) = (kind(only.signal.shape), self.local(only));
            let call = self.call_with(std::iter::empty());
            return wrapped(INDENT, &format!("const {kind} {name} = {call};"));
        }
        let mut text = String::new();
        // One declaration per type, in the order of the first ones.
        let mut kinds: Vec<(&str, Vec<String>)> = vec![];
        for outcome in &self.plan.outcomes {
            let (kind, name) = (kind(outcome.signal.shape), self.local(outcome));
            match kinds.iter_mut().find(|(known, _)| *known == kind) {
                Some((_, names)) => names.push(name),
                None => kinds.push((kind, vec![name])),
            }
        }
        for (kind, names) in kinds {
            text.push_str(&wrapped(INDENT, &format!("{kind} {};", names.join(", "))));
        }
        let results = self.plan.outcomes.iter();
        let results = results.map(|outcome| format!("&{}", self.local(outcome)));
        text + &wrapped(INDENT, &format!("{};", self.call_with(results)))
    }

    fn guarded_call(&self, guard: &Guard) -> String {
        let printer = self.printer(true);
        let condition = printer.whole(guard.condition);
        let call = self.call_with(std::iter::empty());
        let otherwise = |outcome: &Outcome| outcome.otherwise.unwrap_or(outcome.value);
        let mut text = String::new();
        if !self.has_structure() || !self.has_body() {
            for outcome in &self.plan.outcomes {
                let (kind, name) = (kind(outcome.signal.shape), self.local(outcome));
                let shape = outcome.signal.shape;
                let taken = if self.has_body() {
                    call.clone()
                } else {
                    printer.arm(outcome.value, shape)
                };
                let otherwise = printer.arm(otherwise(outcome), shape);
                let flag = printer.condition(guard.condition);
                let line = format!("const {kind} {name} = {flag} ? {taken} : {otherwise};");
                text.push_str(&wrapped(INDENT, &line));
            }
            if self.plan.outcomes.is_empty() && self.has_body() {
                let _ = writeln!(text, "{INDENT}if ({condition}) {{");
                text.push_str(&wrapped(&INDENT.repeat(2), &format!("{call};")));
                let _ = writeln!(text, "{INDENT}}}");
            }
            return text;
        }
        for outcome in &self.plan.outcomes {
            let (kind, name) = (kind(outcome.signal.shape), self.local(outcome));
            let value = printer.shaped(otherwise(outcome), outcome.signal.shape);
            let line = format!("{kind} {name} = {value};");
            text.push_str(&wrapped(INDENT, &line));
        }
        let _ = writeln!(text, "{INDENT}if ({condition}) {{");
        let inner = INDENT.repeat(2);
        let line = format!("const {} result = {call};", self.structure());
        text.push_str(&wrapped(&inner, &line));
        for outcome in &self.plan.outcomes {
            let name = self.local(outcome);
            let _ = writeln!(text, "{inner}{name} = result.{name};");
        }
        text + INDENT + "}\n"
    }

    /// The statements that bind its values.
    pub(super) fn statements(&self) -> Vec<String> {
        let printer = self.printer(false);
        let states = &self.context.program.states;
        let reads = self.plan.reads.iter().map(|state| {
            let name = self.names.local(&states[state.index()].name);
            format!("const int32_t {name} = state->{name};")
        });
        let function = self.context.function;
        let named = self.plan.body.iter();
        let named = named.filter(|&&value| !function.node(value).name.is_empty());
        let computed = named.map(|&value| {
            let name = self.names.local(&function.node(value).name);
            let kind = kind(self.context.shape(value));
            format!("const {kind} {name} = {};", printer.bound(value))
        });
        reads.chain(computed).collect()
    }

    /// The function, and the structure of its results where there is one.
    pub(super) fn definition(&self) -> String {
        if !self.has_body() {
            return String::new();
        }
        let printer = self.printer(false);
        let mut statements = self.statements();
        for &(state, value) in &self.plan.stores {
            let word = &self.context.program.states[state.index()];
            let value = printer.kept(word, value);
            statements.push(format!(
                "state->{} = {value};",
                self.names.local(&word.name)
            ));
        }
        let result = self.hand_over(&mut statements);
        let mut text = self.structure_definition();
        text.push_str(&self.comment());
        text.push_str(&self.head(&result));
        text.push_str("{\n");
        for statement in statements {
            text.push_str(&wrapped(INDENT, &statement));
        }
        text + "}\n\n"
    }

    fn structure_definition(&self) -> String {
        if !self.has_structure() {
            return String::new();
        }
        let line = format!("Results of {}.", self.own_name);
        let mut text = self.names.comment("", &[line]) + "typedef struct {\n";
        for outcome in &self.plan.outcomes {
            let (kind, name) = (kind(outcome.signal.shape), self.local(outcome));
            let _ = writeln!(text, "{INDENT}{kind} {name};");
        }
        text + &format!("}} {};\n\n", self.structure())
    }

    /// Adds the statements that hand the results over, and returns the function's type. A single
    /// result is not bound to its name first.
    fn hand_over(&self, statements: &mut Vec<String>) -> String {
        let printer = self.printer(false);
        let shaped = |outcome: &Outcome| printer.shaped(outcome.value, outcome.signal.shape);
        if self.has_structure() {
            let values: Vec<String> = self.plan.outcomes.iter().map(shaped).collect();
            let kind = self.structure();
            statements.push(format!(
                "const {kind} result = {{ {} }};",
                values.join(", ")
            ));
            statements.push("return result;".to_owned());
            return kind;
        }
        let [only] = self.plan.outcomes.as_slice() else {
            let outcomes = self.plan.outcomes.iter();
            statements.extend(outcomes.map(|outcome| {
                format!(
                    "*{} = {};",
                    result_name(&self.local(outcome)),
                    shaped(outcome)
                )
            }));
            return "void".to_owned();
        };
        let function = self.context.function;
        let mut named = self.plan.body.iter().rev();
        let last = named.find(|&&value| !function.node(value).name.is_empty());
        let is_last = last.is_some_and(|&last| {
            only.value == last && self.context.shape(last) == only.signal.shape
        });
        if is_last && self.plan.stores.is_empty() {
            statements.pop();
            statements.push(format!("return {};", printer.bound(only.value)));
        } else {
            statements.push(format!("return {};", shaped(only)));
        }
        kind(only.signal.shape).to_owned()
    }

    fn head(&self, result: &str) -> String {
        let mut parameters = vec![];
        let state = self.names.state();
        if !self.plan.stores.is_empty() {
            parameters.push(format!("{state} *state"));
        } else if !self.plan.reads.is_empty() {
            parameters.push(format!("const {state} *state"));
        }
        parameters.extend(self.arguments.iter().map(|signal| {
            let (kind, name) = (kind(signal.shape), self.names.local(&signal.name));
            format!("{kind} {name}")
        }));
        if !self.has_structure() && self.plan.outcomes.len() > 1 {
            parameters.extend(self.plan.outcomes.iter().map(|outcome| {
                let (kind, name) = (kind(outcome.signal.shape), self.local(outcome));
                format!("{kind} *{}", result_name(&name))
            }));
        }
        if parameters.is_empty() {
            parameters.push("void".to_owned());
        }
        let guard = self.plan.stage.guard.as_ref();
        let is_rare = guard.is_some_and(|guard| guard.rare);
        let (before, inline) = if is_rare {
            ("HEXAGEN_COLD\n".to_owned(), "")
        } else {
            (String::new(), "inline ")
        };
        let (name, parameters) = (&self.own_name, parameters.join(", "));
        before + &wrapped("", &format!("static {inline}{result} {name}({parameters})"))
    }

    /// The stage's documentation, and the proven ranges of its results.
    fn comment(&self) -> String {
        let name = |name: &str| self.names.local(name);
        let outcomes = self.plan.outcomes.iter();
        let lines = texts::stage(self.context, &self.plan.stage.doc, outcomes, name);
        self.names.comment("", &lines)
    }
}

/// Name of the pointer to a result.
fn result_name(name: &str) -> String {
    format!("{name}_out")
}

/// Type of a value.
pub(super) fn kind(shape: Shape) -> &'static str {
    match shape {
        Shape::Word => "int32_t",
        Shape::Flag => "bool",
        Shape::Leg => "hexagen_leg",
    }
}
