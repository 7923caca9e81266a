//! The names of a module that come from outside, and what happens where the user's type has one of
//! them.
//!
//! Emitted code uses short names: `Word`, `Legs`, `Drive`. A motor may be called like that, too;
//! then its type has the name, and the other item is `HexagenWord` in this one module.

use super::interface::fixed_type;
use super::names::HELPERS;
use super::source::{Source, quote};
use crate::interface::{Interface, PublicValue};
use proc_macro2::{Group, Ident, TokenStream, TokenTree};
use std::cmp::Reverse;
use std::collections::{BTreeSet, HashSet};

/// Stands for the user's type where that has a name of another item, until all names are settled.
const PLACEHOLDER: &str = "EmittedDrive";

/// Items of the runtime crate's root.
const SHARED: [&str; 15] = [
    "BusWatch",
    "DoubleBuffer",
    "Drive",
    "DriveLoop",
    "DriveSetPoint",
    "Fault",
    "Format",
    "LegState",
    "Legs",
    "Rounding",
    "Sample",
    "SharedWord",
    "Status",
    "mode",
    "pairs_from_bits",
];

/// Types that the module defines beside the user's; besides them the results of large stages and the rows of tables.
const OWN: [&str; 3] = ["ControlLoop", "SetPoint", "State"];

/// The user's type in a body that [`settle`] has not seen yet.
pub(super) fn unsettled(name: &str) -> Source {
    Source::of(if clashes(name) { PLACEHOLDER } else { name })
}

/// Gives the user's type its name, and every other type of that name in `body` another one.
pub(super) fn settle(body: TokenStream, name: &str) -> TokenStream {
    if clashes(name) {
        replace(body, name, &alias(name))
    } else {
        body
    }
}

/// Whether another item of the module has this name.
fn clashes(taken: &str) -> bool {
    taken == "Word"
        || taken == "Default"
        || SHARED.contains(&taken)
        || OWN.contains(&taken)
        || taken.ends_with("Results")
        || taken.ends_with("Row")
        || is_fixed(taken)
}

fn replace(tokens: TokenStream, name: &str, alias: &str) -> TokenStream {
    let named = |name: &str, ident: &Ident| Ident::new(name, ident.span());
    tokens
        .into_iter()
        .map(|token| match token {
            TokenTree::Ident(ident) if ident == PLACEHOLDER => named(name, &ident).into(),
            TokenTree::Ident(ident) if ident == name => named(alias, &ident).into(),
            // Links of the documentation follow.
            TokenTree::Literal(literal) => {
                let text = literal.to_string();
                let link = format!("[`{name}::");
                let text = text.replace(&link, &format!("[`{alias}::"));
                TokenTree::Literal(text.parse().unwrap_or(literal))
            }
            TokenTree::Group(group) => {
                let mut replaced =
                    Group::new(group.delimiter(), replace(group.stream(), name, alias));
                replaced.set_span(group.span());
                replaced.into()
            }
            token => token,
        })
        .collect()
}

fn alias(name: &str) -> String {
    format!("Hexagen{name}")
}

/// Whether the name is that of a `fixed` type of 32 bits, as [`fixed_type`] gives them.
fn is_fixed(name: &str) -> bool {
    (0..=32).any(|frac_bits| fixed_type(frac_bits).as_str() == name)
}

/// The imports of a body that holds `names`; `name` is the user's type.
pub(super) fn imports(names: &HashSet<&str>, interface: &Interface, name: &str) -> Source {
    let import = |item: &str| {
        if name == item {
            Source::of(format!("{item} as {}", alias(item)))
        } else {
            Source::of(item)
        }
    };
    let list = |items: Vec<Source>| match items.as_slice() {
        [single] => single.clone(),
        many => quote!({ #(#many),* }),
    };
    let used = |item: &&str| names.contains(*item);
    let arith = std::iter::once("Word").chain(HELPERS.into_iter().filter(used));
    let arith = list(arith.map(import).collect());
    // In the order of their integer bits, as rustfmt has them.
    let mut frac_bits: BTreeSet<Reverse<u32>> = interface
        .constants
        .iter()
        .filter_map(|constant| match constant.value {
            PublicValue::Fixed { frac_bits, .. } | PublicValue::Vectors { frac_bits, .. } => {
                Some(Reverse(frac_bits))
            }
            _ => None,
        })
        .collect();
    // The set-point's type.
    frac_bits.insert(Reverse(16));
    let fixed = frac_bits
        .into_iter()
        .map(|Reverse(frac_bits)| import(fixed_type(frac_bits).as_str()));
    let fixed = list(fixed.collect());
    let shared = list(SHARED.into_iter().filter(used).map(import).collect());
    let standard = (name == "Default").then(|| {
        let import = import("Default");
        quote!(use ::core::default::#import;)
    });
    quote! {
        #standard
        use ::hexagen::arith::#arith;
        use ::hexagen::fixed::types::#fixed;
        use ::hexagen::#shared;
    }
}
