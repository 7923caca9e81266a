//! Lines of emitted texts without the differences between motors.

/// A unit's name and the shape of one of its lines.
pub type Shape = (String, String);

/// A line with its numbers masked: of a quantity the prefix of its unit, too, fixed-point types,
/// and names of vectors. The bus voltage, a constant or a word, is a word.
pub fn shape(line: &str) -> String {
    let mut shape = String::new();
    let mut rest = line;
    while let Some(first) = rest.chars().next() {
        let in_word = shape.ends_with(char::is_alphanumeric);
        let length = match number(rest) {
            _ if in_word => 0,
            0 => numbered_name(rest),
            length => length,
        };
        if length > 0 {
            shape.push('#');
            let (blank, after) = without_prefix(&rest[length..]);
            shape.push_str(blank);
            rest = after;
        } else {
            shape.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    shape.replace("V_BUS", "v_bus")
}

/// Length of the number at the beginning of a text: `-1_405.5e-3`.
fn number(text: &str) -> usize {
    let after_sign = text.strip_prefix('-').unwrap_or(text);
    if !after_sign.starts_with(|digit: char| digit.is_ascii_digit()) {
        return 0;
    }
    let is_part = |(place, part): (usize, char)| {
        let before = after_sign[..place].chars().last();
        let digit_follows = after_sign[place + part.len_utf8()..]
            .starts_with(|next: char| next.is_ascii_digit() || part == 'e' && next == '-');
        part.is_ascii_digit()
            || matches!(part, '_' | '.' | 'e') && digit_follows
            || part == '-' && before == Some('e') && digit_follows
    };
    let end = after_sign.char_indices().find(|&place| !is_part(place));
    let length = end.map_or(after_sign.len(), |(place, _)| place);
    length + text.len() - after_sign.len()
}

/// The text after a number, without the prefix of its unit: a blank and `A` for ` mA`.
fn without_prefix(text: &str) -> (&str, &str) {
    let units = ["ohm", "A", "V", "H", "Hz", "W", "s", "rad", "Nm"];
    let word = text.strip_prefix(' ').unwrap_or_default();
    let unit = word.strip_prefix(['n', 'u', 'm', 'k', 'M']);
    let is_unit = |text: &str| {
        let end = text.find(|letter: char| !letter.is_alphabetic());
        units.contains(&&text[..end.unwrap_or(text.len())])
    };
    let unit = unit.filter(|unit| is_unit(unit));
    unit.map_or(("", text), |unit| (" ", unit))
}

/// Length of the fixed-point type (`I7F25`) or the vector's name (`V12`) at the beginning of a
/// text.
fn numbered_name(text: &str) -> usize {
    let digits = |text: &str| text.chars().take_while(char::is_ascii_digit).count();
    if let Some(rest) = text.strip_prefix('I') {
        let whole = digits(rest);
        let fraction = rest[whole..].strip_prefix('F').map_or(0, digits);
        usize::from(whole * fraction > 0) * (2 + whole + fraction)
    } else {
        let digits = text.strip_prefix('V').map_or(0, digits);
        usize::from(digits > 0) * (1 + digits)
    }
}

#[cfg(test)]
mod tests {
    use super::shape;

    #[test]
    fn numbers_are_masked_and_words_are_not() {
        for (line, expected) in [
            ("K_R: Word = Word(-53_084_160);", "K_R: Word = Word(#);"),
            ("at most 4.952e-6 V, 135 mohm", "at most # V, # ohm"),
            (
                "score_12 = i32::from(v_a[3])",
                "score_# = i32::from(v_a[#])",
            ),
            ("GAIN: I1F31 of V12", "GAIN: # of #"),
            ("a - 1 < 2..3", "a - # < #..#"),
        ] {
            assert_eq!(shape(line), expected);
        }
    }
}
