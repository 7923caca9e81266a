//! The Rust emitter: from a verified graph to a module that reads as if written by hand.
//!
//! `stage` makes a function of each planned stage, `function` strings the calls together, `expression` writes
//! operators, `interface`, `set_point` and `traits` the types around them.
//! The same graph gives the same tokens, whoever asks; nothing here can fail.

mod expression;
mod format;
mod function;
mod groups;
mod imports;
mod interface;
mod names;
mod set_point;
mod source;
mod stage;
mod tables;
mod traits;

extern crate proc_macro;

pub use format::{format_rust, rustfmt};

use super::rows::WholeCommand;
use super::texts;
use crate::at_once::at_once;
use crate::interface::Interface;
use crate::ir::{Program, VerifiedGraph};
use function::{emit_setter, emit_step};
use imports::{imports, settle};
use interface::Types;
use names::{docs, inner_docs, item_names, module_ident, number, screaming};
use proc_macro2::{Ident, Span, TokenStream};
use source::{Source, quote};
use std::collections::HashSet;
use tables::emit_tables;

/// How the emitted type appears to the code around it.
#[derive(Clone, Debug)]
pub struct Surface {
    /// The type's name; its span is where the compiler points in messages about the type.
    pub name: Ident,
    /// `pub`, `pub(crate)` or nothing.
    pub visibility: TokenStream,
    /// Attributes of the whole: `#[cfg(…)]`. They stand on the module and on its re-export.
    pub attributes: TokenStream,
    /// Attributes of the type: further documentation.
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

/// A drive's module as text, around the name that the user gave its type: all that this emitter works out.
pub struct RustText {
    type_name: String,
    /// Documentation of the module, and its imports.
    head: Source,
    /// Constants, tables, and documentation of the type.
    before: Source,
    /// The type's fields, and everything behind them.
    body: Source,
}

/// The text of one drive's module.
pub fn write_rust(graph: &VerifiedGraph, interface: &Interface, type_name: &str) -> RustText {
    let program = graph.program();
    let types = Types {
        program,
        interface,
        name: type_name,
    };
    let around = || {
        let setters: Vec<_> = program
            .setters
            .iter()
            .map(|setter| emit_setter(program, setter))
            .collect();
        let drive = types.drive(&setters);
        let set_point = types.set_point(&setters);
        let control_loop = types.control_loop();
        let setter_stages = setters.iter().map(|setter| &setter.stages);
        let state = types.state();
        let drive_trait = types.drive_trait();
        let header = inner_docs(&texts::header(program, interface));
        let before = quote!(#drive #set_point #control_loop);
        let behind = quote!(#(#setter_stages)* #state #drive_trait);
        (header, before, behind, docs(&interface.doc))
    };
    let paths = program.step.paths(&program.tables);
    let whole = WholeCommand::of(program, &paths);
    let step = || emit_step(program, &paths, whole.as_ref());
    let (step, (header, before, behind, docs)) = at_once(step, around);
    let (step_main, step_stages) = (&step.main, &step.stages);
    let body = quote! {
        #before
        #step_main
        #step_stages
        #behind
    };
    let names = item_names(&body);
    let imports = imports(&names, interface, type_name);
    let constants = constants(program, whole.as_ref(), &names);
    RustText {
        type_name: type_name.to_owned(),
        head: quote!(#header #imports),
        before: quote!(#constants #docs),
        body,
    }
}

impl RustText {
    /// The module with the re-export of its type, as it appears to the code around it.
    pub fn into_tokens(self, surface: &Surface) -> TokenStream {
        let Surface {
            name,
            visibility,
            attributes,
            type_attributes,
        } = surface;
        let head = tokens(&self.head);
        let before = settle(tokens(&self.before), &self.type_name);
        let body = settle(tokens(&self.body), &self.type_name);
        let module = module_ident(&self.type_name);
        quote::quote! {
            #attributes
            #visibility use #module::#name;

            #attributes
            #visibility mod #module {
                #head
                #before
                #type_attributes
                pub struct #name
                #body
            }
        }
    }
}

/// The module of one drive, and the re-export of its type.
pub fn emit_rust(graph: &VerifiedGraph, interface: &Interface, surface: &Surface) -> TokenStream {
    write_rust(graph, interface, &surface.name.to_string()).into_tokens(surface)
}

fn tokens(code: &Source) -> TokenStream {
    let code = code.as_str();
    let tokens = if proc_macro::is_available() {
        // What `proc_macro2` makes in a macro, without its own reading of the text before the compiler's, which would
        // take longer than all the rest of the emission.
        code.parse().map(proc_macro::TokenStream::into).ok()
    } else {
        code.parse().ok()
    };
    // Templates are tokens, and what they name is numbers, names and literals.
    tokens.unwrap_or_else(|| {
        quote::quote!(::core::compile_error!(
            "hexagen emitted a text that is no Rust: a bug of hexagen, please report it with the specification"
        );)
    })
}

/// The constants and tables that the body names.
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
