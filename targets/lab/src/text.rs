//! Numbers as text.

/// A number with so many significant digits, without exponent where that is readable; a dash where
/// there is none.
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

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn digits() {
        assert_eq!(significant(1234.56, 3), "1235");
        assert_eq!(significant(0.012_345, 3), "0.0123");
        assert_eq!(significant(1.2e-9, 2), "1.2e-9");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(None, 3), "-");
    }
}
