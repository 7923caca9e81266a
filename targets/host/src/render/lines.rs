//! Texts in lines of at most 100 columns, and in few of them.

/// Most columns of a line.
pub const COLUMNS: usize = 100;

/// A row in lines of at most 100 columns, the further ones below its text.
pub fn wrapped_row(row: &str) -> String {
    filled(row, "            ")
}

/// A paragraph in such lines.
pub fn paragraph(text: &str) -> String {
    filled(text, "")
}

/// A verdict and its rows in lines of at most 100 columns. Where they are more than `most`, the first rows keep the
/// clauses that fit into one line, and the verdict those that fit into two; `rest` says where the others stand.
pub fn verdict_lines(head: &str, rows: &[(&str, String)], most: usize, rest: &str) -> Vec<String> {
    let row = |(title, text): &(&str, String)| format!("{title:<12}{text}");
    let whole: Vec<String> = std::iter::once(head.to_owned())
        .chain(rows.iter().map(row))
        .map(|line| wrapped_row(&line))
        .collect();
    let lines: usize = whole.iter().map(|row| row.lines().count()).sum();
    if lines <= most {
        return whole;
    }
    let mut lines: Vec<String> = std::iter::once(short_verdict(head, rest))
        .chain(rows.iter().map(|line| short_row(&row(line))))
        .collect();
    let of = |row: &str| row.lines().count();
    let mut count: usize = lines.iter().map(|row| of(row)).sum();
    for (short, whole) in lines.iter_mut().zip(whole).skip(1).rev() {
        let with_whole = count + of(&whole) - of(short);
        if with_whole <= most {
            (*short, count) = (whole, with_whole);
        }
    }
    lines
}

/// Between the clauses of a row.
const CLAUSES: &str = "; ";

/// Behind a row of which clauses are left out.
const MORE: &str = " …";

/// The first clause of a row, and those behind it for which its line has room.
fn short_row(row: &str) -> String {
    let columns = |text: &str| text.chars().count();
    let most = COLUMNS - columns(MORE);
    let mut clauses = row.split(CLAUSES);
    let mut line = within_a_line(clauses.next().unwrap_or_default());
    let mut left_out = 0;
    for clause in clauses {
        if columns(&line) + columns(CLAUSES) + columns(clause) <= most {
            line = [&line, clause].join(CLAUSES);
        } else {
            left_out += 1;
        }
    }
    if left_out > 0 && !line.ends_with(MORE) {
        line.push_str(MORE);
    }
    wrapped_row(&line)
}

/// A clause; of the options of a controller, which have commas, those that a line holds. A path or a command stays whole.
fn within_a_line(clause: &str) -> String {
    let most = COLUMNS - MORE.chars().count();
    let Some((end, _)) = clause.char_indices().nth(most) else {
        return clause.to_owned();
    };
    match clause[..end].rfind(',') {
        Some(kept) => format!("{}{MORE}", &clause[..kept]),
        None => clause.to_owned(),
    }
}

/// As many clauses of a verdict as fit into two lines, and how many more there are.
fn short_verdict(head: &str, rest: &str) -> String {
    let clauses: Vec<&str> = head.split(CLAUSES).collect();
    let with = |kept: usize| {
        let more = clauses.len() - kept;
        let text = clauses[..kept].join(CLAUSES);
        wrapped_row(&match more {
            0 => text,
            more => format!("{text}{CLAUSES}{more} more {rest}"),
        })
    };
    let fitting = (1..=clauses.len()).rev().map(with);
    let mut fitting = fitting.filter(|text| text.lines().count() <= 2);
    fitting.next().unwrap_or_else(|| with(1))
}

/// A word that is longer than a line stays whole.
fn filled(text: &str, indent: &str) -> String {
    let options = textwrap::Options::new(COLUMNS)
        .subsequent_indent(indent)
        .break_words(false)
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(&glued(text), options).replace(GLUE, " ")
}

/// A space at which no line ends.
const GLUE: char = '\u{a0}';

/// The text with its numbers glued to their units.
fn glued(text: &str) -> String {
    let letters: Vec<char> = text.chars().collect();
    let is_unit = |letter: &char| letter.is_alphabetic() || *letter == '%';
    let glue = |(place, &letter): (usize, &char)| {
        let before = place.checked_sub(1).map(|before| letters[before]);
        let is_behind_number = before.is_some_and(|before| before.is_ascii_digit());
        if letter == ' ' && is_behind_number && letters.get(place + 1).is_some_and(is_unit) {
            GLUE
        } else {
            letter
        }
    };
    letters.iter().enumerate().map(glue).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowded_rows_keep_whole_clauses() {
        let long = format!("at {}", "x".repeat(60));
        let rows = [("torque", format!("{long}; {long}; of 3 Nm"))];
        let head = format!("hub: works, but {long}; {long}; {long}; see the warnings");
        let whole = verdict_lines(&head, &rows, 6, "with --all");
        assert!(whole.join("\n").contains("see the warnings"), "{whole:#?}");
        let longer = verdict_lines(&head, &rows, 4, "with --all");
        assert_eq!(longer[1], whole[1]);
        let short = verdict_lines(&head, &rows, 3, "with --all");
        assert_eq!(short[1], format!("{:<12}{long}; of 3 Nm …", "torque"));
        assert!(short[0].ends_with("; 2 more with --all"), "{short:#?}");
        assert_eq!(short[0].lines().count(), 2, "{short:#?}");
        let options = format!("controller  pdcc:emf=observer,{};20 kHz", "x".repeat(90));
        assert_eq!(short_row(&options), "controller  pdcc:emf=observer …");
    }

    #[test]
    fn a_path_stays_whole_and_letters_of_two_bytes_are_one_column() {
        let path = format!("page        pages/j\u{fc}rgen/{}.html", "x".repeat(90));
        assert!(short_row(&path).contains(&path[12..]), "{path}");
        let umlauts = "\u{fc}".repeat(90);
        let row = format!("{umlauts}; {}", "x".repeat(9));
        assert_eq!(short_row(&row), format!("{umlauts} …"));
    }

    #[test]
    fn no_line_ends_between_a_number_and_its_unit() {
        let text = format!("{} 0.27 % and 12 V", "x".repeat(94));
        let told = paragraph(&text);
        assert_eq!(told.lines().nth(1), Some("0.27 % and 12 V"), "{told}");
    }
}
