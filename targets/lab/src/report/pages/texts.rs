//! Emitted code, data sheet and specification, folded.

use crate::report::Block;
use crate::results::{GeneratedTexts, Results};

/// Emitted Rust.
pub fn code(data: &Results) -> Vec<Block> {
    folded(data, "emitted code", |texts| {
        let lines = format!(", {} lines of Rust", texts.rust.lines().count());
        (lines, code_block("rs", &texts.rust))
    })
}

/// Data sheets.
pub fn data_sheet(data: &Results) -> Vec<Block> {
    folded(data, "data sheet", |texts| {
        let sheet = texts.data_sheet.trim().to_owned();
        (String::new(), Block::Markdown(sheet))
    })
}

/// Normalised specifications.
pub fn spec(data: &Results) -> Vec<Block> {
    folded(data, "specification", |texts| {
        (String::new(), code_block("toml", texts.spec_toml.trim()))
    })
}

fn code_block(language: &'static str, text: &str) -> Block {
    Block::Code {
        language,
        text: text.to_owned(),
    }
}

/// A text of each variant that shows them, with a suffix of its name.
fn folded(
    data: &Results,
    what: &str,
    content: impl Fn(&GeneratedTexts) -> (String, Block),
) -> Vec<Block> {
    let shown = data.variants.iter().filter_map(|variant| {
        let (more, block) = content(variant.generated.as_ref()?);
        Some(Block::Details {
            summary: variant.label.clone() + &more,
            is_open: false,
            blocks: vec![block],
        })
    });
    let shown: Vec<Block> = shown.collect();
    if shown.is_empty() {
        Block::nothing(what)
    } else {
        shown
    }
}
