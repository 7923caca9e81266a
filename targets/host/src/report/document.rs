//! A page around its sections: title, style, contents, order. No script, nothing from outside.

use super::plot::palette;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Style sheet, without the rules for plots on a dark ground.
const STYLE: &str = include_str!("page.css");

/// One section: the name its link has, its title, its content.
pub struct Section {
    /// Name of its link, unique on the page.
    pub id: &'static str,
    /// Title, also the text of its link.
    pub title: &'static str,
    /// What stands below the title.
    pub content: Markup,
}

/// A whole page: heading, links to its sections, sections in their order, and the program that
/// wrote it.
pub fn document(title: &str, heading: &Markup, sections: &[Section], generator: &str) -> String {
    let dark = format!(
        "@media (prefers-color-scheme: dark) {{\n{}}}",
        palette::dark_rules()
    );
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(STYLE)) (PreEscaped(dark)) }
            }
            body {
                header {
                    (heading)
                    nav {
                        @for section in sections {
                            a href={ "#" (section.id) } { (section.title) }
                        }
                    }
                }
                main {
                    @for section in sections {
                        section id=(section.id) {
                            h2 { (section.title) }
                            (section.content)
                        }
                    }
                }
                footer { p { "Written by " (generator) "." } }
            }
        }
    };
    page.into_string()
}
