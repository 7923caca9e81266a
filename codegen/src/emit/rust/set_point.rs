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
        quote! {
            #docs
            pub struct SetPoint {
                #(#fields,)*
                /// What the control loop last said of mode and fault; see [`Status::word`].
                status: SharedWord,
            }

            impl SetPoint {
                #(#methods)*

                /// What the drive is doing and what tripped it, as of the last control period: from
                /// anywhere, while the control loop goes on.
                #[must_use]
                pub fn status(&self) -> Status {
                    Status::from_word(self.status.load())
                }

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
}
