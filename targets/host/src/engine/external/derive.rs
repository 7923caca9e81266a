//! Derives of emitted code, written out: rustc alone has no macro of ours to call.

use hexagen_codegen::derive_state;
use proc_macro2::{Group, TokenStream, TokenTree};

/// The code with every `#[derive(::hexagen::State)]` replaced by what it expands to.
pub fn derived(code: TokenStream) -> TokenStream {
    let mut written = TokenStream::new();
    let mut tokens = code.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let is_derive = is_sign(&token)
            && matches!(tokens.peek(), Some(TokenTree::Group(attribute)) if is_state(attribute));
        if is_derive {
            tokens.next();
            // Up to the end of the fields.
            let is_body = |token: &TokenTree| matches!(token, TokenTree::Group(group) if group.delimiter() == proc_macro2::Delimiter::Brace);
            let mut item = vec![];
            for token in tokens.by_ref() {
                let is_end = is_body(&token);
                item.push(token);
                if is_end {
                    break;
                }
            }
            let item = TokenStream::from_iter(item);
            written.extend(without_initial(item.clone()));
            written.extend(derive_state(item));
        } else if let TokenTree::Group(group) = token {
            let inner = derived(group.stream());
            written.extend([TokenTree::from(Group::new(group.delimiter(), inner))]);
        } else {
            written.extend([token]);
        }
    }
    written
}

fn is_sign(token: &TokenTree) -> bool {
    matches!(token, TokenTree::Punct(sign) if sign.as_char() == '#')
}

fn is_state(attribute: &Group) -> bool {
    let text: String = attribute.stream().to_string();
    text.split_whitespace().collect::<String>() == "derive(::hexagen::State)"
}

/// The structure without the attributes that only the derive knows.
fn without_initial(item: TokenStream) -> TokenStream {
    let mut written = TokenStream::new();
    let mut tokens = item.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let is_initial = is_sign(&token)
            && matches!(tokens.peek(), Some(TokenTree::Group(attribute)) if attribute.stream().to_string().starts_with("initial"));
        if is_initial {
            tokens.next();
        } else if let TokenTree::Group(group) = token {
            let inner = without_initial(group.stream());
            written.extend([TokenTree::from(Group::new(group.delimiter(), inner))]);
        } else {
            written.extend([token]);
        }
    }
    written
}
