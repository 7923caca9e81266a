//! Documentation of fields in editors.
//!
//! The runtime crate has a constant for each field, whose documentation is that of the field
//! ([`expand_fields`]). A macro call's expansion refers to those of the fields that it writes, by
//! the user's own tokens ([`references`]): where the pointer rests on such a token, the editor
//! finds the constant and shows what it documents. Nothing of it is in a program.

use crate::diagnostics::Location;
use crate::spec::ast::{Field, Section, Value};
use crate::spec::field_texts::{FieldText, kind_texts, own_texts, section_texts, shared_texts};
use crate::spec::{KINDS, Kind, Rule, SpecAst, fields};
use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use quote::quote;

/// The documented constants, in the module `specification` of the runtime crate.
pub fn expand_fields() -> TokenStream {
    let [motor, inverter] = ["motor", "inverter"].map(|section| {
        let name = name(section);
        let fields = section_texts(section);
        module(&name, fields.iter().map(constant))
    });
    let kinds = KINDS.iter().map(|kind| {
        let options = own_texts(kind);
        module(&name(kind.name), options.iter().map(constant))
    });
    let shared = [kind_texts(), shared_texts()].concat();
    let shared = shared.iter().map(constant);
    let controller = module(&name("controller"), shared.chain(kinds));
    quote!(#motor #inverter #controller)
}

fn module(name: &Ident, items: impl Iterator<Item = TokenStream>) -> TokenStream {
    let about = format!("What editors show for the fields of `{name}`.");
    quote! {
        #[doc = #about]
        #[doc(hidden)]
        #[allow(non_upper_case_globals, reason = "they have the names of the fields")]
        pub mod #name {
            #(#items)*
        }
    }
}

/// The field's example is the constant's value, which editors show above the documentation.
fn constant(field: &FieldText) -> TokenStream {
    let FieldText {
        name: field_name,
        example,
        text,
    } = field;
    let name = name(field_name);
    quote! {
        #[doc = #text]
        pub const #name: &str = #example;
    }
}

/// An identifier: kinds of controllers have hyphens.
fn name(text: &str) -> Ident {
    Ident::new(&text.replace('-', "_"), Span::call_site())
}

/// One constant that refers to all fields of a macro call that there are; the others are errors.
/// `attributes`: those of the drive's code.
pub(crate) fn references(ast: &SpecAst, attributes: &TokenStream) -> TokenStream {
    let kind = kind_of(&ast.controller);
    let motor = section(&ast.motor, "motor");
    let inverter = section(&ast.inverter, "inverter");
    let options = ast.controller.fields.iter();
    let options = options.filter_map(|field| option(kind?, field));
    let paths: Vec<TokenStream> = motor.chain(inverter).chain(options).collect();
    let count = paths.len();
    if count == 0 {
        return TokenStream::new();
    }
    quote! {
        #attributes
        const _: [&str; #count] = [#(::hexagen::specification::#paths),*];
    }
}

/// The fields of `motor` or `inverter`, as paths in the module `specification`.
fn section<'a>(section: &'a Section, name: &'static str) -> impl Iterator<Item = TokenStream> + 'a {
    let module = self::name(name);
    section.fields.iter().filter_map(move |field| {
        let given = written(field)?;
        (fields::section_of(&field.name) == Some(name)).then(|| quote!(#module::#given))
    })
}

/// An option of this kind of controller, or the kind itself.
fn option(kind: &'static Kind, field: &Field) -> Option<TokenStream> {
    let given = written(field)?;
    let is_among = |rules: Vec<&Rule>| rules.iter().any(|rule| rule.name == field.name);
    if field.name == "kind" {
        let kind = Ident::new(&kind.name.replace('-', "_"), given.span());
        Some(quote!(controller::#kind))
    } else if is_among((kind.own)()) {
        let kind = name(kind.name);
        Some(quote!(controller::#kind::#given))
    } else {
        is_among((kind.shared)()).then(|| quote!(controller::#given))
    }
}

/// The kind of controller that a call names.
fn kind_of(controller: &Section) -> Option<&'static Kind> {
    let Value::Word(word) = &controller.field("kind")?.value else {
        return None;
    };
    let name = word.replace('_', "-");
    KINDS.iter().find(|kind| kind.name == name)
}

/// The field's name as a token of the macro call; none for one of a file.
fn written(field: &Field) -> Option<Ident> {
    let Location::Macro(tokens) = &field.name_location else {
        return None;
    };
    match tokens.clone().into_iter().next() {
        Some(TokenTree::Ident(name)) => Some(name),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::{KINDS, Kind, expand_fields};

    /// A field of a call that has no constant would not compile.
    #[test]
    fn every_option_has_its_constant() {
        let items = expand_fields().to_string();
        for rule in KINDS.iter().flat_map(Kind::rules) {
            let constant = format!("pub const {} :", rule.name);
            assert!(items.contains(&constant), "{}", rule.name);
        }
    }
}
