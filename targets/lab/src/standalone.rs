//! Stand-ins for crates, to compile emitted code and the runtime by rustc alone.

use hexagen_codegen::derive_state;
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use std::fmt::Write as _;

/// The macros that the runtime re-exports; not called by emitted code with expanded derives.
pub const MACROS: &str = "#![no_std]\n#![allow(non_snake_case)]\n\
    #[macro_export] macro_rules! controller { () => {} }\n\
    #[macro_export] macro_rules! specification_fields { () => {} }\n\
    #[macro_export] macro_rules! verify { () => {} }\n\
    #[macro_export] macro_rules! State { () => {} }\n";

/// The `fixed` crate's signed 32-bit types, reduced to what emitted code and the runtime use.
pub fn fixed() -> String {
    let mut text = String::from(
        "#![no_std]
pub struct FixedI32<Frac>(i32, core::marker::PhantomData<Frac>);
impl<Frac> Clone for FixedI32<Frac> { fn clone(&self) -> Self { *self } }
impl<Frac> Copy for FixedI32<Frac> {}
impl<Frac> PartialEq for FixedI32<Frac> { fn eq(&self, other: &Self) -> bool { self.0 == other.0 } }
impl<Frac> Eq for FixedI32<Frac> {}
impl<Frac> core::fmt::Debug for FixedI32<Frac> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result { self.0.fmt(f) }
}
impl<Frac> FixedI32<Frac> {
    #[inline(always)] pub const fn from_bits(bits: i32) -> Self { Self(bits, core::marker::PhantomData) }
    #[inline(always)] pub const fn to_bits(self) -> i32 { self.0 }
}
impl FixedI32<types::U16> {
    pub fn saturating_from_num(number: i32) -> Self { Self::from_bits(number.saturating_mul(1 << 16)) }
}
pub mod types {
",
    );
    for frac_bits in 0..=32 {
        let integer_bits = 32 - frac_bits;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "    pub struct U{frac_bits};\n    pub type I{integer_bits}F{frac_bits} = crate::FixedI32<U{frac_bits}>;"
        );
    }
    text + "}\n"
}

/// Emitted code with every `#[derive(::hexagen::State)]` expanded, as rustc alone has no such
/// macro.
pub fn derived(code: TokenStream) -> TokenStream {
    let mut written = TokenStream::new();
    let mut tokens = code.into_iter().peekable();
    while let Some(token) = tokens.next() {
        if is_attribute(&token, tokens.peek(), "derive(::hexagen::State)") {
            tokens.next();
            let mut item = TokenStream::new();
            for token in tokens.by_ref() {
                let is_body = matches!(&token, TokenTree::Group(group) if group.delimiter() == Delimiter::Brace);
                item.extend([token]);
                if is_body {
                    break;
                }
            }
            written.extend(without_initial(item.clone()));
            written.extend(derive_state(item));
        } else {
            written.extend([inside(token, derived)]);
        }
    }
    written
}

/// The structure without the attributes of the derive.
fn without_initial(item: TokenStream) -> TokenStream {
    let mut written = TokenStream::new();
    let mut tokens = item.into_iter().peekable();
    while let Some(token) = tokens.next() {
        if is_attribute(&token, tokens.peek(), "initial(") {
            tokens.next();
        } else {
            written.extend([inside(token, without_initial)]);
        }
    }
    written
}

/// The token; a group with its content changed by `change`.
fn inside(token: TokenTree, change: impl Fn(TokenStream) -> TokenStream) -> TokenTree {
    match token {
        TokenTree::Group(group) => Group::new(group.delimiter(), change(group.stream())).into(),
        other => other,
    }
}

/// Whether two tokens are an attribute whose text, without blanks, has this beginning.
fn is_attribute(token: &TokenTree, next: Option<&TokenTree>, begin: &str) -> bool {
    let is_sign = matches!(token, TokenTree::Punct(sign) if sign.as_char() == '#');
    let text = |group: &Group| group.stream().to_string().replace(' ', "");
    is_sign && matches!(next, Some(TokenTree::Group(group)) if text(group).starts_with(begin))
}

#[cfg(test)]
mod tests {
    use super::derived;

    #[test]
    fn derives_are_expanded_everywhere() {
        let code = "const _: () = { #[derive(::hexagen::State)] pub struct State { \
                    #[doc = \"x\"] #[initial(-6)] x: Word, } fn f() {} };";
        let written = derived(code.parse().expect("Rust")).to_string();
        for part in [
            "pub struct State { # [doc = \"x\"] x : Word , }",
            "impl :: hexagen :: State for State",
            "Word (- 6)",
            "fn f () { }",
        ] {
            assert!(written.contains(part), "{part} is missing in {written}");
        }
        assert!(!written.contains("initial") && !written.contains("derive ("));
    }
}
