//! The sections of the page, and the small pieces of HTML that they share.

pub mod header;
pub mod histograms;
pub mod numbers;
pub mod results;
pub mod robustness;
pub mod spectra;
pub mod stability;
pub mod texts;
pub mod torque_speed;
pub mod waves;

use super::plot::palette;
use hexagen_codegen::diagnostics::engineering;
use hexagen_lab::engine::Model;
use hexagen_lab::results::{Capture, Results, Variant};
use maud::{Markup, PreEscaped, html};
use plotters::style::RGBColor;

/// A quantity with the signs of print: ohm and micro as letters.
pub(in crate::report) fn quantity(value: f64, unit: &str) -> String {
    let text = engineering(value, unit);
    let Some((number, unit)) = text.split_once(' ') else {
        return text;
    };
    let unit = unit.replace("ohm", "\u{3a9}");
    let unit = unit
        .strip_prefix('u')
        .map_or(unit.clone(), |rest| format!("\u{b5}{rest}"));
    format!("{}\u{a0}{unit}", number.replace('-', "\u{2212}"))
}

/// A number with so many decimals and a true minus sign; a dash where there is none.
pub(in crate::report) fn number(value: impl Into<Option<f64>>, decimals: usize) -> String {
    match value.into().filter(|value: &f64| value.is_finite()) {
        Some(value) => format!("{value:.decimals$}").replace('-', "\u{2212}"),
        None => "\u{2013}".to_owned(),
    }
}

/// A percentage of ripple: two decimals below 1, one below 100.
pub(in crate::report) fn ripple(value: impl Into<Option<f64>>) -> String {
    let value = value.into();
    // Where rounding decides, what is shown counts.
    let decimals = match value.map_or(0.0, f64::abs) {
        x if x < 0.995 => 2,
        x if x < 99.95 => 1,
        _ => 0,
    };
    number(value, decimals)
}

/// How torque is written: the unit that suits the demand.
struct TorqueScale {
    /// Name of the unit.
    unit: &'static str,
    /// Units per newton metre.
    per_nm: f64,
    /// Decimals that show three digits of the demand.
    decimals: usize,
}

impl TorqueScale {
    /// Millinewton metres for demands below 0.1 Nm.
    fn of(data: &Results) -> Self {
        let demand = data.torque.abs();
        let (unit, per_nm) = if demand < 0.1 {
            ("mNm", 1e3)
        } else {
            ("Nm", 1.0)
        };
        let exponent = (demand * per_nm).log10().floor();
        let decimals = if exponent.is_finite() {
            (2.0 - exponent).clamp(0.0, 6.0) as usize
        } else {
            2
        };
        Self {
            unit,
            per_nm,
            decimals,
        }
    }

    /// A torque in newton metres, with more decimals by so many.
    fn text(&self, torque: impl Into<Option<f64>>, more: usize) -> String {
        let torque = torque.into().map(|torque: f64| self.per_nm * torque);
        number(torque, self.decimals + more)
    }
}

/// A short line of a colour, dashed or not, as legends and captions show it.
pub(in crate::report) fn swatch(color: RGBColor, width: f64, (dash, gap): (f64, f64)) -> Markup {
    let color = palette::css(color);
    let dashes = (gap > 0.0).then(|| format!("{dash} {gap}"));
    html! {
        svg.swatch viewBox="0 0 30 12" aria-hidden="true" {
            line x1="1" y1="6" x2="29" y2="6" stroke=(color) stroke-width=(width) stroke-dasharray=[dashes] {}
        }
    }
}

/// A filled field of a colour.
pub(in crate::report) fn field(color: RGBColor, opacity: f64) -> Markup {
    let color = palette::css(color);
    html! {
        svg.swatch viewBox="0 0 30 12" aria-hidden="true" {
            rect x="1" y="1" width="28" height="10" fill=(color) opacity=(opacity) {}
        }
    }
}

/// The swatch of the variant at a place in the table.
fn variant_swatch(index: usize) -> Markup {
    swatch(palette::variant(index), 3.0, (0.0, 0.0))
}

/// A variant's text, which may break after its commas.
pub(in crate::report) fn variant_text(variant: &str) -> Markup {
    html! {
        code.variant {
            @for part in variant.split_inclusive(',') { (part) wbr; }
        }
    }
}

/// Legend items in a row.
pub(in crate::report) fn legend(items: impl IntoIterator<Item = (Markup, String)>) -> Markup {
    html! {
        ul.legend {
            @for (sign, text) in items { li { (sign) span { (text) } } }
        }
    }
}

/// A plot below its caption.
pub(in crate::report) fn figure(caption: &Markup, plot: &PreEscaped<String>) -> Markup {
    html! { figure { figcaption { (caption) } (plot) } }
}

/// The variants that have records, with their place in the table.
fn plotted(data: &Results) -> impl Iterator<Item = (usize, &Variant)> {
    let variants = data.variants.iter().enumerate();
    variants.filter(|(_, variant)| !variant.records.is_empty())
}

/// Legend of all plotted variants.
fn variant_legend(data: &Results) -> Markup {
    legend(
        plotted(data)
            .map(|(index, variant)| (field(palette::variant(index), 1.0), variant.label.clone())),
    )
}

/// A model's name.
fn model_name(model: Model) -> &'static str {
    match model {
        Model::Fixed => "fixed point",
        Model::BitTrue => "bit-true model",
        Model::Ideal => "ideal float",
    }
}

/// A capture's name.
fn capture_name(capture: Capture) -> &'static str {
    match capture {
        Capture::Sampled => "sampled",
        Capture::Timer => "timer",
    }
}

/// Said instead of a part that has nothing to show.
fn nothing(what: &str) -> Markup {
    html! { p.note { "This report has no " (what) "." } }
}

#[cfg(test)]
mod tests {
    use super::{number, quantity, ripple};

    #[test]
    fn quantities_and_numbers_read_as_in_print() {
        assert_eq!(quantity(0.135, "ohm"), "135\u{a0}m\u{3a9}");
        assert_eq!(quantity(22e-5, "H"), "220\u{a0}\u{b5}H");
        assert_eq!(quantity(-0.5, "A"), "\u{2212}500\u{a0}mA");
        assert_eq!(number(None, 2), "\u{2013}");
        for (value, text) in [
            (0.128, "0.13"),
            (0.997, "1.0"),
            (12.72, "12.7"),
            (106.2, "106"),
        ] {
            assert_eq!(ripple(value), text);
        }
    }
}
