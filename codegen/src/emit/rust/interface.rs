//! The emitted types: the drive, its two halves, its state, and the trait that all drives share.

use super::super::set_point::{Shared, shared};
use super::expression::initial;
use super::function::{Setter, state_word};
use super::imports::PLACEHOLDER;
use super::names::{doc, docs, number, raw_text, screaming, snake, storage_type, stored};
use crate::diagnostics::list;
use crate::interface::{Interface, PublicConstant, PublicValue, Rounding};
use crate::ir::{Input, Program, Word};
use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};

/// What the types are emitted from.
pub(super) struct Types<'a> {
    pub program: &'a Program,
    pub interface: &'a Interface,
    /// The type's name, with the span that the user gave it.
    pub name: &'a Ident,
}

impl Types<'_> {
    /// The drive: set-point and state together.
    pub(super) fn drive(&self, attributes: &TokenStream, setters: &[Setter]) -> TokenStream {
        let name = format_ident!("{PLACEHOLDER}");
        let setters = setters.iter().map(|setter| &setter.delegate);
        let commands = commands();
        let docs = docs(&self.interface.doc);
        let constants = self.interface.constants.iter().map(public_constant);
        let measurements = self.measurements();
        let arguments = measurements
            .iter()
            .map(|(name, kind, _)| quote!(#name: #kind));
        let names = measurements.iter().map(|(name, _, _)| name);
        let shared = shared(self.program);
        let initial = shared.iter().map(|shared| {
            let name = snake(&shared.name);
            let words = shared.words.iter().map(|(_, word)| {
                let initial = number(i64::from(word.initial));
                quote!(Word(#initial))
            });
            match shared.words.len() {
                1 => quote!(#name: SharedWord::new(#(#words)*)),
                _ => quote!(#name: DoubleBuffer::new([#(#words),*])),
            }
        });
        quote! {
            #docs
            #attributes
            #[derive(Debug)]
            pub struct #name {
                set_point: SetPoint,
                state: State,
            }

            impl #name {
                #(#constants)*
            }

            impl #name {
                /// A drive at rest: zero set-point, initial state.
                #[must_use]
                pub const fn new() -> Self {
                    Self {
                        set_point: SetPoint { #(#initial),* },
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
        }
    }

    /// The half that the main program writes.
    pub(super) fn set_point(&self, setters: &[Setter]) -> TokenStream {
        let methods = setters.iter().map(|setter| &setter.method);
        let shared = shared(self.program);
        let docs = docs(&set_point_docs(self.program, &shared));
        let fields = shared.iter().map(|shared| {
            let field = snake(&shared.name);
            let meaning = |word: &Word| format!("{} In `{}`.", word.doc, word.interval);
            if let [(_, only)] = shared.words.as_slice() {
                let doc = doc(&meaning(only));
                return quote!(#doc #field: SharedWord);
            }
            let lines = shared.words.iter().enumerate().map(|(index, (_, word))| {
                doc(&format!("{index}. `{}`: {}", word.name, meaning(word)))
            });
            let count = Literal::usize_unsuffixed(shared.words.len());
            quote!(#(#lines)* #field: DoubleBuffer<#count>)
        });
        let count = Literal::usize_unsuffixed(self.program.params.len());
        let reads = shared.iter().filter(|shared| shared.words.len() > 1);
        let reads = reads.map(|shared| {
            let field = snake(&shared.name);
            let names = shared.words.iter().map(|(_, word)| snake(&word.name));
            quote!(let [#(#names),*] = self.#field.read();)
        });
        let words = self.program.params.iter().enumerate().map(|(index, word)| {
            let name = snake(&word.name);
            let single = |shared: &&Shared<'_>| matches!(shared.words.as_slice(), [(only, _)] if *only == index);
            if shared.iter().any(|shared| single(&shared)) {
                quote!(self.#name.load())
            } else {
                quote!(#name)
            }
        });
        quote! {
            #docs
            #[derive(Debug)]
            pub struct SetPoint {
                #(#fields),*
            }

            impl SetPoint {
                #(#methods)*

                /// All words, as the control loop takes them.
                #[inline]
                fn words(&self) -> [Word; #count] {
                    #(#reads)*
                    [#(#words),*]
                }
            }
        }
    }

    /// The half that the control interrupt owns.
    pub(super) fn control_loop(&self) -> TokenStream {
        let measurements = self.measurements();
        let arguments = measurements.iter().map(|(name, kind, input)| {
            let unused = format_ident!("_{name}");
            let name = if input.is_some() { name } else { &unused };
            quote!(#name: #kind)
        });
        let words = self.program.step.inputs.iter().map(|input| {
            let name = snake(&input.name);
            quote!(#name.into())
        });
        let step_docs = self.step_docs();
        let commands = commands();
        quote! {
            /// The half of the drive that the control interrupt owns.
            #[derive(Debug)]
            pub struct ControlLoop<'drive> {
                set_point: &'drive SetPoint,
                state: &'drive mut State,
            }

            impl ControlLoop<'_> {
                #step_docs
                #[inline]
                pub fn step(&mut self, #(#arguments),*) -> Legs {
                    step(self.state, self.set_point.words(), #(#words),*)
                }

                #commands
            }
        }
    }

    /// The words that outlive a control period.
    pub(super) fn state(&self) -> TokenStream {
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
            .map(snake);
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
        let set_mode = |mode: &TokenStream| self.assign("mode", mode);
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

            /// What outlives a control period.
            #[derive(Debug)]
            struct State {
                #(#fields),*
            }

            impl State {
                const INITIAL: Self = Self { #(#initial),* };

                fn reset(&mut self) {
                    if self.mode() == mode::RUN || self.mode() == mode::TRIPPED {
                        *self = Self { #(#kept: self.#kept,)* ..Self::INITIAL };
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

                fn fault(&self) -> Fault {
                    Fault::from_word(#fault)
                }

                fn is_running(&self) -> bool {
                    self.mode() == mode::RUN
                }
            }
        }
    }

    /// The trait that all drives share.
    pub(super) fn drive_trait(&self) -> TokenStream {
        let name = format_ident!("{PLACEHOLDER}");
        let name_text = self.name.to_string();
        let spec = raw_text(&self.interface.spec_toml);
        let formats = self.interface.formats.iter().map(|entry| {
            let name = &entry.name;
            let storage_bits = number(i64::from(entry.storage_bits));
            let frac_bits = number(i64::from(entry.frac_bits));
            let rounding = match entry.rounding {
                Rounding::Floor => quote!(Rounding::Floor),
                Rounding::RoundHalfUp => quote!(Rounding::RoundHalfUp),
            };
            let segments = entry.segments.map(|segments| {
                let segments = number(i64::from(segments));
                quote!(.over(#segments))
            });
            quote!(Format::new(#name, #storage_bits, #frac_bits, #rounding)#segments)
        });
        let words = &self.program.states;
        let state_names = words.iter().map(|word| &word.name);
        let reads = words.iter().enumerate().map(|(index, word)| {
            let index = Literal::usize_unsuffixed(index);
            let field = snake(&word.name);
            let value = if word.storage_bits == 16 {
                quote!(i32::from(self.state.#field))
            } else {
                quote!(self.state.#field.0)
            };
            quote!(#index => #value)
        });
        let writes = words.iter().enumerate().map(|(index, word)| {
            let index = Literal::usize_unsuffixed(index);
            let field = snake(&word.name);
            let value = stored(word, &quote!(Word(value)));
            quote!(#index => self.state.#field = #value)
        });
        let measurements = self.measurements();
        let sample = measurements.iter().map(|(name, _, _)| quote!(sample.#name));
        let set_bus = if self.interface.measured_bus {
            quote! {
                fn set_bus(&self, counts: u16) {
                    self.set_point.set_bus(counts);
                }
            }
        } else {
            quote!(
                fn set_bus(&self, _counts: u16) {}
            )
        };
        quote! {
            impl Drive for #name {
                const NAME: &'static str = #name_text;
                const SPEC: &'static str = #spec;
                const FORMATS: &'static [Format] = &[#(#formats),*];
                const STATE_NAMES: &'static [&'static str] = &[#(#state_names),*];

                fn new() -> Self {
                    Self::new()
                }

                #[inline]
                fn step(&mut self, sample: &Sample) -> Legs {
                    self.step(#(#sample),*)
                }

                fn set_current(&self, current: I16F16) {
                    self.set_current(current);
                }

                fn set_torque(&self, torque: I16F16) {
                    self.set_torque(torque);
                }

                #set_bus

                fn reset(&mut self) {
                    self.reset();
                }

                fn calibrate(&mut self) {
                    self.calibrate();
                }

                fn precharge(&mut self) {
                    self.precharge();
                }

                fn fault(&self) -> Fault {
                    self.fault()
                }

                fn is_running(&self) -> bool {
                    self.is_running()
                }

                fn state_word(&self, index: usize) -> i32 {
                    match index {
                        #(#reads,)*
                        _ => 0,
                    }
                }

                fn set_state_word(&mut self, index: usize, value: i32) {
                    match index {
                        #(#writes,)*
                        _ => {}
                    }
                }
            }
        }
    }

    fn word(&self, name: &str) -> Option<&Word> {
        self.program.states.iter().find(|word| word.name == name)
    }

    /// A constant of the methods: its definition, unless the program has it already, and its use.
    fn own_constant(&self, name: &str, value: i32, line: &str) -> (TokenStream, TokenStream) {
        let ident = screaming(name);
        let raw = number(i64::from(value));
        let known = self
            .program
            .constants
            .iter()
            .find(|known| known.name == name);
        match known.map(|known| known.raw == value) {
            None => {
                let doc = doc(line);
                (
                    quote!(#doc const #ident: Word = Word(#raw);),
                    quote!(#ident),
                )
            }
            Some(true) => (TokenStream::new(), quote!(#ident)),
            Some(false) => (TokenStream::new(), quote!(Word(#raw))),
        }
    }

    fn assign(&self, name: &str, value: &TokenStream) -> TokenStream {
        self.word(name).map_or_else(TokenStream::new, |word| {
            let field = snake(name);
            let value = stored(word, value);
            quote!(self.#field = #value;)
        })
    }

    /// What the public `step` takes: name, hardware type, and the step's input of that name. The
    /// hardware's side follows the specification: a captured time comes in even where this
    /// controller makes no use of it.
    fn measurements(&self) -> Vec<(Ident, TokenStream, Option<&Input>)> {
        let inputs = &self.program.step.inputs;
        let input = |name: &str| inputs.iter().find(|input| input.name == name);
        let mut list = vec![
            ("adc_a", quote!(u16)),
            ("adc_b", quote!(u16)),
            ("hall", quote!(u8)),
        ];
        if self.interface.timer_capture {
            list.push(("hall_ticks", quote!(u16)));
        }
        list.into_iter()
            .map(|(name, kind)| (snake(name), kind, input(name)))
            .collect()
    }

    fn step_docs(&self) -> TokenStream {
        let effect = match self.interface.delay {
            0 => "The command takes effect at once, in the period that the measurements begin.",
            _ => {
                "The command takes effect with the next period, while its own step computes the one after."
            }
        };
        let mut lines = vec![
            "Runs one control period: takes the measurements of its start, returns the inverter's command.".to_owned(),
            String::new(),
            effect.to_owned(),
            String::new(),
        ];
        lines.extend(
            self.measurements()
                .iter()
                .map(|(name, _, input)| match input {
                    Some(input) => format!("- `{name}`: {}", input.doc),
                    None => format!("- `{name}`: not used by this controller."),
                }),
        );
        docs(&lines)
    }
}

/// Who may call which setter from where.
fn set_point_docs(program: &Program, shared: &[Shared<'_>]) -> Vec<String> {
    let mut lines = vec![
        "What other code tells the control loop, which may interrupt it at any place. All on one core.".to_owned(),
        String::new(),
    ];
    let names = |single: bool| {
        let setters = program.setters.iter().filter(|setter| {
            if setter.next_params.is_empty() {
                return false;
            }
            let mut written = setter.next_params.iter().map(|(param, _)| param.index());
            written.all(|param| {
                let mut groups = shared.iter();
                groups.any(|shared| {
                    (shared.words.len() == 1) == single
                        && shared.words.iter().any(|&(word, _)| word == param)
                })
            })
        });
        let names: Vec<&str> = setters.map(|setter| setter.name.as_str()).collect();
        (!names.is_empty()).then(|| list(&names, "and"))
    };
    if let Some(names) = names(true) {
        lines.push(format!(
            "From anywhere, interrupts included: {names}; the last call wins, and none disturbs another setter."
        ));
    }
    if let Some(names) = names(false) {
        lines.extend([
            String::new(),
            format!("{names} replaces several words as one. A call that interrupts another call of it has no effect. From an"),
            "interrupt that can interrupt the control loop: at most once per control period.".to_owned(),
        ]);
    }
    lines
}

/// What both the drive and its control loop let their owner do, besides stepping.
fn commands() -> TokenStream {
    quote! {
        /// Clears a trip and all control state; keeps calibrated offsets and the set-point.
        pub fn reset(&mut self) {
            self.state.reset();
        }

        /// Starts current-offset calibration: all legs off, the motor at rest. Ignored
        /// when tripped.
        pub fn calibrate(&mut self) {
            self.state.calibrate();
        }

        /// Starts bootstrap pre-charge: all lower switches on. Ignored when tripped, and where
        /// the specification has no pre-charge.
        pub fn precharge(&mut self) {
            self.state.precharge();
        }

        /// What tripped the drive, or [`Fault::None`].
        #[must_use]
        pub fn fault(&self) -> Fault {
            self.state.fault()
        }

        /// Whether currents are controlled: neither calibrating, pre-charging nor tripped.
        #[must_use]
        pub fn is_running(&self) -> bool {
            self.state.is_running()
        }
    }
}

fn public_constant(constant: &PublicConstant) -> TokenStream {
    let name = screaming(&constant.name);
    let doc = docs(&constant.doc);
    let (kind, value) = match &constant.value {
        PublicValue::Integer { rust_type, value } => {
            let kind = Ident::new(rust_type, Span::call_site());
            (quote!(#kind), number(*value))
        }
        PublicValue::Fixed { bits, frac_bits } => {
            let kind = fixed_type(*frac_bits);
            let bits = number(i64::from(*bits));
            (quote!(#kind), quote!(#kind::from_bits(#bits)))
        }
        PublicValue::Vectors { bits, frac_bits } => {
            let kind = fixed_type(*frac_bits);
            let count = Literal::usize_unsuffixed(bits.len());
            let vectors = bits.iter().map(|vector| {
                let [alpha, beta] = vector.map(|bits| number(i64::from(bits)));
                quote!([#kind::from_bits(#alpha), #kind::from_bits(#beta)])
            });
            (quote!([[#kind; 2]; #count]), quote!([#(#vectors),*]))
        }
        PublicValue::Integers { rust_type, values } => {
            let kind = Ident::new(rust_type, Span::call_site());
            let count = Literal::usize_unsuffixed(values.len());
            let values = values.iter().map(|&value| number(value));
            (quote!([#kind; #count]), quote!([#(#values),*]))
        }
        PublicValue::Text(text) => (quote!(&'static str), quote!(#text)),
    };
    quote!(#doc pub const #name: #kind = #value;)
}

/// The `fixed` type of 32 bits with so many fraction bits.
pub(super) fn fixed_type(frac_bits: u32) -> Ident {
    let integer_bits = 32_u32.saturating_sub(frac_bits);
    Ident::new(&format!("I{integer_bits}F{frac_bits}"), Span::call_site())
}
