//! What stands within a line of a page: marked-up text, colours, signs of legends.

use hexagen_lab::report::{Color, Sign, Span, spans};
use maud::{Markup, html};

/// The colour as CSS writes it and as plots contain it.
pub fn css(Color(red, green, blue): Color) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// The colour as an attribute of a drawing, in the scheme of the page.
fn themed(color: Color) -> String {
    let css = css(color);
    format!("var(--c{}, {css})", &css[1..])
}

/// A marked-up text; no line break before a percent sign, breaks after commas in code.
pub fn prose(text: &str) -> Markup {
    let text = text.replace(" %", "\u{a0}%");
    html! {
        @for span in spans(&text) {
            @match span {
                Span::Plain(text) => {
                    @for (place, line) in text.split('\n').enumerate() {
                        @if place > 0 { br; }
                        (line)
                    }
                }
                Span::Code(text) => code {
                    @for part in text.split_inclusive(',') {
                        (part) @if part.ends_with(',') { wbr; }
                    }
                }
                Span::Strong(text) => strong { (prose(text)) }
                Span::Subscript(text) => sub { (text) }
            }
        }
    }
}

/// A legend's sign, as in captions and tables.
pub fn sign(sign: Sign) -> Markup {
    let drawn = match sign {
        Sign::Cell(tone) => return html! { span.heat.(tone.name()) {} },
        Sign::Line(color, width, (dash, gap)) => {
            let dashes = (gap > 0.0).then(|| format!("{dash} {gap}"));
            html! {
                line x1="1" y1="6" x2="29" y2="6" stroke=(themed(color)) stroke-width=(width)
                    stroke-dasharray=[dashes] {}
            }
        }
        Sign::Field(color, opacity) => html! {
            rect x="1" y="1" width="28" height="10" fill=(themed(color)) opacity=(opacity) {}
        },
        Sign::Dot(color) => html! { circle cx="15" cy="6" r="4" fill=(themed(color)) {} },
        Sign::Cross(color) => html! {
            path d="M11 2 L19 10 M11 10 L19 2" stroke=(themed(color)) stroke-width="2" fill="none" {}
        },
    };
    html! { svg.swatch viewBox="0 0 30 12" aria-hidden="true" { (drawn) } }
}
