//! Reads a product of units.

use super::names::{NAMES, prefix};
use super::quantities::Powers;
use crate::spec::basis::Basis;

/// A product of units as far as it was read.
#[derive(Clone, Debug)]
pub(super) struct Product {
    /// As it is spelt.
    pub symbol: String,
    /// What it measures.
    pub powers: Powers,
    /// Numerator of the factor to the SI.
    pub times: f64,
    /// Its denominator.
    pub over: f64,
    /// What a name says of the amplitude: `Arms`.
    pub basis: Option<Basis>,
}

impl Product {
    const ONE: Self = Self {
        symbol: String::new(),
        powers: [0; _],
        times: 1.0,
        over: 1.0,
        basis: None,
    };

    /// `weighs`: whether masses are weights.
    pub fn parse(symbol: &str, weighs: bool) -> Option<Self> {
        let letters = in_letters(symbol);
        let mut reader = Reader {
            rest: letters.trim(),
            weighs,
        };
        let product = reader.product(false)?;
        reader.rest.is_empty().then_some(product)
    }

    fn of_number(digits: &str, divides: bool) -> Option<Self> {
        // Below a line any whole number, as of a trace at 200 rpm; else `1 500 rpm` would be 500 rpm.
        let is_round = digits.starts_with('1') && digits[1..].bytes().all(|digit| digit == b'0');
        let times: f64 = digits
            .parse()
            .ok()
            .filter(|_| (is_round || divides) && !digits.starts_with('0') && digits.len() <= 7)?;
        Some(Self {
            symbol: digits.to_owned(),
            times,
            ..Self::ONE
        })
    }

    /// The product of both, or the quotient; none where their bases differ.
    fn combined(mut self, other: &Self, sign: i8) -> Option<Self> {
        for (power, more) in self.powers.iter_mut().zip(other.powers) {
            *power += sign * more;
        }
        let (times, over) = if sign > 0 {
            (other.times, other.over)
        } else {
            (other.over, other.times)
        };
        self.times *= times;
        self.over *= over;
        match (self.basis, other.basis) {
            (Some(one), Some(two)) if one != two => return None,
            (one, two) => self.basis = one.or(two),
        }
        Some(self)
    }

    fn power(&self, power: i8) -> Option<Self> {
        let mut all = Self {
            symbol: self.symbol.clone(),
            ..Self::ONE
        };
        for _ in 0..power.abs() {
            all = all.combined(self, power.signum())?;
        }
        Some(all)
    }
}

struct Reader<'a> {
    rest: &'a str,
    weighs: bool,
}

impl<'a> Reader<'a> {
    fn take(&mut self, sign: char) -> bool {
        let rest = self.rest.trim_start();
        let found = rest.strip_prefix(sign);
        self.rest = found.unwrap_or(self.rest);
        found.is_some()
    }

    fn take_while(&mut self, belongs: impl Fn(char) -> bool) -> Option<&'a str> {
        let rest = self.rest.trim_start();
        let end = rest.find(|c| !belongs(c)).unwrap_or(rest.len());
        let (taken, tail) = rest.split_at(end);
        (end > 0).then(|| {
            self.rest = tail;
            taken
        })
    }

    /// Factors from left to right, up to a closing parenthesis or the end; `divides`: whether another product is
    /// divided by the first of them.
    fn product(&mut self, divides: bool) -> Option<Product> {
        // `4000/min`.
        let mut product = if self.rest.trim_start().starts_with('/') {
            Product::ONE
        } else {
            self.factor(divides)?
        };
        loop {
            let (sign, between) = if self.rest.trim_start().is_empty() || self.next_is(')') {
                return Some(product);
            } else if self.take('/') {
                (-1, "/")
            } else if self.take('-') {
                (1, "-")
            } else {
                // At most one sign of a product; a space is one, too.
                let _ = self.take('*') || self.take('\u{b7}') || self.take('.');
                (1, " ")
            };
            let factor = self.factor(sign < 0)?;
            let symbol = format!("{}{between}{}", product.symbol, factor.symbol);
            product = product.combined(&factor, sign)?;
            product.symbol = symbol;
        }
    }

    fn next_is(&self, sign: char) -> bool {
        self.rest.trim_start().starts_with(sign)
    }

    /// A name with its power, a multiple of one, or a product in parentheses.
    fn factor(&mut self, divides: bool) -> Option<Product> {
        if self.take('(') {
            let mut inner = self.product(divides)?;
            inner.symbol = format!("({})", inner.symbol);
            return self.take(')').then_some(inner);
        }
        if let Some(digits) = self.take_while(|c| c.is_ascii_digit()) {
            let number = Product::of_number(digits, divides)?;
            if self.next_is('/') || self.next_is(')') || self.rest.trim_start().is_empty() {
                return (digits == "1").then_some(number);
            }
            let factor = self.factor(divides)?;
            let symbol = format!("{digits}{}", factor.symbol);
            let product = number.combined(&factor, 1)?;
            return Some(Product { symbol, ..product });
        }
        if self.take('%') {
            return self.named("%", 1);
        }
        let word = self.take_while(|c| c.is_alphanumeric() || c == '_')?;
        let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
        let power = match &word[name.len()..] {
            "" => self.power()?,
            digits => digits.parse().ok()?,
        };
        self.named(name, power)
    }

    /// `^2` or `-1` behind a name.
    fn power(&mut self) -> Option<i8> {
        let caret = self.take('^');
        let rest = self.rest.trim_start();
        let (sign, digits) = match rest.strip_prefix('-').map(str::trim_start) {
            Some(digits) if digits.starts_with(|c: char| c.is_ascii_digit()) => (-1, digits),
            _ if caret => (1, rest),
            _ => return Some(1),
        };
        self.rest = digits;
        let power: i8 = self.take_while(|c| c.is_ascii_digit())?.parse().ok()?;
        (1..=4).contains(&power).then_some(sign * power)
    }

    /// A name to a power, or two names written as one, of which the second has the power: `kgm2`.
    fn named(&self, name: &str, power: i8) -> Option<Product> {
        if !(-4..=4).contains(&power) || power == 0 {
            return None;
        }
        let written = |name: &str| match power {
            1 => name.to_owned(),
            power => format!("{name}{power}"),
        };
        if let Some((product, kept)) = self.single(name) {
            let symbol = written(kept);
            let product = product.power(power)?;
            return Some(Product { symbol, ..product });
        }
        let mut splits = name.char_indices().skip(1).map(|(at, _)| name.split_at(at));
        splits.find_map(|(first, second)| {
            let (one, kept) = self.single(first)?;
            let (two, _) = self.single(second).filter(|(two, _)| two.basis.is_none())?;
            let symbol = format!("{kept}{}", written(second));
            let product = one.combined(&two.power(power)?, 1)?;
            Some(Product { symbol, ..product })
        })
    }

    /// A name with its prefix, and the part of it that is the unit's: `Arms` is an ampere.
    fn single<'b>(&self, name: &'b str) -> Option<(Product, &'b str)> {
        if let Some(product) = self.prefixed(name) {
            return Some((product, name));
        }
        let bases = [
            ("rms", Basis::Rms),
            ("RMS", Basis::Rms),
            ("peak", Basis::Peak),
            ("pkpk", Basis::PeakToPeak),
            ("pp", Basis::PeakToPeak),
            ("pk", Basis::Peak),
        ];
        bases.into_iter().find_map(|(ending, basis)| {
            let kept = name.strip_suffix(ending)?.trim_end_matches('_');
            let amplitude = kept.ends_with(['A', 'V']);
            let product = self.prefixed(kept).filter(|_| amplitude)?;
            let basis = Some(basis);
            Some((Product { basis, ..product }, kept))
        })
    }

    fn prefixed(&self, name: &str) -> Option<Product> {
        NAMES.iter().find_map(|known| {
            let [times, over] = known.spellings.iter().find_map(|spelling| {
                let before = name.strip_suffix(spelling)?;
                let mut letters = before.chars();
                match (letters.next(), letters.next()) {
                    (None, _) => Some([1.0, 1.0]),
                    (Some(letter), None) if known.prefixes.contains(letter) => prefix(letter),
                    _ => None,
                }
            })?;
            // The other meaning of a weight.
            let has_two = NAMES
                .iter()
                .any(|other| other.weighs && other.spellings == known.spellings);
            if has_two && known.weighs != self.weighs {
                return None;
            }
            let mut product = Product {
                times: known.factor[0] * times,
                over: known.factor[1] * over,
                ..Product::ONE
            };
            for (axis, power) in known.powers {
                product.powers[*axis as usize] = *power;
            }
            Some(product)
        })
    }
}

/// The spelling with letters in place of the signs of print, both code points of ohm and micro among
/// them.
pub(in crate::spec) fn in_letters(symbol: &str) -> String {
    let mut letters = String::new();
    for sign in symbol.chars() {
        match sign {
            '\u{3a9}' | '\u{2126}' => letters.push_str("ohm"),
            '\u{b5}' | '\u{3bc}' => letters.push('u'),
            '\u{b0}' => letters.push_str("deg"),
            '\u{b9}' => letters.push('1'),
            '\u{b2}' => letters.push('2'),
            '\u{207b}' | '\u{2212}' | '\u{2010}'..='\u{2013}' => letters.push('-'),
            '\u{22c5}' => letters.push('\u{b7}'),
            letter => letters.push(letter),
        }
    }
    letters
}
