//! Tokens of emitted text, as a macro returns them.
//!
//! The compiler gives the tokens of a text the place of the macro call. The macro server of
//! rust-analyzer gives them their places in the text, which the editor looks up in the user's file,
//! and fails where that is shorter.

extern crate proc_macro;

use proc_macro2::{Group, Span, TokenStream, TokenTree};

/// The tokens of a text; none if it is not Rust. In a macro all have the place of its call.
pub(super) fn tokens_of(text: &str) -> Option<TokenStream> {
    if !proc_macro::is_available() {
        return text.parse().ok();
    }
    // In a macro the compiler parses the text: `proc_macro2` would parse it a second time, which
    // takes longer than all the rest of the emission.
    let parsed: proc_macro::TokenStream = text.parse().ok()?;
    let tokens = TokenStream::from(parsed);
    Some(if texts_are_at_the_call() {
        tokens
    } else {
        at_the_call(tokens)
    })
}

/// Whether the tokens of a text have the place of the macro call already, as in the compiler: to
/// place each of them again would take as long as to make them. What a span prints is all that
/// tells spans apart.
fn texts_are_at_the_call() -> bool {
    let Ok(sample) = "sample".parse::<proc_macro::TokenStream>() else {
        return true;
    };
    let here = format!("{:?}", proc_macro::Span::call_site());
    sample
        .into_iter()
        .all(|token| format!("{:?}", token.span()) == here)
}

/// The same tokens with the place of the macro call.
fn at_the_call(tokens: TokenStream) -> TokenStream {
    let placed = |token| {
        let mut token = match token {
            TokenTree::Group(group) => {
                Group::new(group.delimiter(), at_the_call(group.stream())).into()
            }
            token => token,
        };
        token.set_span(Span::call_site());
        token
    };
    tokens.into_iter().map(placed).collect()
}
