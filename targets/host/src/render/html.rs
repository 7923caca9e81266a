//! Pages as HTML: one self-contained file without external resources.
//!
//! Its script draws plots with uPlot and serves the controls; without one, texts and tables remain.

use super::inline::{css, prose, sign};
use super::linked::linked;
use super::plot::plot;
use super::texts::{code, markdown};
use super::{RenderError, table};
use hexagen_lab::report::{
    AXIS, Block, Color, DEMAND, Figure, GRID, IDEAL, INK, Key, PHASES, Page, Switch, VARIANTS,
};
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// Style sheet, without the colours of plots in the dark scheme.
const STYLE: &str = include_str!("page.css");

/// The page's script.
const SCRIPT: &str = include_str!("page.js");

/// Plot library and its style sheet, as published (vendor/uplot/README.md).
const LIBRARY: &str = include_str!("../../vendor/uplot/uPlot.iife.min.js");
const LIBRARY_STYLE: &str = include_str!("../../vendor/uplot/uPlot.min.css");

/// Colours that the dark scheme replaces; the others are readable in both.
const DARK: [(Color, &str); 13] = [
    (INK, "#D7DCE2"),
    (AXIS, "#8B949E"),
    (GRID, "#2D333B"),
    (IDEAL, "#545D68"),
    (DEMAND, "#ADBAC7"),
    (PHASES[0], "#6CA6E0"),
    (PHASES[2], "#E0788A"),
    (VARIANTS[0], "#4DA3D9"),
    (VARIANTS[1], "#F07F35"),
    (VARIANTS[2], "#2FC295"),
    (VARIANTS[6], "#B8946C"),
    (VARIANTS[8], "#9A8CF0"),
    (VARIANTS[10], "#CC66A0"),
];

/// A page as text.
///
/// # Errors
/// A plot that cannot be drawn, or a text that cannot be coloured.
pub fn html(page: &Page) -> Result<String, RenderError> {
    let opening = blocks(&page.opening)?;
    let sections = page.sections.iter();
    let contents = sections
        .map(|section| Ok((section, blocks(&section.blocks)?)))
        .collect::<Result<Vec<_>, RenderError>>()?;
    let document = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (page.title) }
                style {
                    (PreEscaped(LIBRARY_STYLE)) (PreEscaped(STYLE)) (PreEscaped(dark_colors()))
                }
            }
            body {
                header {
                    h1 { (page.heading) }
                    noscript {
                        p { "Plots, switches and sorting need JavaScript, which is off; texts and tables do not." }
                    }
                    (opening)
                    nav {
                        @for section in &page.sections {
                            a href={ "#" (section.id) } { (section.title) }
                        }
                    }
                }
                main {
                    @for (section, content) in contents {
                        section id=(section.id) {
                            h2 { (section.title) }
                            (content)
                        }
                    }
                }
                footer {
                    p { "Written by " (page.generator) ". Plots: uPlot, MIT licence, Leon Sorokin." }
                }
                script { (PreEscaped(LIBRARY)) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    Ok(document.into_string())
}

/// The colours of drawings on a dark ground; plots look them up by the same names.
fn dark_colors() -> String {
    let dark = DARK.map(|(light, dark)| format!("--c{}:{dark}", &css(light)[1..]));
    let dark = dark.join(";");
    format!("@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}")
}

fn blocks(blocks: &[Block]) -> Result<Markup, RenderError> {
    let parts = blocks.iter().map(block);
    let parts = parts.collect::<Result<Vec<_>, _>>()?;
    Ok(html! { @for part in parts { (part) } })
}

fn block(block: &Block) -> Result<Markup, RenderError> {
    Ok(match block {
        Block::Heading(text) => html! { h3 { (prose(text)) } },
        Block::Lead(text) => html! { p.lead { (prose(text)) } },
        Block::Prose(text) => html! { p { (prose(text)) } },
        Block::Note(text) => html! { p.note { (prose(text)) } },
        Block::Table(of) => html! { div.scroll { (table::html(of)) } },
        Block::Tables(tables) => html! {
            div.facts {
                @for of in tables { div { h3 { (of.title) } (table::html(of)) } }
            }
        },
        Block::Legend(keys) => legend(keys),
        Block::Switches(switches) => row_of_switches(switches),
        Block::Figures { columns, figures } => row_of_figures(*columns, figures)?,
        Block::Details {
            summary,
            is_open,
            blocks: content,
        } => html! {
            details open[*is_open] {
                summary { (prose(summary)) }
                div { (blocks(content)?) }
            }
        },
        Block::Markdown(text) => markdown(text),
        Block::Linked(of) => linked(of)?,
        Block::Code { language, text } => code(language, text)?,
    })
}

fn legend(keys: &[Key]) -> Markup {
    html! {
        ul.legend {
            @for key in keys { li { (sign(key.sign)) span { (prose(&key.text)) } } }
        }
    }
}

/// Buttons that switch variants on and off, on at first.
fn row_of_switches(switches: &[Switch]) -> Markup {
    html! {
        ul.legend {
            @for Switch { variant, key } in switches {
                li {
                    button data-variant=(variant) aria-pressed="true" {
                        (sign(key.sign)) span { (prose(&key.text)) }
                    }
                }
            }
        }
    }
}

/// Greatest width of a narrow plot in CSS pixels.
const NARROW: f64 = 620.0;

/// Figures side by side.
fn row_of_figures(columns: usize, figures: &[Figure]) -> Result<Markup, RenderError> {
    // A single column is as wide as the page only for wide plots.
    let is_wide = |of: &Figure| of.plot.as_ref().is_some_and(|plot| plot.size.0 > NARROW);
    let class = match columns {
        1 if figures.iter().any(is_wide) => "full",
        0 | 1 => "one",
        2 => "two",
        3 => "three",
        _ => "four",
    };
    let figures = figures.iter().map(figure);
    let figures = figures.collect::<Result<Vec<_>, _>>()?;
    Ok(html! { div.plots.(class) { @for figure in figures { (figure) } } })
}

fn figure(figure: &Figure) -> Result<Markup, RenderError> {
    let plot = figure.plot.as_ref().map(plot).transpose()?;
    let is_empty = plot.is_none();
    Ok(html! {
        figure.nothing[is_empty] data-variant=[figure.variant] {
            @if !figure.caption.is_empty() {
                figcaption {
                    @if let Some(of) = figure.sign { (sign(of)) }
                    span { (prose(&figure.caption)) }
                }
            }
            @if let Some(plot) = plot { (plot) }
            @if let Some(note) = &figure.note { p.note { (prose(note)) } }
        }
    })
}
