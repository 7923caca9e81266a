//! Documentation of a word length chosen by the target.

use crate::diagnostics::significant;
use crate::interface::{Interface, PublicConstant, PublicValue};

const HEADING: [&str; 3] = ["", "# Word length", ""];

/// Error bounds with 16-bit words against 32-bit words.
pub fn narrow_words(narrow: &Interface, wide: &Interface) -> Vec<String> {
    let mut doc = HEADING.map(str::to_owned).to_vec();
    doc.push(
        "16-bit words with 32-bit products, the choice of `target: cortex_m0` where they suffice: the core has no 64-bit product."
            .to_owned(),
    );
    let costs = errors(narrow).filter_map(|(name, of_narrow)| {
        let (_, of_wide) = errors(wide).find(|(other, _)| *other == name)?;
        let [of_narrow, of_wide] = [of_narrow, of_wide].map(significant);
        Some(format!("`{name}` is {of_narrow} in place of {of_wide}"))
    });
    let costs: Vec<String> = costs.collect();
    if !costs.is_empty() {
        doc.push(format!(
            "Compared with 32-bit words (`word: 32`), {}.",
            costs.join(", ")
        ));
    }
    doc
}

/// Why the words have 32 bits in spite of the target.
pub fn wide_words(reason: &str) -> Vec<String> {
    let mut doc = HEADING.map(str::to_owned).to_vec();
    doc.push(format!(
        "32-bit words: 16-bit words, which `target: cortex_m0` prefers, do not suffice ({reason})."
    ));
    doc
}

/// The bounds of a drive by their names.
fn errors(interface: &Interface) -> impl Iterator<Item = (&str, f64)> {
    interface
        .constants
        .iter()
        .filter_map(|PublicConstant { name, value, .. }| match value {
            PublicValue::Fixed { bits, frac_bits } if name.ends_with("_ERROR") => Some((
                name.as_str(),
                f64::from(*bits) * (-f64::from(*frac_bits)).exp2(),
            )),
            _ => None,
        })
}
