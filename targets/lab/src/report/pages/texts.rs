//! Emitted code beside its specification; data sheet and normalised specification, folded.

use crate::report::{Block, Linked};
use crate::results::{GeneratedTexts, Item, Origin, Results, items};

/// The own controller's specification, formulas and code side by side; the code alone where no
/// links are known.
pub fn linked(data: &Results) -> Vec<Block> {
    let shown = data
        .variants
        .iter()
        .find_map(|variant| variant.generated.as_ref());
    let Some(texts) = shown else {
        return Block::nothing("emitted code");
    };
    let note = "A click on a field, a formula or a line of code marks what belongs to it in the other two. A formula belongs to a field if \
                its code differs once the field does: by 1 % for a number, by 1 for a count, by another choice for a word. Pale fields have none. With the keyboard: \
                the tab key leads from list to list, arrow keys within one, and Enter marks.";
    let items = items(&texts.rust);
    let fields = data.links.iter().map(|field| {
        let origin = match field.origin {
            Origin::File => "",
            Origin::Board => " (board)",
            Origin::Default => " (default)",
        };
        let text = format!("{}.{} = {}{origin}", field.section, field.name, field.value);
        (text, field.items.clone())
    });
    let formulas = items.iter().map(|item| {
        // Ranges stand in the data sheet.
        let text = item.text.split(" Proven:").next().unwrap_or_default();
        (
            item.name.clone(),
            text.to_owned(),
            lines_of(item, &texts.rust),
        )
    });
    vec![
        Block::Note(note.to_owned()),
        Block::Linked(Linked {
            fields: fields.collect(),
            formulas: formulas.collect(),
            language: "rs",
            code: texts.rust.clone(),
        }),
    ]
}

/// The lines of an item, and those that use it by its name.
fn lines_of(item: &Item, rust: &str) -> Vec<usize> {
    let uses = |line: &str| {
        let is_code = !line.trim_start().starts_with("///");
        is_code
            && line
                .split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == item.name)
    };
    let used = rust.lines().enumerate();
    let used = used.filter(|(place, line)| !item.lines.contains(place) && uses(line));
    item.lines
        .clone()
        .chain(used.map(|(place, _)| place))
        .collect()
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
