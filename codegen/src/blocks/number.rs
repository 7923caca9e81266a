//! Real numbers into words: coefficients with their shift, limits with their unit.
//!
//! Documentation says every number twice, in the units of physics and in those of its word: with g the
//! ampere of an ADC count, w the volt of a timer count at the nominal bus, f_i and f_v the fraction bits
//! of currents and voltages, a word of current is g 2^-f_i ampere and a word of voltage w 2^-f_v volt.

use super::Lowering;
use crate::diagnostics::{engineering, significant};
use crate::interface::Rounding;
use crate::ir::{Coefficient, Exact, Expr, Real};

/// What is added before a real constant is rounded: far more than the error of its computation in f64, so
/// that an exact tie (or whole number) comes out the same whatever the order of the operations.
const GUARD: f64 = 1.0 / 65536.0;

/// R(x) of the semantics pages: to the nearest whole number, ties up.
pub fn round_half_up(x: f64) -> f64 {
    (x + 0.5 + GUARD).floor()
}

/// The greatest whole number not above `x`.
pub fn round_down(x: f64) -> f64 {
    (x + GUARD).floor()
}

/// A real coefficient as a word of `word` bits and the largest shift up to `word` at which it fits; `None`
/// where it does not fit even without fraction bits.
fn round_coefficient(value: f64, word: u32) -> Option<(i32, u32)> {
    let limit = f64::from(word - 1).exp2() - 1.0;
    let rounded = |shift: u32| round_half_up(value * f64::from(shift).exp2());
    let shift = (0..=word)
        .rev()
        .find(|&shift| rounded(shift).abs() <= limit)?;
    Some((rounded(shift) as i32, shift))
}

/// The greatest magnitude of the product of the rounded coefficient with signals up to `signal` to both sides.
pub fn product_bound(value: f64, word: u32, signal: i64) -> i64 {
    let Some((raw, shift)) = round_coefficient(value, word) else {
        return 0;
    };
    let half = if shift == 0 { 0 } else { 1_i128 << (shift - 1) };
    let product = |signal: i64| (i128::from(raw) * i128::from(signal) + half) >> shift;
    product(signal).abs().max(product(-signal).abs()) as i64
}

impl<'b> Lowering<'b> {
    /// Rounds `value`, a number without unit, to a coefficient of at most `word` bits and a shift of at most
    /// `word`. `physical` says the value: "1 - a = 0.0302".
    ///
    /// With a 32-bit word a shift of 32 is as good as any larger one: the coefficient's half ulp times a
    /// full-scale signal is a quarter ulp of the product.
    pub fn coefficient(
        &self,
        name: &'static str,
        value: f64,
        word: u32,
        doc: &str,
        physical: &str,
    ) -> Coefficient {
        self.rounded(name, value, word, [doc, physical], None)
    }

    /// As [`Self::coefficient`], for a quantity with a unit: `physical` says its value in SI units, "K = 4.468
    /// V/A", and `scaled` by which formula `value` comes of it and what unit that has.
    pub fn scaled_coefficient(
        &self,
        name: &'static str,
        value: f64,
        word: u32,
        [doc, physical]: [&str; 2],
        [formula, unit]: [&str; 2],
    ) -> Coefficient {
        let scaled = format!("{formula} = {} {unit}", significant(value));
        self.rounded(name, value, word, [doc, physical], Some(&scaled))
    }

    /// A coefficient that makes a voltage of a current: `symbol` in V/A, shown in `unit`.
    pub fn impedance(
        &self,
        name: &'static str,
        ohm: f64,
        word: u32,
        doc: &str,
        [symbol, unit]: [&str; 2],
    ) -> Coefficient {
        let coefficient = self.scaled_coefficient(
            name,
            ohm * (self.scale.voltage() / self.scale.current()),
            word,
            [doc, &format!("{symbol} = {}", engineering(ohm, unit))],
            [
                &format!("{symbol} g/w 2^(f_v - f_i)"),
                "words of voltage per word of current",
            ],
        );
        if word == 32 && coefficient.shift < 32 {
            self.notes.borrow_mut().long_products.push(name);
        }
        coefficient
    }

    fn rounded(
        &self,
        name: &'static str,
        value: f64,
        word: u32,
        [doc, physical]: [&str; 2],
        scaled: Option<&str>,
    ) -> Coefficient {
        let rounded = round_coefficient(value, word);
        if rounded.is_none() {
            self.misfit(name);
        }
        let (raw, shift) = rounded.unwrap_or((0, 0));
        let error = f64::from(raw) / f64::from(shift).exp2() / value - 1.0;
        let mut lines = vec![doc.to_owned()];
        let error = if error == 0.0 {
            "exact".to_owned()
        } else {
            format!("relative error {error:.1e}")
        };
        let in_words = scaled.map_or_else(String::new, |_| {
            format!(", {} in words", significant(value))
        });
        lines.push(format!(
            "{physical}{in_words}; {shift} fraction bits, {error}."
        ));
        // Times a power of two, which is exact: the floating-point number is what the coefficient stands for.
        let exact = Exact::Number(Real::of(value * f64::from(shift).exp2()));
        let id = self.b.declare_constant(name, raw, exact, &lines);
        self.format(
            name,
            word,
            shift as i32,
            Rounding::RoundHalfUp,
            &match scaled {
                Some(scaled) => format!("{physical}; {scaled}; product rounded at this shift"),
                None => format!("{physical}; product rounded at this shift"),
            },
        );
        Coefficient { id, shift }
    }

    /// A coefficient's product with a word that is known beforehand.
    pub fn rounded_product(&self, coefficient: Coefficient, word: i64) -> i64 {
        let raw = self.b.constant_value(coefficient.id);
        let product = i128::from(raw) * i128::from(word);
        match coefficient.shift {
            0 => product as i64,
            shift => ((product + (1 << (shift - 1))) >> shift) as i64,
        }
    }

    /// A named current that was rounded to a whole word; `doc` says what it is, its value in ampere follows.
    pub fn current(&self, name: &str, raw: i64, doc: &str) -> Expr<'b> {
        let ampere = engineering(raw as f64 / self.scale.current(), "A");
        let doc = format!("{doc}: {ampere}, words of current.");
        self.rounded_number(name, raw, Exact::Within(1), &doc)
    }

    /// A named voltage that was rounded to a whole word; `doc` says what it is, its value in volt follows.
    pub fn voltage(&self, name: &str, raw: i64, doc: &str) -> Expr<'b> {
        let volt = engineering(raw as f64 / self.scale.voltage(), "V");
        let doc = format!("{doc}: {volt}, words of voltage.");
        self.rounded_number(name, raw, Exact::Within(1), &doc)
    }

    /// A named integer constant; `doc` says what it counts. Currents and voltages have functions of their
    /// own.
    pub fn number(&self, name: &str, raw: i64, doc: &str) -> Expr<'b> {
        self.rounded_number(name, raw, Exact::Itself, doc)
    }

    /// A named integer constant that stands for the real number `exact`.
    pub fn rounded_number(&self, name: &str, raw: i64, exact: Exact, doc: &str) -> Expr<'b> {
        if i64::from(raw as i32) != raw {
            self.misfit(name);
        }
        let id = self
            .b
            .declare_constant(name, raw as i32, exact, &[doc.to_owned()]);
        self.b.read_constant(id)
    }
}
