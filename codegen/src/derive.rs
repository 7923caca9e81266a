//! `#[derive(hexagen::State)]`: a law's state as a list of words.
//!
//! Fields are `Word`s or `u16`s. The initial value is 0, or the number of `#[initial(…)]`.

use proc_macro2::{Delimiter, Ident, TokenStream, TokenTree};
use quote::{quote, quote_spanned};

/// A field of the structure.
struct Field {
    name: Ident,
    is_half: bool,
    initial: TokenStream,
}

/// Implements `hexagen::State` for a structure with named fields.
pub fn derive_state(item: TokenStream) -> TokenStream {
    let Some((name, fields)) = structure(item) else {
        return quote!(::core::compile_error!(
            "`State` is derived for a structure whose fields are `Word` or `u16`"
        ););
    };
    let initial = fields.iter().map(|field| {
        let Field { name, initial, .. } = field;
        if field.is_half {
            quote!(#name: #initial)
        } else {
            quote!(#name: ::hexagen::arith::Word(#initial))
        }
    });
    let names = fields.iter().map(|field| field.name.to_string());
    let reads = fields.iter().map(|Field { name, is_half, .. }| {
        if *is_half {
            quote!(self.#name as i32)
        } else {
            quote!(self.#name.0)
        }
    });
    let reads: Vec<TokenStream> = reads.collect();
    let writes = fields.iter().enumerate().map(|(index, field)| {
        let name = &field.name;
        if field.is_half {
            quote!(#index => self.#name = value as u16,)
        } else {
            quote!(#index => self.#name = ::hexagen::arith::Word(value),)
        }
    });
    let count = fields.len();
    let own_names: Vec<&Ident> = fields.iter().map(|field| &field.name).collect();
    let own = quote_spanned!(name.span() => #name);
    quote! {
        #[automatically_derived]
        impl ::hexagen::State for #own {
            const INITIAL: Self = Self { #(#initial),* };
            const NAMES: &'static [&'static str] = &[#(#names),*];

            #[inline]
            fn words(&self, words: &mut [i32]) {
                if let ::core::option::Option::Some(words) = words.first_chunk_mut() {
                    *words = [#(#reads),*];
                }
            }

            type Kept = [::core::sync::atomic::AtomicI32; #count];

            fn keep(&self, kept: &Self::Kept) {
                let [#(#own_names),*] = kept;
                #(#own_names.store(#reads, ::core::sync::atomic::Ordering::Relaxed);)*
            }

            #[allow(unused_variables, reason = "a law without words has no use for the value")]
            fn set_word(&mut self, index: usize, value: i32) {
                match index {
                    #(#writes)*
                    _ => {}
                }
            }
        }
    }
}

/// Name and fields of `struct Name { … }`.
fn structure(item: TokenStream) -> Option<(Ident, Vec<Field>)> {
    let mut tokens = item.into_iter();
    tokens.find(|token| matches!(token, TokenTree::Ident(word) if word == "struct"))?;
    let Some(TokenTree::Ident(name)) = tokens.next() else {
        return None;
    };
    match tokens.next() {
        Some(TokenTree::Group(body)) if body.delimiter() == Delimiter::Brace => {
            Some((name, fields(body.stream())?))
        }
        Some(TokenTree::Punct(end)) if end.as_char() == ';' => Some((name, vec![])),
        _ => None,
    }
}

fn fields(body: TokenStream) -> Option<Vec<Field>> {
    let (mut fields, mut initial) = (vec![], None);
    let mut tokens = body.into_iter().peekable();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(sign) if sign.as_char() == '#' => {
                if let Some(TokenTree::Group(attribute)) = tokens.next() {
                    initial = initial.or_else(|| initial_of(attribute.stream()));
                }
            }
            TokenTree::Ident(name) => {
                let Some(TokenTree::Punct(_)) = tokens.next() else {
                    return None;
                };
                let Some(TokenTree::Ident(kind)) = tokens.next() else {
                    return None;
                };
                // A comma, or the end.
                tokens.next();
                fields.push(Field {
                    name,
                    is_half: kind == "u16",
                    initial: initial.take().unwrap_or_else(|| quote!(0)),
                });
            }
            _ => return None,
        }
    }
    Some(fields)
}

/// The number of `initial(…)`.
fn initial_of(attribute: TokenStream) -> Option<TokenStream> {
    let mut tokens = attribute.into_iter();
    match (tokens.next(), tokens.next()) {
        (Some(TokenTree::Ident(name)), Some(TokenTree::Group(number))) if name == "initial" => {
            Some(number.stream())
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::derive_state;
    use quote::quote;

    #[test]
    fn words_have_names_and_initial_values() {
        let text = derive_state(quote! {
            /// State kept from one control period to the next.
            pub struct State {
                /// A half.
                age: u16,
                /// A word.
                #[initial(-6)]
                turn: Word,
            }
        });
        let text = text.to_string();
        for part in [
            "age : 0",
            "turn : :: hexagen :: arith :: Word (- 6)",
            "& [\"age\" , \"turn\"]",
            "0usize => self . age = value as u16",
            "1usize => self . turn",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
    }

    #[test]
    fn a_law_may_keep_nothing_and_other_items_are_refused() {
        assert!(
            derive_state(quote!(
                pub struct State {}
            ))
            .to_string()
            .contains("INITIAL")
        );
        for item in [
            quote!(
                enum State {}
            ),
            quote!(struct State { age: }),
            quote!(
                struct State(u16);
            ),
        ] {
            assert!(derive_state(item).to_string().contains("compile_error"));
        }
    }
}
