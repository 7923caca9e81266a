//! The step and the setters: stage calls in order, then what they leave behind.

use super::super::expression::Scope;
use super::super::path::StageCode as _;
use super::super::path::{
    Kept, beside, inputs_read, kept, leaves_behind, output, params_read, words_read, writes,
};
use super::super::plan::{Context, StagePlan};
use super::super::rows::WholeCommand;
use super::super::signal::Shape;
use super::expression::RustScope;
use super::groups::array;
use super::names::{docs, loaded, number, snake};
use super::source::{Source, quote};
use super::stage::StageFunction;
use super::tables::look_up_command;
use crate::ir::{Function, Paths, Program, Word};

/// A function and the functions of its stages.
pub(super) struct Emitted {
    /// The function itself.
    pub main: Source,
    /// Its stages, in order of their calls.
    pub stages: Source,
}

/// A setter of set-point words.
pub(super) struct Setter {
    /// The method of the set-point.
    pub method: Source,
    /// The method of the drive, which calls it.
    pub delegate: Source,
    /// Its stages, in order of their calls.
    pub stages: Source,
}

/// The control step, `fn step(state, set-point, inputs) -> Legs`, and what takes over where it rests: there alone mode and
/// fault change, so there they are published.
///
/// A command that is looked up as a `whole` goes out from its row.
pub(super) fn emit_step(
    program: &Program,
    Paths { normal, exit }: &Paths,
    whole: Option<&WholeCommand<'_>>,
) -> Emitted {
    let context = Context::watched(program, normal, whole);
    let path = PathFunctions::new(&context, &[]);
    let exit = exit
        .as_ref()
        .map(|exit| Context::beside(program, exit, &context));
    let exit = exit
        .as_ref()
        .map(|exit| PathFunctions::new(exit, &path.stages));
    let read: Vec<usize> = exit
        .iter()
        .flat_map(|exit| params_read(exit.context.function))
        .collect();
    let words = param_pattern(program, normal, &read);
    let inputs = normal.inputs.iter().map(|input| {
        let name = snake(&input.name);
        quote!(#name: Word)
    });
    let doc = docs(&normal.doc);
    let leave = exit.as_ref().map(PathFunctions::call_rest);
    let (body, legs) = (path.body(leave.as_ref()), path.legs(whole));
    let main = quote! {
        #doc
        #[inline]
        fn step(state: &mut State, set_point: &SetPoint, #(#inputs),*) -> Legs {
            let #words = set_point.words();
            #body
            #legs
        }
    };
    let stages = path.definitions();
    let at_rest = exit.as_ref().map(PathFunctions::rest);
    Emitted {
        main,
        stages: quote!(#stages #at_rest),
    }
}

/// One path of the step.
struct PathFunctions<'a> {
    context: &'a Context<'a>,
    stages: Vec<StageFunction<'a>>,
    /// Which stages are functions of the other path.
    shared: Vec<bool>,
}

impl<'a> PathFunctions<'a> {
    /// The functions of a path beside those of another.
    fn new(context: &'a Context<'a>, others: &[StageFunction<'a>]) -> Self {
        let make = |plan: StagePlan<'a>, name: &str| StageFunction::new(context, plan, name);
        let (stages, shared) = beside(context, others, make);
        Self {
            context,
            stages,
            shared,
        }
    }

    /// The statement that leaves the step for this path. Where what it hands over fits the registers that carry
    /// arguments, as it does without set-point words, the compiler ends the step with a jump.
    fn call_rest(&self) -> Source {
        let inputs = self.inputs().into_iter().map(|pair| match pair.as_slice() {
            [only] => quote!(#only),
            both => quote!([#(#both.to_u16()),*]),
        });
        let words = self.words();
        quote!(return rest(state, set_point, #(#inputs,)* #(#words),*);)
    }

    /// This path as a function of its own, which publishes what the drive is doing from here on. No leg pulses at
    /// rest, and all are alike.
    fn rest(&self) -> Source {
        let words = self.words();
        let (mut parameters, mut widened) = (vec![], vec![]);
        for pair in self.inputs() {
            match pair.as_slice() {
                [only] => parameters.push(quote!(#only: Word)),
                both => {
                    parameters.push(quote!([#(#both),*]: [u16; 2]));
                    widened.push(quote!(let [#(#both),*] = [#(Word::from(#both)),*];));
                }
            }
        }
        let (body, stages) = (self.body(None), self.definitions());
        let leg = self.leg("leg_a");
        quote! {
            /// One control period without current control, in start-up or with a fault: what all legs do. Publishes
            /// what the drive is doing from here on.
            #[cold]
            #[inline(never)]
            fn rest(state: &mut State, set_point: &SetPoint, #(#parameters,)* #(#words: Word),*) -> Legs {
                #(#widened)*
                #body
                set_point.status.store(state.status());
                Legs::at_rest(#leg)
            }
            #stages
        }
    }

    /// Names of the set-point words that it reads.
    fn words(&self) -> Vec<Source> {
        let names = words_read(self.context.program, self.context.function);
        names.into_iter().map(snake).collect()
    }

    /// Names of the inputs that it reads, by twos: an input is a halfword, and two share a register.
    fn inputs(&self) -> Vec<Vec<Source>> {
        let names: Vec<Source> = inputs_read(self.context.function)
            .into_iter()
            .map(snake)
            .collect();
        names.chunks(2).map(<[Source]>::to_vec).collect()
    }

    /// What is seen behind the stages: old state words that go out of the step are read under their names before
    /// any is written.
    fn scope(&self) -> Scope<'a> {
        Scope {
            context: self.context,
            reads_state: false,
        }
    }

    fn leg(&self, name: &str) -> Source {
        match output(self.context.function, name) {
            None => quote!(LegState::Off),
            Some(value) => self.scope().shaped(value, Shape::Leg),
        }
    }

    fn legs(&self, whole: Option<&WholeCommand<'_>>) -> Source {
        let scope = self.scope();
        if let Some(whole) = whole {
            return look_up_command(whole, &scope.whole(whole.index));
        }
        let compare = ["compare_a", "compare_b", "compare_c"].map(|name| {
            match output(self.context.function, name) {
                None => quote!(0),
                Some(value) => scope.literal(value).map_or_else(
                    || {
                        let value = scope.receiver(value);
                        quote!(#value.to_u16())
                    },
                    |literal| number(i64::from(literal)),
                ),
            }
        });
        let states = ["leg_a", "leg_b", "leg_c"].map(|name| self.leg(name));
        let states = array(&states);
        quote!(Legs::new([#(#compare),*], #states))
    }

    /// Stage calls in order, with `leave` behind those that find a reason for it; then the new state.
    fn body(&self, leave: Option<&Source>) -> Source {
        let (function, scope) = (self.context.function, self.scope());
        // Alarms wait for the last of them: one branch for all.
        let mut alarms: Vec<(bool, Source)> = vec![];
        let last = function.leave.iter().map(|flag| flag.index()).max();
        let calls = self.stages.iter().map(|stage| {
            let call = stage.call();
            let mut flags: Vec<Source> = vec![];
            for flag in leaves_behind(function, stage.plan()) {
                match self.context.shape(flag) {
                    Shape::Alarm => {
                        alarms.push((!scope.is_sign(flag), scope.shaped(flag, Shape::Alarm)));
                    }
                    _ => flags.push(scope.whole(flag)),
                }
            }
            if last.is_some_and(|last| stage.plan().stage.end > last) && !alarms.is_empty() {
                // Signs stand together, so that one shift does for them.
                alarms.sort_by_key(|&(is_last, _)| is_last);
                let words: Vec<Source> = alarms.drain(..).map(|(_, word)| word).collect();
                flags.push(match words.as_slice() {
                    [only] => quote!(#only != 0),
                    many => quote!((#(#many)|*) != 0),
                });
            }
            let leaves = (!flags.is_empty()).then(|| quote!(if #(#flags)||* { #leave }));
            quote!(#call #leaves)
        });
        let keep = keep_state(self.context, &self.stages);
        quote! { #(#calls)* #keep }
    }

    fn definitions(&self) -> Source {
        let own = self.stages.iter().zip(&self.shared);
        let own = own.filter(|&(_, &shared)| !shared);
        own.map(|(stage, _)| stage.definition()).collect()
    }
}

/// The set-point words by name; an underscore for one that the function neither reads nor keeps.
fn param_pattern(program: &Program, function: &Function, kept: &[usize]) -> Source {
    let read = params_read(function);
    let read = |index: usize| kept.contains(&index) || read.contains(&index);
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

/// The new state words, each written once at the end.
fn keep_state(context: &Context<'_>, stages: &[StageFunction<'_>]) -> Source {
    let scope = |reads_state| Scope {
        context,
        reads_state,
    };
    let (outside, named) = (scope(true), scope(false));
    let Kept { reads, words } = kept(context, stages);
    let reads = reads.into_iter().map(|value| {
        let name = snake(&context.function.node(value).name);
        let value = outside.whole(value);
        quote!(let #name = #value;)
    });
    let writes = words.into_iter().map(|(word, value)| {
        let field = snake(&word.name);
        let value = named.kept(word, value);
        quote!(state.#field = #value;)
    });
    quote!(#(#reads)* #(#writes)*)
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
    let body: Source = if single {
        stages.iter().flat_map(StageFunction::statements).collect()
    } else {
        stages.iter().map(StageFunction::call).collect()
    };
    let scope = Scope {
        context: &context,
        reads_state: true,
    };
    let mut kept = vec![];
    let mut stores = Source::new();
    // The watch over the bus voltage is told of calls that take effect.
    let told = (function.name == "set_bus").then(|| quote!(self.bus_watch.told();));
    for (shared, values) in writes(program, function) {
        let values = shared
            .words
            .iter()
            .zip(values)
            .map(|(&(word, known), value)| {
                if let Some(value) = value {
                    return scope.whole(value);
                }
                // Of words that are replaced together, what this setter leaves alone stays.
                kept.push(word);
                let name = snake(&known.name);
                quote!(#name)
            });
        let values: Vec<Source> = values.collect();
        let name = snake(&shared.name);
        stores.insert(&match (values.as_slice(), &told) {
            ([only], told) => quote!(self.#name.store(#only); #told),
            (many, None) => quote!(self.#name.store([#(#many),*]);),
            (many, Some(told)) => quote!(if self.#name.store([#(#many),*]) { #told }),
        });
    }
    let reads = (!kept.is_empty() || !params_read(function).is_empty()).then(|| {
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
        Source::new()
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
    typed: Source,
    /// Without.
    names: Source,
    /// What makes words of them.
    conversion: Source,
}

fn setter_arguments(function: &Function) -> Arguments {
    let quantity = match function.name.as_str() {
        "set_current" => Some(snake("current")),
        "set_torque" => Some(snake("torque")),
        "set_speed" => Some(snake("speed")),
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
    let conversions = names
        .iter()
        .map(|name| quote!(let #name = Word::from(#name);));
    Arguments {
        typed: quote!(#(#names: #types),*),
        names: quote!(#(#names),*),
        conversion: conversions.collect(),
    }
}

/// A state word read at its place, for methods of the state.
pub(super) fn state_word(word: &Word) -> Source {
    let field = snake(&word.name);
    loaded(word, &quote!(self.#field))
}
