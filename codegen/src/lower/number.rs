//! Real numbers into words: coefficients with their shift.

use super::Lowering;
use crate::interface::Rounding;
use crate::ir::{ConstantId, Value};

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

/// A coefficient: a constant and the shift of the products with it.
#[derive(Clone, Copy, Debug)]
pub struct Coefficient {
    /// The constant.
    pub id: ConstantId,
    /// Shift of `mul`.
    pub shift: u32,
}

impl Lowering<'_> {
    /// Rounds `value` (words per word) to a coefficient of at most `word` bits and a shift of at most `word`.
    ///
    /// With a 32-bit word a shift of 32 is as good as any larger one: the coefficient's half ulp times a
    /// full-scale signal is a quarter ulp of the product. `physical` says the value in SI units.
    pub fn coefficient(
        &mut self,
        name: &'static str,
        value: f64,
        word: u32,
        doc: &str,
        physical: &str,
    ) -> Coefficient {
        let rounded = round_coefficient(value, word);
        if rounded.is_none() {
            self.misfits.push(name.to_owned());
        }
        let (raw, shift) = rounded.unwrap_or((0, 0));
        let error = f64::from(raw) / f64::from(shift).exp2() / value - 1.0;
        let lines = [
            doc.to_owned(),
            String::new(),
            format!("{physical}; `i{word}`, {shift} fraction bits, relative error {error:.1e}."),
        ];
        let id = self.b.program.constant(name, raw, &lines);
        self.format(
            name,
            word,
            shift as i32,
            Rounding::RoundHalfUp,
            &format!("{physical}; product rounded at this shift"),
        );
        Coefficient { id, shift }
    }

    /// `mul(coefficient, signal)`.
    pub fn times(&mut self, coefficient: Coefficient, signal: Value) -> Value {
        let constant = self.b.constant(coefficient.id);
        self.b.mul(constant, signal, coefficient.shift)
    }

    /// `mul(coefficient, word)` for a word that is known beforehand.
    pub fn rounded_product(&self, coefficient: Coefficient, word: i64) -> i64 {
        let raw = self.b.program.constants[coefficient.id.index()].raw;
        let product = i128::from(raw) * i128::from(word);
        match coefficient.shift {
            0 => product as i64,
            shift => ((product + (1 << (shift - 1))) >> shift) as i64,
        }
    }

    /// A named integer constant.
    pub fn number(&mut self, name: &str, raw: i64, doc: &str) -> Value {
        let id = self.b.program.constant(name, raw as i32, &[doc.to_owned()]);
        if i64::from(raw as i32) != raw && !self.misfits.iter().any(|known| known == name) {
            self.misfits.push(name.to_owned());
        }
        self.b.constant(id)
    }
}
