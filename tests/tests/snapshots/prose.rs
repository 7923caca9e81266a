//! Prose of comments and data sheets, by sentence.

/// Prose being read: paragraphs become sentences, rows of tables and indented text are kept.
#[derive(Default)]
pub struct Prose {
    lines: Vec<String>,
    paragraph: String,
}

impl Prose {
    /// Adds a line of prose, empty at the end of a paragraph.
    pub fn read(&mut self, line: &str) {
        let is_row = line.starts_with(['|', '#', ' ']) && !line.ends_with(['.', ',']);
        let is_range = line.starts_with("| `") && line.contains("` [");
        if is_range {
            // Only the stage: words and ranges are those of the IR.
            self.keep(line.split(" | ").next().unwrap_or(line));
        } else if is_row || line.is_empty() {
            self.keep(line);
        } else {
            self.paragraph += " ";
            self.paragraph += line.trim();
        }
    }

    /// Adds a line that is not part of a paragraph, unchanged.
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

    /// The resulting lines.
    pub fn finish(&mut self) -> Vec<String> {
        self.end_paragraph();
        let mut lines = std::mem::take(&mut self.lines);
        // Proven ranges of words are those of the IR.
        lines.retain(|line| !line.is_empty() && !line.contains("in `["));
        lines
    }
}
