//! Documentation lines as comments, whatever the language.

/// The lines of a comment, each after `sign`. Paragraphs are wrapped; tables, lists, headings and
/// code keep their lines.
pub(super) fn comments<T: AsRef<str>>(sign: &str, columns: usize, lines: &[T]) -> String {
    let mut text = Comment {
        sign,
        columns,
        text: String::new(),
        width: 0,
    };
    for line in lines {
        // The user's own text may have several lines.
        for line in line.as_ref().split('\n').flat_map(|line| line.split('\r')) {
            text.add(line);
        }
    }
    text.end();
    text.text
}

struct Comment<'s> {
    sign: &'s str,
    columns: usize,
    text: String,
    /// Columns of the open line; 0 if none is open.
    width: usize,
}

impl Comment<'_> {
    fn add(&mut self, line: &str) {
        // A row of a table; a paragraph may begin with a magnitude.
        let is_row = line.starts_with('|') && line.ends_with('|');
        let begins = is_row || line.starts_with(['#', '-', ' ', '`']) || is_numbered(line);
        if line.is_empty() || begins {
            self.end();
        }
        if line.is_empty() || is_row || line.starts_with('#') {
            self.text.push_str(self.sign);
            if !line.is_empty() {
                self.text.push(' ');
                self.text.push_str(line);
            }
            self.text.push('\n');
            return;
        }
        let indent = if begins && !line.starts_with('`') {
            2
        } else {
            0
        };
        for word in words(line) {
            let columns = word.chars().count();
            if self.width > 0 && self.width + 1 + columns > self.columns {
                self.end();
                self.begin(indent);
            } else if self.width == 0 {
                self.begin(0);
            }
            self.text.push(' ');
            self.text.push_str(word);
            self.width += 1 + columns;
        }
    }

    fn begin(&mut self, indent: usize) {
        self.text.push_str(self.sign);
        self.text.push_str(&"  "[..indent]);
        self.width = self.sign.len() + indent;
    }

    fn end(&mut self) {
        if self.width > 0 {
            self.text.push('\n');
        }
        self.width = 0;
    }
}

/// The words of a line. Code is not split, nor before what would read as a list at a line's begin.
fn words(line: &str) -> Vec<&str> {
    let (mut words, mut begin, mut is_code) = (vec![], 0, false);
    for (at, letter) in line.char_indices() {
        is_code ^= letter == '`';
        if letter == ' ' && !is_code && !begins_item(&line[at..]) {
            words.push(&line[begin..at]);
            begin = at + 1;
        }
    }
    words.push(&line[begin..]);
    words.retain(|word| !word.is_empty());
    words
}

/// Whether a line with this text would begin a list item or a heading.
fn begins_item(text: &str) -> bool {
    [" - ", " + ", " * ", " # "]
        .iter()
        .any(|sign| text.starts_with(sign))
        || is_numbered(text.trim_start())
}

/// `1. …`
fn is_numbered(line: &str) -> bool {
    let rest = line.trim_start_matches(|letter: char| letter.is_ascii_digit());
    rest.len() < line.len() && rest.starts_with(". ")
}
