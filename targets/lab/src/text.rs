//! Numbers and diagnostics as text.

use hexagen_codegen::diagnostics::engineering;

/// A diagnostic, or a note of it, without the file, variant or argument and the place in it.
pub fn without_place(diagnostic: &str) -> &str {
    let starts = ["error[", "note: "];
    let start = starts.iter().find_map(|start| diagnostic.find(start));
    &diagnostic[start.unwrap_or_default()..]
}

/// A number with this many significant digits, without exponent where that is readable; a dash for
/// `None`.
pub fn significant(value: impl Into<Option<f64>>, digits: u32) -> String {
    let Some(value) = value.into() else {
        return "-".to_owned();
    };
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if exponent < -5 {
        return format!("{value:.*e}", digits.saturating_sub(1) as usize);
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{value:.decimals$}")
}

/// A quantity in print: engineering prefix, ohm and micro as letters.
pub fn quantity(value: f64, unit: &str) -> String {
    let text = engineering(value, unit);
    let Some((number, unit)) = text.split_once(' ') else {
        return text;
    };
    let unit = unit.replace("ohm", "\u{3a9}");
    let unit = unit
        .strip_prefix('u')
        .map_or(unit.clone(), |rest| format!("\u{b5}{rest}"));
    format!("{}\u{a0}{unit}", number.replace('-', "\u{2212}"))
}

/// A demand over what the drive allows from which on it is told as beyond.
pub const BEYOND: f64 = 1.001;

/// A demanded torque with the limit of the set-point where that is lower: `5 Nm, limited to 3.6 Nm,`. Both in newton
/// metres; `shown`: how a torque is printed.
pub fn demanded(torque: f64, reach: f64, shown: impl Fn(f64) -> String) -> String {
    if torque.abs() > reach * BEYOND {
        format!(
            "{}, limited to {},",
            shown(torque),
            shown(reach.copysign(torque))
        )
    } else {
        shown(torque)
    }
}

/// A number with fixed decimals and a true minus sign; a dash for `None`.
pub fn number(value: impl Into<Option<f64>>, decimals: usize) -> String {
    match value.into().filter(|value: &f64| value.is_finite()) {
        Some(value) => format!("{value:.decimals$}").replace('-', "\u{2212}"),
        None => "\u{2013}".to_owned(),
    }
}

/// A percentage of ripple: two decimals below 1, one below 100.
pub fn ripple(value: impl Into<Option<f64>>) -> String {
    let value = value.into();
    // The rounded value decides.
    let decimals = match value.map_or(0.0, f64::abs) {
        x if x < 0.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    number(value, decimals)
}

/// A count with thin spaces between thousands.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// Unit of torque for a demand.
#[derive(Clone, Copy, Debug)]
pub struct TorqueScale {
    /// Name of the unit.
    pub unit: &'static str,
    /// Units per newton metre.
    pub per_nm: f64,
    /// Decimals that show three digits of the demand.
    pub decimals: usize,
}

impl TorqueScale {
    /// Millinewton metres for demands below 0.1 Nm.
    pub fn of(demand: f64) -> Self {
        let (unit, per_nm) = if demand.abs() < 0.1 {
            ("mNm", 1e3)
        } else {
            ("Nm", 1.0)
        };
        let exponent = (demand.abs() * per_nm).log10().floor();
        let decimals = if exponent.is_finite() {
            (2.0 - exponent).clamp(0.0, 6.0) as usize
        } else {
            2
        };
        Self {
            unit,
            per_nm,
            decimals,
        }
    }

    /// A torque in newton metres, with this many more decimals.
    pub fn text(&self, torque: impl Into<Option<f64>>, more: usize) -> String {
        let torque = torque.into().map(|torque: f64| self.per_nm * torque);
        number(torque, self.decimals + more)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits() {
        assert_eq!(significant(1234.56, 3), "1235");
        assert_eq!(significant(0.012_345, 3), "0.0123");
        assert_eq!(significant(1.2e-9, 2), "1.2e-9");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(None, 3), "-");
    }

    #[test]
    fn quantities_and_numbers_have_typographic_signs() {
        assert_eq!(quantity(0.135, "ohm"), "135\u{a0}m\u{3a9}");
        assert_eq!(quantity(22e-5, "H"), "220\u{a0}\u{b5}H");
        assert_eq!(quantity(-0.5, "A"), "\u{2212}500\u{a0}mA");
        assert_eq!(number(None, 2), "\u{2013}");
        for (value, text) in [
            (0.128, "0.13"),
            (0.997, "1.0"),
            (12.72, "12.7"),
            (106.2, "106"),
        ] {
            assert_eq!(ripple(value), text);
        }
    }
}
