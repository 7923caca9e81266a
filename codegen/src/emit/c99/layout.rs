//! Lines of C: wrapping of long statements, and the words in them.

use std::collections::BTreeSet;

/// Longest line.
pub(super) const WIDTH: usize = 100;

/// One level of nesting.
pub(super) const INDENT: &str = "    ";

/// A statement or a function's head in lines of at most [`WIDTH`] letters if possible: broken after
/// commas and parentheses and before operators, at the outermost place that fits.
pub(super) fn wrapped(indent: &str, text: &str) -> String {
    let mut lines = String::new();
    let (mut rest, mut lead) = (text, indent.to_owned());
    while lead.len() + rest.len() > WIDTH {
        let room = [lead.len(), indent.len() + 2 * INDENT.len()];
        let room = room.map(|indent| WIDTH.saturating_sub(indent));
        let Some(at) = break_of(rest, room) else {
            break;
        };
        let (line, tail) = rest.split_at(at);
        lines.push_str(&lead);
        lines.push_str(line.trim_end());
        lines.push('\n');
        rest = tail.trim_start();
        lead = format!("{indent}{INDENT}{INDENT}");
    }
    lines.push_str(&lead);
    lines.push_str(rest);
    lines.push('\n');
    lines
}

/// The last of the outermost places within `width` where a line may end; the next line has room for
/// `next`.
fn break_of(text: &str, [width, next]: [usize; 2]) -> Option<usize> {
    let (mut depth, mut best) = (0_usize, None);
    let letters = text.as_bytes();
    let mut offer = |cost: usize, at: usize| {
        if best.is_none_or(|(least, _)| cost <= least) {
            best = Some((cost, at));
        }
    };
    for (at, &letter) in letters.iter().enumerate().take(width + 1) {
        match letter {
            b'(' => {
                depth += 1;
                let is_call = at > 0 && letters[at - 1].is_ascii_alphanumeric();
                if is_call && at < width && letters.get(at + 1) != Some(&b')') {
                    offer(3 * depth + 1, at + 1);
                }
            }
            b'{' | b'[' => depth += 1,
            b')' | b'}' | b']' => depth = depth.saturating_sub(1),
            b' ' if at > 0 => {
                let behind = &text[at + 1..];
                if letters[at - 1] == b'=' && depth == 0 {
                    // Prefer a break before a nested group to one inside of it.
                    offer(if behind.len() <= next { 2 } else { 5 }, at);
                } else if let Some(looseness) = looseness(letters[at - 1], behind) {
                    offer(3 * depth + looseness, at);
                }
            }
            _ => {}
        }
    }
    best.map(|(_, at)| at)
}

/// Cost of a line break between a letter and what follows, relative to a comma; none if a line may
/// not be broken there.
fn looseness(before: u8, behind: &str) -> Option<usize> {
    let begins = |operators: &[&str]| {
        operators
            .iter()
            .any(|operator| behind.starts_with(operator))
    };
    if before == b',' || begins(&["&& ", "|| ", ": ", "+ ", "- ", "* "]) {
        Some(0)
    } else if begins(&["? ", "== ", "!= ", "< ", "> ", "<= ", ">= "]) {
        Some(1)
    } else {
        None
    }
}

/// The words of code, comments left out.
pub(super) fn words(code: &str) -> BTreeSet<String> {
    let mut words = BTreeSet::new();
    let mut rest = code;
    while let Some((before, behind)) = rest.split_once("/*") {
        collect(before, &mut words);
        rest = behind.split_once("*/").map_or("", |(_, behind)| behind);
    }
    collect(rest, &mut words);
    words
}

fn collect(code: &str, words: &mut BTreeSet<String>) {
    let is_part = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let parts = code.split(|letter| !is_part(letter));
    words.extend(parts.filter(|part| !part.is_empty()).map(str::to_owned));
}

#[cfg(test)]
mod tests {
    use super::{WIDTH, words, wrapped};

    #[test]
    fn long_statements_break_at_the_outermost_place() {
        let part = "mul_round(K_LONG_NAME, signal_of_the_phase, 32)";
        let text = format!("const int32_t sum = {part} + {part} - {part};");
        let lines = wrapped("    ", &text);
        assert_eq!(
            lines,
            format!(
                "    const int32_t sum = {part}\n            + {part}\n            - {part};\n"
            )
        );
        assert!(lines.lines().all(|line| line.len() <= WIDTH));
    }

    #[test]
    fn words_of_comments_do_not_count() {
        let found: Vec<String> = words("a = /* b */ C_1(d); /* e */").into_iter().collect();
        assert_eq!(found, ["C_1", "a", "d"]);
    }
}
