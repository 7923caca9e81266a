//! Units of the specification: a table of the names that data sheets use, with factors and sources
//! (`names`), and one of the quantities that products and quotients of them make (`quantities`).
//!
//! A unit is read as a product: `V/(rad/s)`, `oz-in-s2`, `mNm/Arms`, `V/1000rpm`. A space, hyphen,
//! point or `*` multiplies, a number behind a name is its power, a number before one its multiple.
//! The signs of print stand for their letters: Ω for `ohm`, µ for `u`, ° for `deg`, ² for `2`.
//!
//! Mechanical speed is in rad/s, so `V/krpm` and `V/(rad/s)` are one quantity; `V/Hz` and `Wb` are
//! flux linkages per electrical angle, another one.

mod names;
mod quantities;
mod reading;

pub use names::{NAMES, Name};
pub use quantities::Dimension;

use super::basis::Basis;
use crate::diagnostics::engineering;
use quantities::{KNOWN, quantity};
use reading::Product;
pub(super) use reading::in_letters;

/// A unit as it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its spelling in letters: `ohm` for `Ω`.
    pub symbol: String,
    /// The quantity that it measures.
    pub dimension: Dimension,
    factor: Factor,
}

/// 0.22e-3 is not 0.22/1000 in binary: dividing by an exact power of ten rounds only once.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Factor {
    Times(f64),
    Over(f64),
}

impl Unit {
    /// A value in this unit as SI value.
    pub fn to_si(&self, value: f64) -> f64 {
        match self.factor {
            Factor::Times(factor) => value * factor,
            Factor::Over(factor) => value / factor,
        }
    }

    /// The unit of the given spelling, where it says nothing of a wave's amplitude.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        let (unit, basis) = Self::parse(symbol)?;
        basis.is_none().then_some(unit)
    }

    /// The unit of the given spelling; `Arms` and `Vpk` say a basis, too.
    pub(super) fn parse(symbol: &str) -> Option<(Self, Option<Basis>)> {
        // An ounce is a mass, and a force where no mass makes sense: `oz-in2`, `oz-in`.
        [false, true].into_iter().find_map(|weighs| {
            let product = Product::parse(symbol, weighs)?;
            let (dimension, [times, over]) = quantity(&product.powers)?;
            let [times, over] = [times * product.times, over * product.over];
            let factor = if times == 1.0 {
                Factor::Over(over)
            } else {
                Factor::Times(times / over)
            };
            let unit = Self {
                symbol: product.symbol,
                dimension,
                factor,
            };
            Some((unit, product.basis))
        })
    }

    /// What a spelling that is no unit may stand for: two readings, each with what it means.
    pub(super) fn readings(symbol: &str) -> Option<[(&'static str, &'static str); 2]> {
        let product = Product::parse(symbol, false)?;
        quantities::readings(&product.powers)
    }

    /// The usual spelling of this unit with a smaller prefix, with which a value above some limits lies within them, SI.
    pub(super) fn of_other_prefix(
        &self,
        value: f64,
        [low, high]: [f64; 2],
    ) -> Option<&'static str> {
        let spellings = Self::spellings(self.dimension).iter().copied();
        let apart = |symbol: &&str| {
            let other = Self::from_symbol(symbol)?;
            let thousands = (self.to_si(1.0) / other.to_si(1.0)).log10() / 3.0;
            let is_prefix = (thousands - thousands.round()).abs() < 1e-6 && thousands > 0.5;
            let is_within = (low..=high).contains(&other.to_si(value));
            (is_prefix && is_within).then_some(thousands)
        };
        let fitting = spellings.filter_map(|symbol| Some((apart(&symbol)?, symbol)));
        let nearest = fitting.min_by(|one, other| one.0.total_cmp(&other.0))?;
        Some(nearest.1)
    }

    /// The usual spellings of a quantity's units.
    pub fn spellings(dimension: Dimension) -> &'static [&'static str] {
        let known = KNOWN.iter().find(|(known, _)| *known == dimension);
        known.map_or(&[], |(_, spellings)| spellings)
    }

    /// The reciprocal of a value, if that is one of some quantities: 20 mA/count for 50 counts/A.
    pub(super) fn of_inverse(value: f64, symbol: &str, dimensions: &[Dimension]) -> Option<String> {
        let (inverse, _) = Self::parse(&format!("1/({symbol})"))?;
        let dimension = dimensions
            .iter()
            .find(|wanted| **wanted == inverse.dimension)?;
        let known = Self::from_symbol(Self::spellings(*dimension).first()?)?;
        let value = inverse.to_si(1.0 / value) / known.to_si(1.0);
        let is_plausible = (1e-12..1e12).contains(&value);
        is_plausible.then(|| engineering(value, &known.symbol))
    }

    /// The known spelling of one of some quantities closest to an unknown one, if any is close: a
    /// slip of one letter in three, two that are exchanged, or of upper and lower case; or a prefix alone.
    pub fn nearest(symbol: &str, dimensions: &[Dimension]) -> Option<&'static str> {
        let letters = in_letters(symbol);
        let folded = letters.to_lowercase();
        let known = || {
            let of_dimensions = KNOWN
                .iter()
                .filter(|(dimension, _)| dimensions.contains(dimension));
            of_dimensions.flat_map(|(_, spellings)| *spellings).copied()
        };
        let of_prefix = |whole: &&str| {
            let base = whole.strip_prefix(&letters);
            base.is_some_and(|base| known().any(|known| known == base))
        };
        if let Some(whole) = known().find(of_prefix) {
            return Some(whole);
        }
        known()
            .map(|known| {
                // A wrong case alone (`KHz`) is the closest of mistakes.
                let cased = usize::from(*known != letters);
                let distance = strsim::osa_distance(&known.to_lowercase(), &folded);
                (2 * distance + cased, known)
            })
            .min()
            .filter(|(distance, _)| *distance <= letters.chars().count().min(3))
            .map(|(_, symbol)| symbol)
    }
}

/// The usual spellings of all units.
#[cfg(test)]
pub(super) fn usual_spellings() -> impl Iterator<Item = &'static str> {
    let all = KNOWN.iter().flat_map(|(_, spellings)| *spellings);
    all.copied()
}

#[cfg(test)]
mod tests;
