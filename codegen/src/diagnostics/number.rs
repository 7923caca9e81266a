//! Numbers as people read them: four significant digits, engineering prefixes.

/// `value` with four significant digits (all digits of larger whole numbers) and no trailing zeros.
pub fn significant(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = exponent(value);
    if (-3..9).contains(&exponent) {
        let decimals = usize::try_from(3 - exponent).unwrap_or(0);
        trim_zeros(&format!("{value:.decimals$}"))
    } else {
        let scientific = format!("{value:.3e}");
        let mantissa = scientific.split('e').next().unwrap_or_default();
        format!("{}e{exponent}", trim_zeros(mantissa))
    }
}

/// Decimal exponent of `value` rounded to four significant digits.
fn exponent(value: f64) -> i32 {
    let scientific = format!("{value:.3e}");
    let exponent = scientific.rsplit('e').next();
    exponent.and_then(|text| text.parse().ok()).unwrap_or(0)
}

fn trim_zeros(text: &str) -> String {
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text.to_owned()
    }
}

/// `value` in `unit` with the prefix that leaves one to three digits before the point,
/// e.g. `engineering(0.135, "ohm")` is `135 mohm`. A number without unit takes no prefix.
pub fn engineering(value: f64, unit: &str) -> String {
    const PREFIXES: [(i32, &str); 8] = [
        (-12, "p"),
        (-9, "n"),
        (-6, "u"),
        (-3, "m"),
        (0, ""),
        (3, "k"),
        (6, "M"),
        (9, "G"),
    ];
    if unit.is_empty() {
        return significant(value);
    }
    if value == 0.0 || !value.is_finite() {
        return format!("{value} {unit}");
    }
    let step = (exponent(value).div_euclid(3) * 3).clamp(-12, 9);
    let prefix = PREFIXES
        .iter()
        .find(|(power, _)| *power == step)
        .map_or("", |(_, prefix)| prefix);
    format!("{} {prefix}{unit}", significant(value / 10f64.powi(step)))
}

/// A frequency with nine digits, exact enough for a timer.
pub fn frequency(hertz: f64) -> String {
    let (scale, unit) = match hertz {
        f if f >= 1e9 => (1e9, "GHz"),
        f if f >= 1e6 => (1e6, "MHz"),
        f if f >= 1e3 => (1e3, "kHz"),
        _ => (1.0, "Hz"),
    };
    let scaled = hertz / scale;
    let digits = 8 - scaled.log10().floor().clamp(0.0, 8.0) as usize;
    format!("{} {unit}", trim_zeros(&format!("{scaled:.digits$}")))
}

/// An upper limit for a message: rounded down to four digits, so that it is accepted when typed in.
pub fn at_most(limit: f64) -> f64 {
    to_four_digits(limit, f64::floor)
}

/// A lower limit for a message: rounded up to four digits, so that it is accepted when typed in.
pub fn at_least(limit: f64) -> f64 {
    to_four_digits(limit, f64::ceil)
}

fn to_four_digits(limit: f64, round: fn(f64) -> f64) -> f64 {
    if limit == 0.0 || !limit.is_finite() {
        return limit;
    }
    let exponent = 3 - limit.abs().log10().floor() as i32;
    let scaled = limit * 10_f64.powi(exponent);
    // A limit of four decimal digits stays itself, whatever its binary rounding.
    let whole = if (scaled - scaled.round()).abs() <= 1e-6 {
        scaled.round()
    } else {
        round(scaled)
    };
    whole / 10_f64.powi(exponent)
}

/// An upper speed limit, rad/s, in revolutions per minute, rounded down.
pub fn rpm_at_most(omega: f64) -> String {
    format!("{} rpm", significant(at_most(in_rpm(omega))))
}

/// A lower speed limit, rad/s, in revolutions per minute, rounded up.
pub fn rpm_at_least(omega: f64) -> String {
    format!("{} rpm", significant(at_least(in_rpm(omega))))
}

fn in_rpm(omega: f64) -> f64 {
    omega * 30.0 / std::f64::consts::PI
}

/// A ratio in percent, e.g. `30 %`.
pub fn percent(ratio: f64) -> String {
    format!("{} %", significant(100.0 * ratio))
}

/// An angular speed, rad/s, in revolutions per minute.
pub fn rpm(omega: f64) -> String {
    format!("{} rpm", significant(in_rpm(omega)))
}

/// Words in backticks: `` `a`, `b` or `c` ``.
pub fn list<S: AsRef<str>>(words: &[S], last: &str) -> String {
    let quoted: Vec<String> = words
        .iter()
        .map(|word| format!("`{}`", word.as_ref()))
        .collect();
    enumerated(&quoted, last)
}

/// Clauses: `a, b or c`.
pub fn enumerated(clauses: &[String], last: &str) -> String {
    match clauses {
        [] => String::new(),
        [only] => only.clone(),
        [head @ .., tail] => format!("{} {last} {tail}", head.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::{
        at_least, at_most, engineering, frequency, list, percent, rpm, rpm_at_most, significant,
    };

    #[test]
    fn four_significant_digits() {
        for (value, text) in [
            (0.0, "0"),
            (34.515_6, "34.52"),
            (1800.0, "1800"),
            (71_999.9, "72000"),
            (65_535.0, "65535"),
            (0.044_31, "0.04431"),
            (-2.5, "-2.5"),
            (1.234_56e-7, "1.235e-7"),
            (999.96, "1000"),
        ] {
            assert_eq!(significant(value), text);
        }
    }

    #[test]
    fn engineering_prefixes() {
        for (value, unit, text) in [
            (0.135, "ohm", "135 mohm"),
            (0.00022, "H", "220 uH"),
            (999.97e-6, "s", "1 ms"),
            (20_000.0, "Hz", "20 kHz"),
            (48.0, "V", "48 V"),
            (1e-13, "F", "0.1 pF"),
            (0.969_784_1, "", "0.9698"),
        ] {
            assert_eq!(engineering(value, unit), text);
        }
    }

    #[test]
    fn limits_are_rounded_to_the_accepted_side() {
        for (limit, most, least) in [
            (123_456.0, 123_400.0, 123_500.0),
            (0.010_016_5, 0.010_01, 0.010_02),
            (49_999.999_999_99, 50_000.0, 50_000.0),
            (50_000.000_000_01, 50_000.0, 50_000.0),
            (-1.000_6, -1.001, -1.0),
            (0.0, 0.0, 0.0),
        ] {
            assert_eq!((at_most(limit), at_least(limit)), (most, least));
        }
        assert_eq!(rpm_at_most(209.5), "2000 rpm");
        assert_eq!(rpm(209.5), "2001 rpm");
    }

    #[test]
    fn frequencies_are_exact() {
        assert_eq!(frequency(20e3), "20 kHz");
        assert_eq!(frequency(170e6 / 5666.0), "30.0035298 kHz");
        assert_eq!(frequency(100.0), "100 Hz");
    }

    #[test]
    fn ratios_speeds_and_lists() {
        assert_eq!(percent(0.3), "30 %");
        assert_eq!(rpm(209.439_510_239), "2000 rpm");
        assert_eq!(list(&["a", "b", "c"], "or"), "`a`, `b` or `c`");
        assert_eq!(list(&["a"], "or"), "`a`");
    }
}
