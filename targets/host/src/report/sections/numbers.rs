//! Number formats of the emitted code, and its distance from floating point.

use super::header::grouped;
use super::{TorqueScale, capture_name, nothing, number, variant_swatch};
use hexagen_codegen::diagnostics::significant;
use hexagen_codegen::interface::{FormatEntry, Rounding};
use hexagen_lab::closed_loop::{FiguresOfMerit, POINTS, RELATIVE, share_of_allowance};
use hexagen_lab::results::{Results, SameWords, Variant};
use maud::{Markup, html};

/// Formats of every controller that shows them.
pub fn formats(data: &Results) -> Markup {
    let shown: Vec<(&Variant, &[FormatEntry])> = data
        .variants
        .iter()
        .filter_map(|variant| {
            let texts = variant.generated.as_ref()?;
            Some((variant, texts.formats.as_slice()))
        })
        .collect();
    if shown.is_empty() {
        return nothing("formats");
    }
    html! {
        p.note { "Chosen per signal from its interval. A word holds the value times two to the power of its fraction bits, in the base named last; coefficients name the shift of their product." }
        @for (place, (variant, formats)) in shown.iter().enumerate() {
            details open[place == 0] {
                summary { (variant.label) ", " (formats.len()) " formats" }
                div.scroll { (format_table(formats)) }
            }
        }
    }
}

fn format_table(formats: &[FormatEntry]) -> Markup {
    html! {
        table {
            thead {
                tr {
                    th { "Signal or coefficient" }
                    th.number { "Word" }
                    th.number { "Fraction bits" }
                    th { "Rounding" }
                    th { "Base and range" }
                }
            }
            tbody {
                @for format in formats {
                    tr {
                        td { code { (format.name) } }
                        td.number { "i" (format.storage_bits) }
                        td.number { (number(f64::from(format.frac_bits), 0)) }
                        td {
                            (match format.rounding {
                                Rounding::Floor => "floor",
                                Rounding::RoundHalfUp => "round half up",
                            })
                        }
                        td { (format.meaning) }
                    }
                }
            }
        }
    }
}

/// A figure of merit as the error table shows it.
struct Shown {
    name: &'static str,
    unit: &'static str,
    /// Units per unit of the figure of merit.
    per_si: f64,
    decimals: usize,
    /// Whether it is a percentage, so that a few hundredths of a point count as equal.
    percentage: bool,
    of: fn(&FiguresOfMerit) -> Option<f64>,
}

impl Shown {
    fn text(&self, value: Option<f64>) -> String {
        number(value.map(|value| self.per_si * value), self.decimals)
    }
}

/// The figures of merit in the error table's columns.
fn shown_figures(scale: &TorqueScale) -> [Shown; 14] {
    let percent = |name, of| Shown {
        name,
        unit: "%",
        per_si: 1.0,
        decimals: 3,
        percentage: true,
        of,
    };
    let plain = |name, unit, decimals, of| Shown {
        name,
        unit,
        per_si: 1.0,
        decimals,
        percentage: false,
        of,
    };
    [
        Shown {
            per_si: scale.per_nm,
            ..plain("Mean torque", scale.unit, scale.decimals + 2, |m| {
                m.mean_torque_nm
            })
        },
        percent("Ripple pp", |m| m.ripple_pp_pct),
        percent("Ripple RMS", |m| m.ripple_rms_pct),
        percent("Torque 6th", |m| m.h6_pct),
        percent("Torque 12th", |m| m.h12_pct),
        percent("Current 5th", |m| m.i5_pct),
        percent("Current 7th", |m| m.i7_pct),
        percent("Current 11th", |m| m.i11_pct),
        percent("Current 13th", |m| m.i13_pct),
        percent("THD", |m| m.thd_pct),
        plain("Tracking", "A", 3, |m| m.tracking_rms_a),
        plain("Commu\u{ad}tation", "\u{b5}s", 1, |m| m.commutation_us),
        Shown {
            per_si: 1e-3,
            ..plain("Switch\u{ad}ing", "kHz", 3, |m| m.switching_hz)
        },
        percent("Satu\u{ad}rated", |m| m.saturated_pct),
    ]
}

/// Fixed and ideal values of a figure of merit.
struct Pair {
    fixed: Option<f64>,
    ideal: Option<f64>,
}

impl Pair {
    fn alike(&self, percentage: bool) -> bool {
        share_of_allowance(self.fixed, self.ideal, percentage) <= 1.0
    }
}

/// One comparison of a variant.
struct Comparison<'a> {
    index: usize,
    variant: &'a Variant,
    at: &'a SameWords,
}

impl Comparison<'_> {
    fn pair(&self, shown: &Shown) -> Pair {
        Pair {
            fixed: (shown.of)(&self.at.fixed),
            ideal: (shown.of)(&self.at.ideal),
        }
    }

    /// How many of the figures of merit differ.
    fn differing(&self, figures: &[Shown]) -> usize {
        figures
            .iter()
            .filter(|shown| !self.pair(shown).alike(shown.percentage))
            .count()
    }
}

fn comparisons(data: &Results) -> Vec<Comparison<'_>> {
    let variants = data.variants.iter().enumerate();
    variants
        .flat_map(|(index, variant)| {
            let of_variant = variant.same_words.iter();
            of_variant.map(move |at| Comparison { index, variant, at })
        })
        .collect()
}

/// Differences of figures of merit, and of signals where they were measured.
pub fn errors(data: &Results) -> Markup {
    let comparisons = comparisons(data);
    let with_signals: Vec<&Variant> = data
        .variants
        .iter()
        .filter(|variant| !variant.signal_errors.is_empty())
        .collect();
    if comparisons.is_empty() && with_signals.is_empty() {
        return nothing("comparison of fixed point with float");
    }
    html! {
        @if !comparisons.is_empty() { (figure_table(&comparisons, &shown_figures(&TorqueScale::of(data)))) }
        @if !with_signals.is_empty() {
            h3 { "Signals" }
            p.note { "Distance of the emitted code from the ideal model, step by step, from the same state and samples." }
            div.scroll { (signal_table(&with_signals)) }
        }
    }
}

fn figure_table(comparisons: &[Comparison<'_>], figures: &[Shown]) -> Markup {
    let total = comparisons.len() * figures.len();
    let apart: usize = comparisons
        .iter()
        .map(|comparison| comparison.differing(figures))
        .sum();
    let groups = || comparisons.chunk_by(|a, b| a.index == b.index);
    let ties: Vec<&str> = groups()
        .filter(|group| group[0].variant.chooses_vectors)
        .filter(|group| {
            group
                .iter()
                .any(|comparison| comparison.differing(figures) > 0)
        })
        .map(|group| group[0].variant.label.as_str())
        .collect();
    html! {
        p {
            @if apart == 0 {
                span.good { "All " (grouped(total as u64)) " pairs are alike: " }
            } @else {
                strong { (apart) " of " (grouped(total as u64)) " pairs differ (marked \u{2260}): " }
            }
            "same start, same plant, and the ideal model reads the ADC and Hall words that the fixed-point code read, so that arithmetic alone can make a difference. \
             Alike means within " (100.0 * RELATIVE) " %, or within " (POINTS) " points for percentages. Each cell shows fixed point above ideal float. \
             (The result table above has the ideal model in a loop of its own, where a converter's last bit takes another course.)"
        }
        div.scroll {
            table.errors {
                thead {
                    tr {
                        th { "Hall edges" }
                        th.number { "rpm" }
                        @for shown in figures {
                            th.number { (shown.name) br; small { (shown.unit) } }
                        }
                    }
                }
                @for group in groups() {
                    tbody {
                        tr {
                            th colspan=(figures.len() + 2) scope="rowgroup" {
                                (variant_swatch(group[0].index)) " " (group[0].variant.label)
                            }
                        }
                        @for comparison in group { (figure_row(comparison, figures)) }
                    }
                }
            }
        }
        @if !ties.is_empty() {
            p.note {
                (ties.join("; ")) ": such a controller applies one of a few whole vectors. Where two of them are nearly as good, the last bit of a word may decide, \
                 and from such a near tie on the two runs apply other patterns: the mean torque stays, ripple, harmonics and switchings are those of another \
                 pattern. The single decisions agree, but for proven ties, from the same state."
            }
        }
    }
}

fn figure_row(comparison: &Comparison<'_>, figures: &[Shown]) -> Markup {
    html! {
        tr {
            td { (capture_name(comparison.at.capture)) }
            td.number { (number(comparison.at.rpm, 0)) }
            @for shown in figures {
                @let pair = comparison.pair(shown);
                @let alike = pair.alike(shown.percentage);
                td.number.missed[!alike] {
                    @if !alike { "\u{2260}\u{a0}" }
                    (shown.text(pair.fixed)) br;
                    small { (shown.text(pair.ideal)) }
                }
            }
        }
    }
}

fn signal_table(variants: &[&Variant]) -> Markup {
    let bounds = variants
        .iter()
        .flat_map(|variant| &variant.signal_errors)
        .any(|error| error.bound.is_some());
    html! {
        table {
            thead {
                tr {
                    th { "Variant" }
                    th { "Signal" }
                    th.number { "Largest" }
                    th.number { "RMS" }
                    @if bounds { th.number { "Proven bound" } }
                    th { "Unit" }
                }
            }
            @for variant in variants {
                tbody {
                    @for (row, error) in variant.signal_errors.iter().enumerate() {
                        tr {
                            @if row == 0 {
                                td rowspan=(variant.signal_errors.len()) { (variant.label) }
                            }
                            td { code { (error.signal) } }
                            td.number { (significant(error.largest)) }
                            td.number { (significant(error.rms)) }
                            @if bounds {
                                td.number { (error.bound.map_or_else(String::new, significant)) }
                            }
                            td { (error.unit) }
                        }
                    }
                }
            }
        }
    }
}
