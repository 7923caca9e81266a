//! Imports of emitted code, and renaming on a clash with the user's type.
//!
//! Emitted code uses short names: `Word`, `Legs`, `Drive`. If the user's type has such a name, the
//! other item is imported as `HexagenWord`.

use super::names::{HELPERS, fixed_type};
use super::source::{Source, quote};
use proc_macro2::{Group, Ident, Spacing, TokenStream, TokenTree};
use std::collections::HashSet;

/// Placeholder of the user's type until names are settled.
const PLACEHOLDER: &str = "EmittedDrive";

/// Items of the runtime crate's root.
const SHARED: [&str; 22] = [
    "AngleSensor",
    "Checked",
    "Control",
    "FixedBus",
    "Format",
    "Intervals",
    "LegState",
    "Legs",
    "Limits",
    "MeasuredBus",
    "Observation",
    "Rounding",
    "SensedPhases",
    "Sensor",
    "Sensors",
    "ThirdSensor",
    "SpeedLoop",
    "ToldBus",
    "Unit",
    "Units",
    "Words",
    "pairs_from_bits",
];

/// Types that the code defines, besides the user's, results of stages and rows of tables.
const OWN: [&str; 2] = ["Rotor", "State"];

/// The user's type in a body before [`settle`].
pub(super) fn unsettled(name: &str) -> Source {
    Source::of(if clashes(name) { PLACEHOLDER } else { name })
}

/// Gives the user's type its name, and renames other types of that name in `body`.
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
        || SHARED.contains(&taken)
        || OWN.contains(&taken)
        || taken.ends_with("Results")
        || taken.ends_with("Row")
        || is_fixed(taken)
}

fn replace(tokens: TokenStream, name: &str, alias: &str) -> TokenStream {
    let named = |name: &str, ident: &Ident| Ident::new(name, ident.span());
    // Names after `type` and `::` belong to other scopes: associated types, items of crates.
    let (mut is_foreign, mut is_joint) = (false, false);
    tokens
        .into_iter()
        .map(|token| {
            let was_foreign = std::mem::take(&mut is_foreign);
            let was_joint = std::mem::take(&mut is_joint);
            match token {
                TokenTree::Ident(ident) if ident == PLACEHOLDER => named(name, &ident).into(),
                TokenTree::Ident(ident) if ident == name && !was_foreign => {
                    named(alias, &ident).into()
                }
                TokenTree::Ident(ident) => {
                    is_foreign = ident == "type";
                    ident.into()
                }
                TokenTree::Punct(punct) => {
                    is_foreign = was_joint && punct.as_char() == ':';
                    is_joint = punct.spacing() == Spacing::Joint;
                    punct.into()
                }
                TokenTree::Group(group) => {
                    let mut replaced =
                        Group::new(group.delimiter(), replace(group.stream(), name, alias));
                    replaced.set_span(group.span());
                    replaced.into()
                }
                token @ TokenTree::Literal(_) => token,
            }
        })
        .collect()
}

fn alias(name: &str) -> String {
    format!("Hexagen{name}")
}

/// Whether the name is a `fixed` type of 32 bits, as from [`fixed_type`].
fn is_fixed(name: &str) -> bool {
    (0..=32).any(|frac_bits| fixed_type(frac_bits).as_str() == name)
}

/// The imports of a body that holds `names`; `name` is the user's type.
pub(super) fn imports(names: &HashSet<&str>, name: &str) -> Source {
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
    // In rustfmt's order: by integer bits.
    let fixed = (0..=32).rev().map(fixed_type);
    let fixed = fixed.filter(|fixed| names.contains(fixed.as_str()));
    let fixed: Vec<Source> = fixed.map(|fixed| import(fixed.as_str())).collect();
    let fixed = (!fixed.is_empty()).then(|| {
        let fixed = list(fixed);
        quote!(use ::hexagen::fixed::types::#fixed;)
    });
    let shared = list(SHARED.into_iter().filter(used).map(import).collect());
    quote! {
        use ::hexagen::arith::#arith;
        #fixed
        use ::hexagen::#shared;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> TokenStream {
        text.parse().expect("tokens")
    }

    #[test]
    fn another_item_of_the_types_name_is_renamed_in_its_own_scope() {
        let body =
            "type State = u8; fn f(a: EmittedDrive, b: State, c: other::State) { [State::X] }";
        let settled = "type State = u8; fn f(a: State, b: HexagenState, c: other::State) { [HexagenState::X] }";
        let found = settle(tokens(body), "State").to_string();
        assert_eq!(found, tokens(settled).to_string());
        // No other item has this name.
        let found = settle(tokens(body), "HubDrive").to_string();
        assert_eq!(found, tokens(body).to_string());
    }

    #[test]
    fn an_import_of_the_types_name_gets_another() {
        let names = HashSet::from(["Word", "Legs", "mul_round"]);
        for (name, import) in [("Legs", "Legs as HexagenLegs"), ("HubDrive", "Legs")] {
            let found = tokens(&imports(&names, name).to_string()).to_string();
            let item = tokens(&format!("use ::hexagen::{import};")).to_string();
            assert!(found.contains(&item), "no {item} in {found}");
        }
    }
}
