//! The step and the setters: stage calls in order, then what they leave behind.

use super::super::set_point::shared;
use super::expression::Scope;
use super::groups::Shape;
use super::names::{docs, loaded, number, snake};
use super::plan::Context;
use super::stage::{StageFunction, output};
use crate::ir::{Function, Node, Op, Program, Value, Word};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// A function and the functions of its stages.
pub(super) struct Emitted {
    /// The function itself.
    pub main: TokenStream,
    /// Its stages, in order of their calls.
    pub stages: TokenStream,
}

/// A setter of set-point words.
pub(super) struct Setter {
    /// The method of the set-point.
    pub method: TokenStream,
    /// The method of the drive, which calls it.
    pub delegate: TokenStream,
    /// Its stages, in order of their calls.
    pub stages: TokenStream,
}

/// The control step: `fn step(state, set-point words, inputs) -> Legs`.
pub(super) fn emit_step(program: &Program) -> Emitted {
    let function = &program.step;
    let context = Context::new(program, function);
    let stages: Vec<StageFunction<'_>> = context
        .plan()
        .into_iter()
        .map(|plan| {
            let name = plan.stage.name.clone();
            StageFunction::new(&context, plan, &name)
        })
        .collect();
    let calls = stages.iter().map(StageFunction::call);
    // Old state words that go out of the step are read under their names before any is written.
    let scope = Scope {
        context: &context,
        reads_state: false,
    };
    let keep = keep_state(&context, &stages);
    let words = param_pattern(program, function, &[]);
    let count = Literal::usize_unsuffixed(program.params.len());
    let inputs = function.inputs.iter().map(|input| {
        let name = snake(&input.name);
        quote!(#name: Word)
    });
    let compare =
        ["compare_a", "compare_b", "compare_c"].map(|name| match output(function, name) {
            None => quote!(0),
            Some(value) => scope.literal(value).map_or_else(
                || {
                    let value = scope.receiver(value);
                    quote!(#value.to_u16())
                },
                |literal| number(i64::from(literal)),
            ),
        });
    let state = ["leg_a", "leg_b", "leg_c"].map(|name| match output(function, name) {
        None => quote!(LegState::Off),
        Some(value) => scope.shaped(value, Shape::Leg),
    });
    let doc = docs(&function.doc);
    let main = quote! {
        #doc
        #[inline]
        fn step(state: &mut State, #words: [Word; #count], #(#inputs),*) -> Legs {
            #(#calls)*
            #keep
            Legs { compare: [#(#compare),*], state: [#(#state),*] }
        }
    };
    Emitted {
        main,
        stages: stages.iter().map(StageFunction::definition).collect(),
    }
}

/// The set-point words by name; an underscore for one that the function neither reads nor keeps.
fn param_pattern(program: &Program, function: &Function, kept: &[usize]) -> TokenStream {
    let read = |index: usize| {
        let mut nodes = function.nodes.iter();
        kept.contains(&index)
            || nodes.any(|node| matches!(node.op, Op::Param(id) if id.index() == index))
    };
    let names = program.params.iter().enumerate().map(|(index, word)| {
        let name = snake(&word.name);
        if read(index) {
            quote!(#name)
        } else {
            quote!(_)
        }
    });
    quote!([#(#names),*])
}

/// The new state words, each written once at the end. Old words that go into other words or out of
/// the step are read before anything is written.
fn keep_state(context: &Context<'_>, stages: &[StageFunction<'_>]) -> TokenStream {
    let (program, function) = (context.program, context.function);
    let outside = Scope {
        context,
        reads_state: true,
    };
    let named = Scope {
        context,
        reads_state: false,
    };
    let kept: Vec<(&Word, Value)> = function
        .next_state
        .iter()
        .filter(|(state, value)| function.node(*value).op != Op::State(*state))
        .filter(|(state, _)| !stages.iter().any(|stage| stage.stores(*state)))
        .map(|&(state, value)| (&program.states[state.index()], value))
        .collect();
    let is_old = |value: Value| matches!(function.node(value).op, Op::State(_));
    let mut reads = TokenStream::new();
    let mut read: Vec<Value> = vec![];
    let results = kept
        .iter()
        .map(|&(_, value)| value)
        .chain(function.outputs.iter().map(|&(_, value)| value));
    for value in results {
        if is_old(value) && !read.contains(&value) {
            read.push(value);
            let name = snake(&function.node(value).name);
            let value = outside.whole(value);
            reads.extend(quote!(let #name = #value;));
        }
    }
    let writes = kept.iter().map(|&(word, value)| {
        let field = snake(&word.name);
        let value = named.kept(word, value);
        quote!(state.#field = #value;)
    });
    quote!(#reads #(#writes)*)
}

/// A setter: a method of the set-point. Stages of a setter that has several become functions named
/// after it.
pub(super) fn emit_setter(program: &Program, function: &Function) -> Setter {
    let context = Context::new(program, function);
    let plans = context.plan();
    let single = matches!(plans.as_slice(), [only] if only.stage.guard.is_none());
    let stages: Vec<StageFunction<'_>> = plans
        .into_iter()
        .map(|plan| {
            let name = format!("{}_{}", function.name, plan.stage.name);
            StageFunction::new(&context, plan, &name)
        })
        .collect();
    let body: TokenStream = if single {
        stages.iter().flat_map(StageFunction::statements).collect()
    } else {
        stages.iter().map(StageFunction::call).collect()
    };
    let scope = Scope {
        context: &context,
        reads_state: true,
    };
    let written = |word: usize| {
        let mut written = function.next_params.iter();
        written.find(|(param, _)| param.index() == word)
    };
    let mut kept = vec![];
    let mut stores = TokenStream::new();
    for shared in shared(program) {
        let words = shared.words;
        if words.iter().all(|&(word, _)| written(word).is_none()) {
            continue;
        }
        let values = words.iter().map(|&(word, known)| {
            if let Some(&(_, value)) = written(word) {
                return scope.whole(value);
            }
            // Of words that are replaced together, what this setter leaves alone stays.
            kept.push(word);
            let name = snake(&known.name);
            quote!(#name)
        });
        let values: Vec<TokenStream> = values.collect();
        let name = snake(&shared.name);
        stores.extend(match values.as_slice() {
            [only] => quote!(self.#name.store(#only);),
            many => quote!(self.#name.store([#(#many),*]);),
        });
    }
    let reads_words = |node: &Node| matches!(node.op, Op::Param(_));
    let reads = (!kept.is_empty() || function.nodes.iter().any(reads_words)).then(|| {
        let words = param_pattern(program, function, &kept);
        quote!(let #words = self.words();)
    });
    let Arguments {
        typed,
        names,
        conversion,
    } = setter_arguments(function);
    let (name, doc) = (snake(&function.name), docs(&function.doc));
    let method = quote! {
        #doc
        pub fn #name(&self, #typed) {
            #conversion
            #reads
            #body
            #stores
        }
    };
    let delegate = quote! {
        #doc
        pub fn #name(&self, #typed) {
            self.set_point.#name(#names);
        }
    };
    let stages = if single {
        TokenStream::new()
    } else {
        stages.iter().map(StageFunction::definition).collect()
    };
    Setter {
        method,
        delegate,
        stages,
    }
}

/// The arguments of a setter.
struct Arguments {
    /// With their types.
    typed: TokenStream,
    /// Without.
    names: TokenStream,
    /// What makes words of them.
    conversion: TokenStream,
}

fn setter_arguments(function: &Function) -> Arguments {
    let quantity = match function.name.as_str() {
        "set_current" => Some(snake("current")),
        "set_torque" => Some(snake("torque")),
        _ => None,
    };
    if let (Some(quantity), [input]) = (quantity, function.inputs.as_slice()) {
        let name = snake(&input.name);
        return Arguments {
            typed: quote!(#quantity: I16F16),
            names: quote!(#quantity),
            conversion: quote!(let #name = Word(#quantity.to_bits());),
        };
    }
    let names: Vec<_> = function
        .inputs
        .iter()
        .map(|input| snake(&input.name))
        .collect();
    let types = function.inputs.iter().map(|input| {
        let narrow = input.interval.low >= 0 && input.interval.high <= i64::from(u16::MAX);
        if narrow { quote!(u16) } else { quote!(i32) }
    });
    Arguments {
        typed: quote!(#(#names: #types),*),
        names: quote!(#(#names),*),
        conversion: quote!(#(let #names = Word::from(#names);)*),
    }
}

/// A state word read at its place, for methods of the state.
pub(super) fn state_word(word: &Word) -> TokenStream {
    let field = snake(&word.name);
    loaded(word, &quote!(self.#field))
}
