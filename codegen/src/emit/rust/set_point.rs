//! The emitted set-point: the half of a drive that the main program writes.

use super::super::set_point::{Shared, shared};
use super::function::Setter;
use super::interface::Types;
use super::names::{doc, docs, snake};
use crate::diagnostics::list;
use crate::ir::{Program, Word};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

impl Types<'_> {
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
        }
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
