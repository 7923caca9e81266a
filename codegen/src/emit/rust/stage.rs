//! One stage as one function, and its call.

use super::super::expression::Scope;
use super::super::plan::{Context, Outcome, StagePlan};
use super::super::signal::Signal;
use super::super::texts;
use super::expression::RustScope;
use super::groups::{ARGUMENTS, Group, bundle, group, rust_type};
use super::names::{camel, docs, loaded, snake};
use super::source::{Source, quote};
use crate::ir::{StateId, Word};

/// Results above this number are returned as a structure with named fields, and so are those whose
/// tuple is too complex by clippy's `type_complexity`.
const RESULTS: usize = 5;
const COMPLEXITY: usize = 250;

/// The function of a stage.
pub(super) struct StageFunction<'a> {
    context: &'a Context<'a>,
    plan: StagePlan<'a>,
    name: Source,
    arguments: Vec<Group>,
    argument_signals: Vec<Signal>,
    results: Results,
}

/// Results of a stage, and their form.
struct Results {
    signals: Vec<Signal>,
    groups: Vec<Group>,
    /// Name of their structure, if they are many.
    structure: Option<Source>,
}

impl Results {
    fn new(stage: &str, outcomes: &[Outcome]) -> Self {
        let signals: Vec<Signal> = outcomes
            .iter()
            .map(|outcome| outcome.signal.clone())
            .collect();
        let groups = group(&signals);
        let complexity: usize = groups
            .iter()
            .map(|group| if group.members.len() > 1 { 50 } else { 20 })
            .sum();
        let structure = (groups.len() > RESULTS || complexity + 10 > COMPLEXITY)
            .then(|| Source::of(format!("{}Results", camel(stage))));
        Self {
            signals,
            groups,
            structure,
        }
    }

    fn rust_type(&self) -> Source {
        let types: Vec<Source> = self.groups.iter().map(Group::rust_type).collect();
        match (&self.structure, types.as_slice()) {
            (Some(name), _) => quote!(#name),
            (None, [single]) => single.clone(),
            (None, many) => quote!((#(#many),*)),
        }
    }

    /// The pattern that binds all results by name.
    fn pattern(&self) -> Source {
        if let Some(structure) = &self.structure {
            let fields = self.signals.iter().map(|signal| snake(&signal.name));
            return quote!(#structure { #(#fields),* });
        }
        self.shaped(|member| {
            let name = snake(&self.signals[member].name);
            quote!(#name)
        })
    }

    /// The results built from one expression each.
    fn built(&self, mut of: impl FnMut(usize) -> Source) -> Source {
        let Some(structure) = &self.structure else {
            return self.shaped(of);
        };
        let fields = self.signals.iter().enumerate().map(|(member, signal)| {
            let field = snake(&signal.name);
            let value = of(member);
            if field == value {
                quote!(#field)
            } else {
                quote!(#field: #value)
            }
        });
        quote!(#structure { #(#fields),* })
    }

    fn shaped(&self, mut of: impl FnMut(usize) -> Source) -> Source {
        let parts: Vec<Source> = self.groups.iter().map(|group| group.of(&mut of)).collect();
        match parts.as_slice() {
            [single] => single.clone(),
            many => quote!((#(#many),*)),
        }
    }

    fn definition(&self, stage: &Source) -> Source {
        let Some(structure) = &self.structure else {
            return Source::new();
        };
        let fields = self.signals.iter().map(|signal| {
            let (name, kind) = (snake(&signal.name), rust_type(signal.shape));
            quote!(#name: #kind)
        });
        let line = format!("Results of [`{stage}`].");
        let doc = docs(&[line]);
        quote! {
            #doc
            struct #structure { #(#fields),* }
        }
    }
}

impl<'a> StageFunction<'a> {
    /// The function `name` for a planned stage.
    pub(super) fn new(context: &'a Context<'a>, plan: StagePlan<'a>, name: &str) -> Self {
        let argument_signals: Vec<Signal> = plan
            .arguments
            .iter()
            .map(|&value| context.signal(value))
            .collect();
        let state = usize::from(!plan.reads.is_empty() || !plan.stores.is_empty());
        let arguments = bundle(group(&argument_signals), ARGUMENTS - state);
        let results = Results::new(name, &plan.outcomes);
        Self {
            context,
            plan,
            name: snake(name),
            arguments,
            argument_signals,
            results,
        }
    }

    /// Its plan.
    pub(super) fn plan(&self) -> &StagePlan<'a> {
        &self.plan
    }

    fn scope(&self, reads_state: bool) -> Scope<'a> {
        Scope {
            context: self.context,
            reads_state,
        }
    }

    fn word(&self, state: StateId) -> &'a Word {
        &self.context.program.states[state.index()]
    }

    /// Whether the stage computes or stores anything.
    fn has_body(&self) -> bool {
        !self.plan.body.is_empty() || !self.plan.stores.is_empty()
    }

    /// The statement that runs the stage.
    pub(super) fn call(&self) -> Source {
        let scope = self.scope(true);
        let mut arguments: Vec<Source> = vec![];
        if !self.plan.reads.is_empty() || !self.plan.stores.is_empty() {
            arguments.push(quote!(state));
        }
        arguments.extend(
            self.arguments
                .iter()
                .map(|group| group.names(&self.argument_signals)),
        );
        let name = &self.name;
        let call = quote!(#name(#(#arguments),*));
        let Some(guard) = &self.plan.stage.guard else {
            let pattern = self.results.pattern();
            return if self.has_body() {
                quote!(let #pattern = #call;)
            } else {
                Source::new()
            };
        };
        let condition = scope.whole(guard.condition);
        let taken = if self.has_body() {
            call
        } else {
            self.results.built(|member| {
                scope.shaped(
                    self.plan.outcomes[member].value,
                    self.plan.outcomes[member].signal.shape,
                )
            })
        };
        if self.plan.outcomes.is_empty() {
            return quote!(if #condition { #taken; });
        }
        let pattern = self.results.pattern();
        let otherwise = self.results.built(|member| {
            let outcome = &self.plan.outcomes[member];
            scope.shaped(
                outcome.otherwise.unwrap_or(outcome.value),
                outcome.signal.shape,
            )
        });
        quote!(let #pattern = if #condition { #taken } else { #otherwise };)
    }

    /// The `let`s of the stage.
    pub(super) fn statements(&self) -> Vec<Source> {
        let scope = self.scope(false);
        let reads = self.plan.reads.iter().map(|&state| {
            let word = self.word(state);
            let name = snake(&word.name);
            let value = loaded(word, &quote!(state.#name));
            quote!(let #name = #value;)
        });
        let named = self
            .plan
            .body
            .iter()
            .filter(|&&value| !self.context.function.node(value).name.is_empty());
        let computed = named.map(|&value| {
            let name = snake(&self.context.function.node(value).name);
            let definition = scope.bound(value);
            quote!(let #name = #definition;)
        });
        reads.chain(computed).collect()
    }

    /// The function, and the structure of its results where there is one.
    pub(super) fn definition(&self) -> Source {
        if !self.has_body() {
            return Source::new();
        }
        let mut statements = self.statements();
        let scope = self.scope(false);
        for &(state, value) in &self.plan.stores {
            let word = self.word(state);
            let field = snake(&word.name);
            let value = scope.kept(word, value);
            statements.push(quote!(state.#field = #value;));
        }
        let (result, tail) = self.result(&mut statements);
        let parameters = self.parameters();
        let (name, doc) = (&self.name, self.doc());
        let placement = match &self.plan.stage.guard {
            Some(guard) if guard.rare => quote!(#[cold] #[inline(never)]),
            _ => quote!(#[inline]),
        };
        let structure = self.results.definition(name);
        quote! {
            #structure
            #doc
            #placement
            fn #name(#(#parameters),*) #result {
                #(#statements)*
                #tail
            }
        }
    }

    fn parameters(&self) -> Vec<Source> {
        let mut parameters = vec![];
        if !self.plan.stores.is_empty() {
            parameters.push(quote!(state: &mut State));
        } else if !self.plan.reads.is_empty() {
            parameters.push(quote!(state: &State));
        }
        parameters.extend(self.arguments.iter().map(|group| {
            let names = group.names(&self.argument_signals);
            let kind = group.rust_type();
            quote!(#names: #kind)
        }));
        parameters
    }

    /// The return type, and the function's last expression; a single result is not bound to its
    /// name first.
    fn result(&self, statements: &mut Vec<Source>) -> (Source, Source) {
        let scope = self.scope(false);
        if self.plan.outcomes.is_empty() {
            return (Source::new(), Source::new());
        }
        let kind = self.results.rust_type();
        let last = self
            .plan
            .body
            .iter()
            .rev()
            .find(|&&value| !self.context.function.node(value).name.is_empty());
        let tail = match (self.plan.outcomes.as_slice(), last) {
            ([single], Some(&last))
                if single.value == last
                    && self.context.shape(last) == single.signal.shape
                    && self.plan.stores.is_empty() =>
            {
                statements.pop();
                scope.bound(last)
            }
            _ => self.results.built(|member| {
                scope.shaped(
                    self.plan.outcomes[member].value,
                    self.plan.outcomes[member].signal.shape,
                )
            }),
        };
        (quote!(-> #kind), tail)
    }

    /// The stage's documentation, and the proven ranges of its results.
    fn doc(&self) -> Source {
        let members = self.results.groups.iter().flat_map(|group| &group.members);
        let outcomes = members.map(|&member| &self.plan.outcomes[member]);
        let name = |name: &str| snake(name).to_string();
        docs(&texts::stage(
            self.context,
            &self.plan.stage.doc,
            outcomes,
            name,
        ))
    }
}
