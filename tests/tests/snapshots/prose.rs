//! Prose of comments and data sheets, by sentence.

/// Prose that is being read: paragraphs become sentences, rows of tables and indented text stay.
#[derive(Default)]
pub struct Prose {
    lines: Vec<String>,
    paragraph: String,
}

impl Prose {
    /// Takes a line of prose, empty where a paragraph ends.
    pub fn read(&mut self, line: &str) {
        let is_row = line.starts_with(['|', '#', ' ', '`']) && !line.ends_with(['.', ',']);
        let is_range = line.starts_with("| `") && line.contains("` [");
        if is_range {
            // The stage alone: words and ranges are those of the IR.
            self.keep(line.split(" | ").next().unwrap_or(line));
        } else if is_row || line.is_empty() {
            self.keep(line);
        } else {
            self.paragraph += " ";
            self.paragraph += line.trim();
        }
    }

    /// Takes a line that is no part of a paragraph, and stays as it is.
    pub fn keep(&mut self, line: &str) {
        self.end_paragraph();
        self.lines.push(line.to_owned());
    }

    fn end_paragraph(&mut self) {
        let paragraph = std::mem::take(&mut self.paragraph);
        let mut sentence = String::new();
        for word in paragraph.split_whitespace() {
            let begins = word.starts_with(|first: char| first.is_uppercase() || first == '`');
            if begins && sentence.ends_with(['.', ';', ':']) {
                self.lines.push(std::mem::take(&mut sentence));
            }
            let space = if sentence.is_empty() { "" } else { " " };
            sentence = sentence + space + word;
        }
        self.lines.push(sentence);
    }

    /// The lines of what has been read.
    pub fn finish(&mut self) -> Vec<String> {
        self.end_paragraph();
        let mut lines = std::mem::take(&mut self.lines);
        // Proven ranges of words are those of the IR.
        lines.retain(|line| !line.is_empty() && !line.contains("in `["));
        lines
    }
}
