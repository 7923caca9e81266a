//! The step and the setters: stage calls in order, then what they leave behind.

use super::expression::Scope;
use super::groups::Shape;
use super::names::{docs, loaded, number, snake};
use super::plan::Context;
use super::stage::{StageFunction, output};
use crate::ir::{Function, Op, Program, Value, Word};
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
    let words = param_pattern(program, function);
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

/// The set-point words by name; an underscore for one that the function does not read.
fn param_pattern(program: &Program, function: &Function) -> TokenStream {
    let read = |index: usize| {
        function
            .nodes
            .iter()
            .any(|node| matches!(node.op, Op::Param(id) if id.index() == index))
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
    let slots = program.params.iter().enumerate().map(|(index, word)| {
        let written = function
            .next_params
            .iter()
            .any(|(param, _)| param.index() == index);
        let name = slot(word);
        if written { quote!(#name) } else { quote!(_) }
    });
    let writes: Vec<TokenStream> = function
        .next_params
        .iter()
        .map(|&(param, value)| {
            let slot = slot(&program.params[param.index()]);
            let value = scope.whole(value);
            quote!(*#slot = #value)
        })
        .collect();
    let update = match writes.as_slice() {
        [only] => quote!(#only),
        many => quote!({ #(#many;)* }),
    };
    let reads = function
        .nodes
        .iter()
        .any(|node| matches!(node.op, Op::Param(_)))
        .then(|| {
            let words = param_pattern(program, function);
            quote!(let #words = self.words.read();)
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
            self.words.update(|[#(#slots),*]| #update);
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

/// The place of a set-point word in the buffer, besides the value of its name.
fn slot(word: &Word) -> proc_macro2::Ident {
    snake(&format!("{}_word", word.name))
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
