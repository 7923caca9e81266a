//! The entries of the law: stage calls in order, then the new state words.

use super::super::expression::Scope;
use super::super::path::{
    Kept, Part, SINGLE, demands_read, inputs_used, kept, kept_at_rest, writes,
};
use super::super::plan::Context;
use super::super::rows::WholeCommand;
use super::super::signal::Shape;
use super::expression::RustScope;
use super::groups::{array, rust_type};
use super::names::{docs, number, snake};
use super::source::{Source, quote};
use super::stage::StageFunction;
use super::tables::look_up_command;
use crate::ir::{AtRest, Demand, Function, Op, Output, Phase, Program, Setter, Told, Value};

/// The step of a program as entries of a law.
pub(super) struct StepCode {
    /// `track`, `rest` and `step`.
    pub entries: Source,
    /// The type that `track` returns.
    pub rotor: Source,
    /// Its definition, if it has one.
    pub rotor_definition: Source,
    /// The stages, in order of their calls.
    pub stages: Source,
}

/// The entries of a program's step; `whole`: its command is looked up as a whole.
pub(super) fn emit_step(program: &Program, whole: Option<&WholeCommand<'_>>) -> StepCode {
    let context = Context::of_step(program, whole);
    let plans = context.plan();
    let stages = plans
        .iter()
        .map(|plan| StageFunction::new(&context, plan.clone(), &plan.stage.name));
    let step = StepFunctions {
        context: &context,
        stages: stages.collect(),
        rotor: context.handed_over(),
    };
    let (track, rest, control) = (step.track(), step.rest(), step.control(whole));
    StepCode {
        entries: quote!(#track #rest #control),
        rotor: step.rotor_type(),
        rotor_definition: step.rotor_definition(),
        stages: step.stages.iter().map(StageFunction::definition).collect(),
    }
}

struct StepFunctions<'a> {
    context: &'a Context<'a>,
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

    fn rotor_names(&self) -> Vec<Source> {
        let names = self.rotor.iter();
        names
            .map(|&value| snake(&self.function().node(value).name))
            .collect()
    }

    fn rotor_type(&self) -> Source {
        if self.has_rotor() {
            quote!(Rotor)
        } else {
            quote!(())
        }
    }

    fn rotor_definition(&self) -> Source {
        if !self.has_rotor() {
            return Source::new();
        }
        let names = self.rotor_names();
        let kinds = self
            .rotor
            .iter()
            .map(|&value| rust_type(self.context.shape(value)));
        quote! {
            /// Rotor angle and speed from tracking.
            #[derive(Clone, Copy)]
            pub struct Rotor { #(#names: #kinds),* }
        }
    }

    /// Reads of the sample's words among the values.
    fn inputs(&self, values: impl Iterator<Item = Value>) -> (Source, bool) {
        let names = inputs_used(self.function(), values);
        let is_read = !names.is_empty();
        let reads = names.into_iter().map(|name| {
            let (binding, method) = (snake(name), Source::of(name));
            quote!(let #binding = sample.#method();)
        });
        (reads.collect(), is_read)
    }

    /// Calls of a part's stages, and its new state words.
    fn body(&self, part: Part, kept: &Kept<'_>) -> Source {
        let calls = self.stages(part).map(StageFunction::call);
        let scope = |reads_state| Scope {
            context: self.context,
            reads_state,
        };
        let outside = scope(true);
        let reads = kept.reads.iter().map(|&value| {
            let name = snake(&self.function().node(value).name);
            let value = outside.whole(value);
            quote!(let #name = #value;)
        });
        let writes = kept.words.iter().map(|&(word, value)| {
            let field = snake(&word.name);
            let scope = scope(kept.is_moved(self.function(), value));
            let value = scope.kept(word, value);
            quote!(state.#field = #value;)
        });
        quote! { #(#calls)* #(#reads)* #(#writes)* }
    }

    fn kept(&self, part: Part) -> Kept<'a> {
        let plans: Vec<_> = self
            .stages
            .iter()
            .map(|stage| stage.plan().clone())
            .collect();
        kept(self.context, &plans, part)
    }

    fn reads_state(&self, part: Part) -> bool {
        let mut plans = self.stages(part).map(StageFunction::plan);
        plans.any(|plan| !plan.reads.is_empty() || !plan.stores.is_empty())
    }

    fn track(&self) -> Source {
        let kept = self.kept(Part::Tracking);
        let (inputs, has_inputs) = self.inputs(kept.used.iter().copied());
        let has_state =
            self.reads_state(Part::Tracking) || !kept.words.is_empty() || !kept.reads.is_empty();
        let body = self.body(Part::Tracking, &kept);
        let (state, sample) = (named("state", has_state), named("sample", has_inputs));
        let signature = quote!(#state: &mut State, #sample: &Checked);
        if !self.has_rotor() {
            return quote! {
                #[inline]
                fn track(#signature) { #inputs #body }
            };
        }
        let names = self.rotor_names();
        quote! {
            #[inline]
            fn track(#signature) -> Rotor {
                #inputs
                #body
                Rotor { #(#names),* }
            }
        }
    }

    fn rest(&self) -> Source {
        let kept = kept_at_rest(self.context);
        let tracked = kept.iter().filter_map(|&(_, at_rest)| match at_rest {
            AtRest::Tracked(value) => Some(value),
            AtRest::Forgotten => None,
        });
        let tracked: Vec<Value> = tracked.collect();
        let has_inputs = !inputs_used(self.function(), tracked.iter().copied()).is_empty();
        let handed = self.rotor.iter().filter(|value| tracked.contains(value));
        let handed: Vec<Source> = handed
            .map(|&value| snake(&self.function().node(value).name))
            .collect();
        let pattern = (!handed.is_empty()).then(|| quote!(let Rotor { #(#handed,)* .. } = rotor;));
        let scope = Scope {
            context: self.context,
            reads_state: false,
        };
        let stores = kept.iter().map(|&(word, at_rest)| {
            let field = snake(&word.name);
            let value = match at_rest {
                AtRest::Tracked(value) => match self.function().node(value).op {
                    Op::Input(n) => {
                        let method = Source::of(&*self.function().inputs[n as usize].name);
                        quote!(sample.#method())
                    }
                    _ => scope.kept(word, value),
                },
                AtRest::Forgotten if word.storage_bits == 16 => quote!(0),
                AtRest::Forgotten => quote!(Word(0)),
            };
            quote!(state.#field = #value;)
        });
        let state = named("state", !kept.is_empty());
        let sample = named("sample", has_inputs);
        let rotor = named("rotor", !handed.is_empty());
        let kind = self.rotor_type();
        quote! {
            fn rest(#state: &mut State, #sample: &Checked, #rotor: #kind) {
                #pattern
                #(#stores)*
            }
        }
    }

    fn control(&self, whole: Option<&WholeCommand<'_>>) -> Source {
        let kept = self.kept(Part::Control);
        let (inputs, has_inputs) = self.inputs(kept.used.iter().copied());
        let has_state =
            self.reads_state(Part::Control) || !kept.words.is_empty() || !kept.reads.is_empty();
        let body = self.body(Part::Control, &kept);
        let names = self.rotor_names();
        let pattern = self
            .has_rotor()
            .then(|| quote!(let Rotor { #(#names),* } = rotor;));
        let words = read_words(self.context.program, self.function());
        let set_point = named("set_point", !words.as_str().is_empty());
        let (state, sample) = (named("state", has_state), named("sample", has_inputs));
        let rotor = named("rotor", self.has_rotor());
        let kind = self.rotor_type();
        let command = command_type(self.context.program);
        let (observation, legs) = (self.observation(), self.legs(whole));
        let observed = named("observation", !observation.as_str().is_empty());
        quote! {
            #[inline]
            fn step(
                #state: &mut State,
                #set_point: &Words<Self>,
                #sample: &Checked,
                #rotor: #kind,
                #observed: &mut Observation,
            ) -> #command {
                #words
                #inputs
                #pattern
                #body
                #observation
                #legs
            }
        }
    }

    /// The observations.
    fn observation(&self) -> Source {
        let scope = Scope {
            context: self.context,
            reads_state: false,
        };
        let word = |told| self.function().told(told).map(|value| scope.whole(value));
        let emf = word(Told::Emf(Phase::A)).zip(word(Told::Emf(Phase::B)));
        let emf = emf.map(|(e_a, e_b)| quote!(observation.emf = Some([#e_a, #e_b]);));
        let speed = word(Told::Speed).map(|speed| quote!(observation.speed = Some(#speed);));
        quote!(#emf #speed)
    }

    fn legs(&self, whole: Option<&WholeCommand<'_>>) -> Source {
        // Old state words in the command are read before any is written.
        let scope = Scope {
            context: self.context,
            reads_state: false,
        };
        if let Some(whole) = whole {
            return look_up_command(whole, &scope.whole(whole.index));
        }
        let function = self.function();
        let half = |output: Output| {
            let Some(value) = function.output(output) else {
                return quote!(0);
            };
            scope.literal(value).map_or_else(
                || {
                    let value = scope.receiver(value);
                    quote!(#value.to_u16())
                },
                |literal| number(i64::from(literal)),
            )
        };
        if self.context.program.has_intervals() {
            let ends = [0, 1].map(|interval| half(Output::End(interval)));
            let states = [0, 1, 2].map(|interval| half(Output::States(interval)));
            return quote!(Intervals::of_states([#(#ends),*], [#(#states),*]));
        }
        let compare = Phase::ALL.map(|phase| half(Output::Compare(phase)));
        let states = Phase::ALL.map(|phase| {
            let state = function.output(Output::Leg(phase));
            state.map_or_else(
                || quote!(LegState::Off),
                |value| scope.shaped(value, Shape::Leg),
            )
        });
        let states = array(&states);
        quote!(Legs::new([#(#compare),*], #states))
    }
}

/// Type of the step's command.
pub(super) fn command_type(program: &Program) -> Source {
    if program.has_intervals() {
        quote!(Intervals)
    } else {
        quote!(Legs)
    }
}

/// A parameter, with an underscore prefix if it is not used.
fn named(name: &str, is_used: bool) -> Source {
    Source::of(if is_used {
        name.to_owned()
    } else {
        format!("_{name}")
    })
}

/// The statements that read the set-point words of a function; an underscore for an unused one.
fn read_words(program: &Program, function: &Function) -> Source {
    let read = demands_read(program, function);
    let is_read = |demand: Demand| read.contains(&demand);
    let fresh = (Demand::BusIsFresh, "bus_is_fresh");
    let single = SINGLE.into_iter().chain([fresh]);
    let single = single.filter(|&(demand, _)| is_read(demand));
    let single = single.filter_map(|(demand, method)| {
        let (name, method) = (snake(&program.param(demand)?.name), Source::of(method));
        Some(quote!(let #name = set_point.#method();))
    });
    let bus = Demand::OF_BUS;
    let reads_bus = bus.into_iter().any(is_read).then(|| {
        let names = bus.into_iter().filter_map(|demand| {
            let word = program.param(demand)?;
            Some(if is_read(demand) {
                snake(&word.name)
            } else {
                quote!(_)
            })
        });
        quote!(let [#(#names),*] = set_point.bus();)
    });
    quote!(#(#single)* #reads_bus)
}

/// A setter: a function from a number to set-point words.
pub(super) struct SetterCode {
    /// The function.
    pub function: Source,
    /// Its stages, if they are functions of their own.
    pub stages: Source,
}

/// The setter as `fn name(word) -> words`.
pub(super) fn emit_setter(program: &Program, set: Setter, function: &Function) -> SetterCode {
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
    let scope = Scope {
        context: &context,
        reads_state: true,
    };
    let written = writes(function);
    let mut values: Vec<Source> = written.iter().map(|&value| scope.whole(value)).collect();
    let body: Source = if single {
        let mut statements: Vec<Source> =
            stages.iter().flat_map(StageFunction::statements).collect();
        // The last value is not bound to its name first.
        let last = function.values().last();
        if let ([only], [value]) = (written.as_slice(), values.as_mut_slice())
            && last == Some(*only)
        {
            statements.pop();
            *value = scope.bound(*only);
        }
        statements.into_iter().collect()
    } else {
        stages.iter().map(StageFunction::call).collect()
    };
    let (kind, result) = match (set, values.as_slice()) {
        (Setter::Current | Setter::Torque | Setter::Speed, [only]) => (quote!(Word), only.clone()),
        (_, words) => {
            let count = words.len();
            (quote!([Word; #count]), quote!([#(#words),*]))
        }
    };
    let inputs = function.inputs.iter().map(|input| {
        let is_used = params_used(function, &input.name);
        named(&snake(&input.name).to_string(), is_used)
    });
    let (name, doc) = (snake(word_function(set)), docs(&function.doc));
    SetterCode {
        function: quote! {
            #doc
            fn #name(#(#inputs: Word),*) -> #kind {
                #body
                #result
            }
        },
        stages: if single {
            Source::new()
        } else {
            stages.iter().map(StageFunction::definition).collect()
        },
    }
}

/// The runtime's name of the setter.
fn word_function(set: Setter) -> &'static str {
    match set {
        Setter::Current => "current",
        Setter::Torque => "torque",
        Setter::Speed => "speed",
        Setter::Bus => "bus",
    }
}

fn params_used(function: &Function, name: &str) -> bool {
    let all = inputs_used(function, function.values());
    all.contains(&name)
}
