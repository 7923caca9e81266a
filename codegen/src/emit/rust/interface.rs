//! The emitted types: the drive, its control loop and its state.

use super::super::set_point::shared;
use super::super::texts;
use super::expression::initial;
use super::function::{Setter, state_word};
use super::imports::unsettled;
use super::names::{doc, docs, number, screaming, snake, storage_type, stored};
use super::source::{Source, quote};
use crate::interface::{Interface, PublicConstant, PublicValue};
use crate::ir::{Input, Program, Word};

/// What the types are emitted from.
pub(super) struct Types<'a> {
    pub program: &'a Program,
    pub interface: &'a Interface,
    /// The type's name.
    pub name: &'a str,
}

impl Types<'_> {
    /// The drive, set-point and state together, from the fields of its structure on.
    pub(super) fn drive(&self, setters: &[Setter]) -> Source {
        let name = unsettled(self.name);
        let setters = setters.iter().map(|setter| &setter.delegate);
        let commands = self.commands(&quote!(self.split().1.publish();));
        let constants = self.interface.constants.iter().map(public_constant);
        let measurements = self.measurements();
        let arguments = measurements
            .iter()
            .map(|(name, kind, _)| quote!(#name: #kind));
        let names = measurements.iter().map(|(name, _, _)| name);
        let debug = debug(&quote!(#name), self.name);
        let shared = shared(self.program);
        let initial = shared.iter().map(|shared| {
            let name = snake(&shared.name);
            let words = shared.words.iter().map(|(_, word)| {
                let initial = number(i64::from(word.initial));
                quote!(Word(#initial))
            });
            if shared.words.len() == 1 {
                quote!(#name: SharedWord::new(#(#words)*))
            } else {
                quote!(#name: DoubleBuffer::new([#(#words),*]))
            }
        });
        let bus_periods = self.interface.bus_periods;
        let watch = bus_periods.map(|_| quote!(bus_watch: BusWatch::new(),));
        quote! {
            {
                set_point: SetPoint,
                state: State,
            }

            impl #name {
                #(#constants)*
            }

            impl #name {
                /// A drive that controls currents from its first step on, with set-point 0 and nominal current offsets. Where
                /// offsets or bootstrap capacitors need it, call [`calibrate`](Self::calibrate) before the first step.
                #[must_use]
                pub const fn new() -> Self {
                    Self {
                        set_point: SetPoint { #(#initial,)* #watch status: SharedWord::new(Word(0)) },
                        state: State::INITIAL,
                    }
                }

                /// The two halves: an interrupt owns the control loop, the main program the
                /// set-point.
                pub fn split(&mut self) -> (&SetPoint, ControlLoop<'_>) {
                    (&self.set_point, ControlLoop { set_point: &self.set_point, state: &mut self.state })
                }

                /// The set-point, for the main program.
                #[must_use]
                pub fn set_point(&self) -> &SetPoint {
                    &self.set_point
                }

                /// Runs one control period; see [`ControlLoop::step`].
                #[inline]
                pub fn step(&mut self, #(#arguments),*) -> Legs {
                    self.split().1.step(#(#names),*)
                }

                #(#setters)*
                #commands
            }

            impl Default for #name {
                fn default() -> Self {
                    Self::new()
                }
            }

            #debug
        }
    }

    /// The half that the control interrupt owns.
    pub(super) fn control_loop(&self) -> Source {
        let measurements = self.measurements();
        let arguments = measurements.iter().map(|(name, kind, input)| {
            let unused = Source::of(format!("_{name}"));
            let name = if input.is_some() { name } else { &unused };
            quote!(#name: #kind)
        });
        let words = self.program.step.inputs.iter().map(|input| {
            let name = snake(&input.name);
            quote!(#name.into())
        });
        let step_docs = self.step_docs();
        let commands = self.commands(&quote!(self.publish();));
        let debug = debug(&quote!(ControlLoop<'_>), "ControlLoop");
        let bus_periods = self.interface.bus_periods;
        let pass_period = bus_periods.map(|_| quote!(self.set_point.pass_period();));
        quote! {
            /// The half of the drive that the control interrupt owns.
            pub struct ControlLoop<'drive> {
                set_point: &'drive SetPoint,
                state: &'drive mut State,
            }

            impl ControlLoop<'_> {
                #step_docs
                #[inline]
                pub fn step(&mut self, #(#arguments),*) -> Legs {
                    #pass_period
                    step(self.state, self.set_point, #(#words),*)
                }

                #commands

                /// Says what the drive is doing to those who hold the set-point.
                fn publish(&self) {
                    self.set_point.status.store(self.state.status());
                }
            }

            #debug
        }
    }

    /// The words that outlive a control period.
    pub(super) fn state(&self) -> Source {
        let words = &self.program.states;
        let fields = words.iter().map(|word| {
            let (name, kind) = (snake(&word.name), storage_type(word));
            let doc = doc(&format!("{} In `{}`.", word.doc, word.interval));
            quote!(#doc #name: #kind)
        });
        let initial = words.iter().map(|word| {
            let name = snake(&word.name);
            let value = initial(word, word.initial);
            quote!(#name: #value)
        });
        let kept = ["offset_a", "offset_b"]
            .into_iter()
            .filter(|name| self.word(name).is_some())
            .map(|name| {
                let name = snake(name);
                quote!(#name: self.#name)
            });
        let mode = self.word("mode").map_or(quote!(mode::RUN), state_word);
        let fault = self.word("fault").map_or(quote!(Word(0)), state_word);
        let (samples_definition, samples) = self.own_constant(
            "calibration_samples",
            self.interface.calibration_samples,
            "Samples of the current-offset calibration.",
        );
        let (periods_definition, periods) = self.own_constant(
            "precharge_periods",
            self.interface.precharge_periods,
            "Control periods of bootstrap pre-charge.",
        );
        let bus_definition = self.bus_periods().map(|(definition, _)| definition);
        let set_mode = |mode: &Source| self.assign("mode", mode);
        let calibrate = [
            set_mode(&quote!(mode::CALIBRATE)),
            self.assign("countdown", &samples),
            self.assign("sum_a", &quote!(Word(0))),
            self.assign("sum_b", &quote!(Word(0))),
        ];
        let precharge = [
            set_mode(&quote!(mode::PRECHARGE)),
            self.assign("countdown", &periods),
        ];
        quote! {
            #samples_definition
            #periods_definition
            #bus_definition

            /// What outlives a control period.
            struct State {
                #(#fields),*
            }

            impl State {
                const INITIAL: Self = Self { #(#initial),* };

                fn reset(&mut self) {
                    if self.mode() == mode::RUN || self.mode() == mode::TRIPPED {
                        *self = Self { #(#kept,)* ..Self::INITIAL };
                    }
                }

                fn calibrate(&mut self) {
                    if self.mode() != mode::TRIPPED {
                        #(#calibrate)*
                    }
                }

                fn precharge(&mut self) {
                    let may_start = self.mode() == mode::RUN || self.mode() == mode::PRECHARGE;
                    if may_start && #periods != 0 {
                        #(#precharge)*
                    }
                }

                fn mode(&self) -> Word {
                    #mode
                }

                fn status(&self) -> Word {
                    Status::word(self.mode(), #fault)
                }
            }
        }
    }

    fn word(&self, name: &str) -> Option<&Word> {
        self.program.states.iter().find(|word| word.name == name)
    }

    /// A constant of the methods: its definition, unless the program has it already or names none, and its use.
    pub(super) fn own_constant(&self, name: &str, value: i32, line: &str) -> (Source, Source) {
        let ident = screaming(name);
        let raw = number(i64::from(value));
        let constants = &self.program.constants;
        if constants.iter().any(|constant| constant.name.is_empty()) {
            return (Source::new(), quote!(Word(#raw)));
        }
        let known = constants.iter().find(|known| known.name == name);
        match known.map(|known| known.raw == value) {
            None => {
                let doc = doc(line);
                (
                    quote!(#doc const #ident: Word = Word(#raw);),
                    quote!(#ident),
                )
            }
            Some(true) => (Source::new(), quote!(#ident)),
            Some(false) => (Source::new(), quote!(Word(#raw))),
        }
    }

    fn assign(&self, name: &str, value: &Source) -> Source {
        self.word(name).map_or_else(Source::new, |word| {
            let field = snake(name);
            let value = stored(word, value);
            quote!(self.#field = #value;)
        })
    }

    /// What the public `step` takes: name, hardware type, and the step's input of that name.
    pub(super) fn measurements(&self) -> Vec<(Source, Source, Option<&Input>)> {
        let measurements = texts::measurements(self.program, self.interface);
        let typed = measurements.into_iter().map(|(name, input)| {
            let kind = if name == "hall" {
                quote!(u8)
            } else {
                quote!(u16)
            };
            (snake(name), kind, input)
        });
        typed.collect()
    }

    /// What both the drive and its control loop let their owner do, besides stepping. `publish` says what
    /// the drive is doing.
    fn commands(&self, publish: &Source) -> Source {
        let calibrate = doc(&texts::calibrate(self.interface));
        let precharge = doc(&texts::precharge(self.interface));
        let status = self.status(
            &quote!(self.state.status()),
            &quote!(self.set_point.bus_watch),
        );
        quote! {
            /// Clears a trip and all control state; keeps calibrated offsets and the set-point, at which the next step
            /// goes on. Ignored while calibrating and pre-charging.
            pub fn reset(&mut self) {
                self.state.reset();
                #publish
            }

            #calibrate
            pub fn calibrate(&mut self) {
                self.state.calibrate();
                #publish
            }

            #precharge
            pub fn precharge(&mut self) {
                self.state.precharge();
                #publish
            }

            /// What the drive is doing, and what tripped it.
            #[must_use]
            pub fn status(&self) -> Status {
                #status
            }

            /// What tripped the drive, or [`Fault::None`].
            #[must_use]
            pub fn fault(&self) -> Fault {
                self.status().fault
            }

            /// Whether currents are controlled: neither calibrating, pre-charging nor tripped.
            #[must_use]
            pub fn is_running(&self) -> bool {
                self.status().is_running()
            }
        }
    }

    fn step_docs(&self) -> Source {
        let measurements = texts::measurements(self.program, self.interface);
        docs(&texts::step(self.interface, &measurements))
    }
}

/// What `{:?}` shows of a type that has a status. (Derived ones would show every state word, and cost the compiler as
/// much as the step.)
pub(super) fn debug(name: &Source, text: &str) -> Source {
    quote! {
        impl ::core::fmt::Debug for #name {
            fn fmt(&self, f: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                self.status().debug(#text, f)
            }
        }
    }
}

fn public_constant(constant: &PublicConstant) -> Source {
    let name = screaming(&constant.name);
    let doc = docs(&constant.doc);
    let (kind, value) = match &constant.value {
        PublicValue::Integer { rust_type, value } => {
            let kind = Source::of(*rust_type);
            (quote!(#kind), number(*value))
        }
        PublicValue::Fixed { bits, frac_bits } => {
            let kind = fixed_type(*frac_bits);
            let bits = number(i64::from(*bits));
            (quote!(#kind), quote!(#kind::from_bits(#bits)))
        }
        PublicValue::Vectors { bits, frac_bits } => {
            let kind = fixed_type(*frac_bits);
            let count = bits.len();
            let vectors = bits.iter().map(|vector| {
                let [alpha, beta] = vector.map(|bits| number(i64::from(bits)));
                quote!([#alpha, #beta])
            });
            (
                quote!([[#kind; 2]; #count]),
                quote!(pairs_from_bits([#(#vectors),*])),
            )
        }
        PublicValue::Integers { rust_type, values } => {
            let kind = Source::of(*rust_type);
            let count = values.len();
            let values = values.iter().map(|&value| number(value));
            (quote!([#kind; #count]), quote!([#(#values),*]))
        }
        PublicValue::Text(text) => (quote!(&'static str), quote!(#text)),
    };
    quote!(#doc pub const #name: #kind = #value;)
}

/// The `fixed` type of 32 bits with so many fraction bits.
pub(super) fn fixed_type(frac_bits: u32) -> Source {
    let integer_bits = 32_u32.saturating_sub(frac_bits);
    Source::of(format!("I{integer_bits}F{frac_bits}"))
}
