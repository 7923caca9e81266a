//! What the documentation says of a word length that the target chose.

use crate::diagnostics::significant;
use crate::interface::{Interface, PublicConstant, PublicValue};

const HEADING: [&str; 3] = ["", "# Word length", ""];

/// What words of 16 bits cost against those of 32.
pub fn narrow_words(narrow: &Interface, wide: &Interface) -> Vec<String> {
    let mut doc = HEADING.map(str::to_owned).to_vec();
    doc.push(
        "Words of 16 bits with products of 32, as `target: cortex_m0` chooses where they suffice: the core has no longer products."
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
            "Against words of 32 bits, which `word: 32` chooses, {}.",
            costs.join(", ")
        ));
    }
    doc
}

/// Why words have 32 bits all the same.
pub fn wide_words(reason: &str) -> Vec<String> {
    let mut doc = HEADING.map(str::to_owned).to_vec();
    doc.push(format!(
        "Words of 32 bits: those of 16, which `target: cortex_m0` prefers, do not suffice ({reason})."
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
