//! The emitted set-point: the half of a drive that the main program writes.

use super::super::set_point::{Shared, shared};
use super::super::texts;
use super::function::Setter;
use super::interface::{Types, debug};
use super::names::{doc, docs, snake};
use super::source::{Source, quote};
use crate::ir::Word;

impl Types<'_> {
    /// The half that the main program writes.
    pub(super) fn set_point(&self, setters: &[Setter]) -> Source {
        let methods = setters.iter().map(|setter| &setter.method);
        let shared = shared(self.program);
        let docs = docs(&texts::set_point(self.program, &shared));
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
            let count = shared.words.len();
            quote!(#(#lines)* #field: DoubleBuffer<#count>)
        });
        let count = self.program.params.len();
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
        let debug = debug(&quote!(SetPoint), "SetPoint");
        let watch = self.interface.bus_periods.map(|_| {
            quote! {
                /// Whether `set_bus` goes on being called.
                bus_watch: BusWatch,
            }
        });
        let status = self.status(&quote!(self.status.load()), &quote!(self.bus_watch));
        let pass_period = self.pass_period(&shared);
        quote! {
            #docs
            pub struct SetPoint {
                #(#fields,)*
                #watch
                /// What the control loop last said of mode and fault; see [`Status::word`].
                status: SharedWord,
            }

            impl SetPoint {
                #(#methods)*

                /// What the drive is doing and what tripped it, as of the last control period: from
                /// anywhere, while the control loop goes on.
                #[must_use]
                pub fn status(&self) -> Status {
                    #status
                }

                #pass_period

                /// All words, as the control loop takes them.
                #[inline]
                fn words(&self) -> [Word; #count] {
                    #(#reads)*
                    [#(#words),*]
                }
            }

            #debug
        }
    }

    /// The status of a word and, where the bus voltage is told, of the watch over that.
    pub(super) fn status(&self, word: &Source, watch: &Source) -> Source {
        match self.interface.bus_periods {
            None => quote!(Status::from_word(#word)),
            Some(_) => {
                quote!(Status { bus_is_stale: #watch.is_stale(), ..Status::from_word(#word) })
            }
        }
    }

    /// Where the bus voltage is told, the method that lets it grow older.
    fn pass_period(&self, shared: &[Shared<'_>]) -> Option<Source> {
        let periods = self.bus_periods()?.1;
        let buffers = shared.iter().filter(|shared| shared.words.len() > 1);
        let buffers = buffers.map(|shared| {
            let field = snake(&shared.name);
            quote!(self.#field.pass_period();)
        });
        Some(quote! {
            /// A control period begins: the bus voltage is that much older.
            #[inline]
            fn pass_period(&self) {
                #(#buffers)*
                self.bus_watch.pass_period(#periods);
            }
        })
    }

    /// Periods after which the bus voltage is stale: the definition of a constant, and its use.
    pub(super) fn bus_periods(&self) -> Option<(Source, Source)> {
        let periods = self.interface.bus_periods?;
        let doc = "Control periods after which a bus voltage that was told is stale.";
        Some(self.own_constant("bus_periods", periods, doc))
    }
}
