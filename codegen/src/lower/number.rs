//! Real numbers into words: coefficients with their shift.

use super::Lowering;
use crate::interface::Rounding;
use crate::ir::{ConstantId, Value};

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
        let limit = f64::from(word - 1).exp2() - 1.0;
        let rounded = |shift: u32| (value * f64::from(shift).exp2() + 0.5).floor();
        let shift = (0..=word)
            .rev()
            .find(|&shift| rounded(shift).abs() <= limit);
        if shift.is_none() {
            self.misfits.push(name.to_owned());
        }
        let shift = shift.unwrap_or(0);
        let raw = rounded(shift).clamp(-limit, limit);
        let error = raw / f64::from(shift).exp2() / value - 1.0;
        let lines = [
            doc.to_owned(),
            String::new(),
            format!("{physical}; `i{word}`, {shift} fraction bits, relative error {error:.1e}."),
        ];
        let id = self.b.program.constant(name, raw as i32, &lines);
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

    /// A named integer constant.
    pub fn number(&mut self, name: &str, raw: i64, doc: &str) -> Value {
        let id = self.b.program.constant(name, raw as i32, &[doc.to_owned()]);
        if i64::from(raw as i32) != raw && !self.misfits.iter().any(|known| known == name) {
            self.misfits.push(name.to_owned());
        }
        self.b.constant(id)
    }
}
