//! The Rust emitter: from a verified graph to a type that reads as if written by hand.
//!
//! `stage` makes a function of each planned stage, `function` the entries that call them,
//! `expression` writes operators, `interface` the type. The same graph gives the same tokens;
//! nothing here can fail.

mod expression;
mod format;
mod function;
mod groups;
mod imports;
mod interface;
mod names;
mod source;
mod stage;
mod tables;
mod text_tokens;

pub use format::{format_rust, readable_rust, rustfmt};

use super::rows::WholeCommand;
use super::{texts, times};
use crate::at_once::at_once;
use crate::interface::Interface;
use crate::ir::{Program, Setter, VerifiedGraph};
use function::{SetterCode, emit_setter, emit_step};
use imports::{imports, settle};
use interface::Types;
use names::{docs, item_names, number, screaming};
use proc_macro2::{Ident, Span, TokenStream};
use source::{Source, quote};
use std::collections::HashSet;
use tables::emit_tables;
use text_tokens::tokens_of;

/// Name, visibility and attributes of the emitted type.
#[derive(Clone, Debug)]
pub struct Surface {
    /// The type's name, with the span for messages about the type.
    pub name: Ident,
    /// `pub`, `pub(crate)` or nothing.
    pub visibility: TokenStream,
    /// Attributes of the type and its code: `#[cfg(…)]`.
    pub attributes: TokenStream,
    /// Attributes of the type: the user's own documentation, which comes first.
    pub type_attributes: TokenStream,
}

impl Surface {
    /// A public type without attributes.
    pub fn public(name: &str) -> Self {
        Self {
            name: Ident::new(name, Span::call_site()),
            visibility: quote::quote!(pub),
            attributes: TokenStream::new(),
            type_attributes: TokenStream::new(),
        }
    }
}

/// A drive's code as text, before the type itself.
pub struct RustText {
    type_name: String,
    /// Documentation of the type.
    docs: Source,
    /// Imports.
    imports: Source,
    /// All other items.
    body: Source,
}

/// The text of one drive's code.
pub fn write_rust(graph: &VerifiedGraph, interface: &Interface, type_name: &str) -> RustText {
    let program = graph.program();
    let types = Types {
        program,
        interface,
        name: type_name,
    };
    let whole = WholeCommand::of(program);
    let setters = || -> Vec<(Setter, SetterCode)> {
        let setters = program.setters.iter();
        setters
            .map(|(set, function)| (*set, emit_setter(program, *set, function)))
            .collect()
    };
    let step = || emit_step(program, whole.as_ref());
    let (step, setters) = at_once(step, setters);
    let control = types.control(&step, &setters);
    let public = types.constants();
    let setter_stages = setters.iter().map(|(_, setter)| &setter.stages);
    let (state, rotor, stages) = (types.state(), &step.rotor_definition, &step.stages);
    let code = quote!(#state #rotor #control #stages #(#setter_stages)*);
    let names = item_names(&code);
    let constants = constants(program, whole.as_ref(), &names);
    let body = quote!(#public #constants #code);
    let imports = imports(&item_names(&body), type_name);
    let mut doc = texts::of_type(program, interface);
    let times = times::documentation(&interface.times);
    if !times.is_empty() {
        doc.push(String::new());
        doc.extend(times);
    }
    RustText {
        type_name: type_name.to_owned(),
        docs: docs(&doc),
        imports,
        body,
    }
}

impl RustText {
    /// The type and its code. All but the type is inside an anonymous constant, so that its names
    /// cannot clash.
    pub fn into_tokens(self, surface: &Surface) -> TokenStream {
        let Surface {
            name,
            visibility,
            attributes,
            type_attributes,
        } = surface;
        let docs = tokens(&self.docs);
        let imports = tokens(&self.imports);
        let body = settle(tokens(&self.body), &self.type_name);
        quote::quote! {
            #attributes
            #type_attributes
            #docs
            #[derive(Clone, Copy, Debug)]
            #visibility struct #name;

            #attributes
            const _: () = {
                #imports
                #body
            };
        }
    }
}

/// The code of one drive.
pub fn emit_rust(graph: &VerifiedGraph, interface: &Interface, surface: &Surface) -> TokenStream {
    write_rust(graph, interface, &surface.name.to_string()).into_tokens(surface)
}

fn tokens(code: &Source) -> TokenStream {
    // Templates are tokens; their variables are numbers, names and literals.
    tokens_of(code.as_str()).unwrap_or_else(|| {
        quote::quote!(::core::compile_error!(
            "hexagen emitted invalid Rust: a bug of hexagen, please report it with the specification"
        );)
    })
}

/// The constants and tables that the body uses.
fn constants(program: &Program, whole: Option<&WholeCommand<'_>>, names: &HashSet<&str>) -> Source {
    let named = |name: &str| !name.is_empty() && names.contains(&*name.to_uppercase());
    let constants = program
        .constants
        .iter()
        .filter(|constant| named(&constant.name))
        .map(|constant| {
            let (name, doc) = (screaming(&constant.name), docs(&constant.doc));
            let raw = number(i64::from(constant.raw));
            quote!(#doc const #name: Word = Word(#raw);)
        });
    let tables = emit_tables(program, whole, named);
    quote!(#(#constants)* #tables)
}
