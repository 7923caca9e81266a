//! Real numbers as words: coefficients with their shift, limits with their unit.
//!
//! Documentation gives every number in physical units and in units of its word: a word of current
//! is g 2^-f_i ampere and a word of voltage w 2^-f_v volt, with g ampere per ADC count, w volt per
//! timer count at the nominal bus, f_i and f_v the fraction bits of currents and voltages.

use super::Lowering;
use crate::diagnostics::{engineering, significant};
use crate::interface::Rounding;
use crate::ir::{Coefficient, Exact, Expr, Real};
use std::f64::consts::TAU;

/// Added before a real constant is rounded: far above the f64 error of its computation, so that an
/// exact tie (or whole number) rounds the same in any order of operations.
const GUARD: f64 = 1.0 / 65536.0;

/// R(x) of the semantics pages: to the nearest whole number, ties up.
pub fn round_half_up(x: f64) -> f64 {
    (x + 0.5 + GUARD).floor()
}

/// The greatest whole number not above `x`.
pub fn round_down(x: f64) -> f64 {
    (x + GUARD).floor()
}

/// A real coefficient as a word of `word` bits and the largest shift up to `word` at which it fits;
/// `None` where it does not fit even without fraction bits.
fn round_coefficient(value: f64, word: u32) -> Option<(i32, u32)> {
    let limit = f64::from(word - 1).exp2() - 1.0;
    let rounded = |shift: u32| round_half_up(value * f64::from(shift).exp2());
    let shift = (0..=word)
        .rev()
        .find(|&shift| rounded(shift).abs() <= limit)?;
    Some((rounded(shift) as i32, shift))
}

/// The greatest magnitude of the rounded coefficient's product with signals within +-`signal`.
pub fn product_bound(value: f64, word: u32, signal: i64) -> i64 {
    let Some((raw, shift)) = round_coefficient(value, word) else {
        return 0;
    };
    let half = if shift == 0 { 0 } else { 1_i128 << (shift - 1) };
    let product = |signal: i64| (i128::from(raw) * i128::from(signal) + half) >> shift;
    product(signal).abs().max(product(-signal).abs()) as i64
}

impl<'b> Lowering<'b> {
    /// Rounds `value`, a number without unit, to a coefficient of at most `word` bits and a shift
    /// of at most `word`. `physical` is its text: "1 - a = 0.0302".
    ///
    /// With a 32-bit word a shift above 32 gains nothing: the coefficient's half ulp times a
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

    /// As [`Self::coefficient`], for a quantity with a unit: `physical` is its text in SI units, "K
    /// = 4.468 V/A"; `formula` and `unit` are those of `value`.
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

    /// A coefficient from angles per control period to voltages: `per_speed` in volt per electrical rad/s.
    pub fn voltage_by_turn(&self, name: &'static str, per_speed: f64, doc: &str) -> Coefficient {
        let per_angle = per_speed * TAU / 32_f64.exp2() / self.spec.inverter.t_s;
        self.scaled_coefficient(
            name,
            per_angle * self.scale.voltage(),
            32,
            [doc, &format!("{} per rad/s", engineering(per_speed, "V"))],
            ["2 pi/(2^32 Ts) g 2^f_v", "words of voltage per angle"],
        )
    }

    /// A coefficient from currents to voltages: `ohm` in V/A, shown in `unit` as `symbol`.
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
        // The product with a power of two is exact: it is the number that the coefficient stands
        // for.
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

    /// A coefficient's rounded product with a constant word.
    pub fn rounded_product(&self, coefficient: Coefficient, word: i64) -> i64 {
        let raw = self.b.constant_value(coefficient.id);
        let product = i128::from(raw) * i128::from(word);
        match coefficient.shift {
            0 => product as i64,
            shift => ((product + (1 << (shift - 1))) >> shift) as i64,
        }
    }

    /// A named current, rounded to a word; its value in ampere is appended to `doc`.
    pub fn current(&self, name: &str, raw: i64, doc: &str) -> Expr<'b> {
        let ampere = engineering(raw as f64 / self.scale.current(), "A");
        let doc = format!("{doc}: {ampere}, words of current.");
        self.rounded_number(name, raw, Exact::Within(1), &doc)
    }

    /// A named voltage, rounded to a word; its value in volt is appended to `doc`.
    pub fn voltage(&self, name: &str, raw: i64, doc: &str) -> Expr<'b> {
        let volt = engineering(raw as f64 / self.scale.voltage(), "V");
        let doc = format!("{doc}: {volt}, words of voltage.");
        self.rounded_number(name, raw, Exact::Within(1), &doc)
    }

    /// A named integer constant that is exact.
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
