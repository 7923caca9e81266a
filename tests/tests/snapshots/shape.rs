//! Lines of emitted texts without the differences between motors.

/// A unit's name and the shape of one of its lines.
pub type Shape = (String, String);

/// Units that call the stages.
const CALLERS: [&str; 2] = ["step", "track"];

/// The shape of a unit's line: masked, and of calls of stages without the arguments. These are what
/// the stage's own lines read; a head has them, too. Of C how operators are spelt: both languages
/// print one plan, and Rust's lines have the names.
pub fn shape_in(kind: &str, unit: &str, line: &str) -> String {
    let shape = shape(line.trim());
    let shape = if CALLERS.contains(&unit) {
        without_arguments(&shape)
    } else {
        shape
    };
    // Texts and comments.
    let has_words = shape.contains('"') || shape.contains("/*");
    if kind == "c99" && !has_words {
        without_names(&shape)
    } else {
        shape
    }
}

/// A line of C whose values are all called `x`.
fn without_names(line: &str) -> String {
    const WORDS: [&str; 9] = [
        "const", "static", "return", "if", "else", "bool", "true", "false", "void",
    ];
    let is_part = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '#');
    let (mut shape, mut rest) = (String::new(), line);
    while !rest.is_empty() {
        let end = rest.find(|letter| !is_part(letter)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        let is_name = word.starts_with(|first: char| first.is_ascii_lowercase())
            && !word.starts_with("hexagen_")
            && !word.ends_with("_t")
            && !WORDS.contains(&word);
        shape += if is_name { "x" } else { word };
        let other = after.chars().next().map_or(0, char::len_utf8);
        shape += &after[..other];
        rest = &after[other..];
    }
    shape
}

/// A statement whose calls of stages have no arguments.
fn without_arguments(statement: &str) -> String {
    let (mut shape, mut rest) = (String::new(), statement);
    while let Some(open) = rest.find('(') {
        let (before, call) = rest.split_at(open);
        shape += before;
        let length = if is_stage(shape.rsplit(' ').next().unwrap_or_default()) {
            call_length(call)
        } else {
            None
        };
        shape += if length.is_some() { "(..)" } else { "(" };
        rest = &call[length.unwrap_or(1)..];
    }
    shape + rest
}

/// Whether a word before a bracket names a stage: no method, type or operator.
fn is_stage(word: &str) -> bool {
    let operators = ["row", "lookup", "select", "divide", "divide_narrow"];
    let families = ["hexagen_", "mul_"];
    word.starts_with(|first: char| first.is_ascii_lowercase())
        && word
            .chars()
            .all(|letter| letter.is_ascii_lowercase() || letter == '_')
        && !operators.contains(&word)
        && !families.iter().any(|family| word.starts_with(family))
}

/// Length of a bracket, if it is closed.
fn call_length(call: &str) -> Option<usize> {
    let mut open = 0;
    let end = call.char_indices().find(|(_, sign)| {
        open += i32::from(*sign == '(') - i32::from(*sign == ')');
        open == 0
    });
    end.map(|(end, _)| end + 1)
}

/// A line with its numbers masked: of a quantity the prefix of its unit, too, fixed-point types,
/// names of vectors, and the width of a product. The bus voltage, a constant or a word, is a word.
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
    // How many numbers stand in a line of a table is its layout's.
    while !shape.contains('(') && shape.contains("#, #, ") {
        shape = shape.replace("#, #, ", "#, ");
    }
    // A product is narrow where the numbers are small.
    shape.replace("V_BUS", "v_bus").replace("_narrow(", "(")
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
    use super::{shape, shape_in};

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
            ("0, 5, 3, 4,", "#, #,"),
            ("mul_round_narrow(K_R, i_a, 16)", "mul_round(K_R, i_a, #)"),
        ] {
            assert_eq!(shape(line), expected);
        }
    }

    #[test]
    fn a_call_of_a_stage_is_its_name() {
        for (line, expected) in [
            (
                "let [a, b] = model_emf(theta, [c, d]);",
                "let [a, b] = model_emf(..);",
            ),
            (
                "begins ? follow(i_a, -(i_b)) : left",
                "begins ? follow(..) : left",
            ),
            (
                "let j = set_point.current();",
                "let j = set_point.current();",
            ),
            ("row(&ROWS, vector).legs", "row(&ROWS, vector).legs"),
            ("limit( state, [u] ) } else {", "limit(..) } else {"),
        ] {
            assert_eq!(shape_in("rust", "step", line), expected);
            assert_eq!(shape_in("rust", "model_emf", line), line);
        }
    }

    #[test]
    fn values_of_c_are_nameless() {
        for (line, expected) in [
            (
                "const int32_t a = hexagen_min(b, V_BUS);",
                "const int32_t x = hexagen_min(x, x);",
            ),
            ("*u_out = c ? e_a : 0;", "*x = x ? x : #;"),
        ] {
            assert_eq!(shape_in("c99", "fold", line), expected);
        }
    }
}
