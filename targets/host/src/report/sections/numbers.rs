//! Number formats of the emitted code, and its distance from floating point.

use super::header::grouped;
use super::{capture_name, nothing, number, variant_swatch};
use crate::closed_loop::Merits;
use crate::report::{Model, ReportData, Run, RunPoint, Variant};
use hexagen_codegen::diagnostics::significant;
use hexagen_codegen::interface::{FormatEntry, Rounding};
use maud::{Markup, html};

/// Relative difference between fixed point and float that is still as good as none.
const RELATIVE: f64 = 0.01;

/// The same for percentages, in points.
const POINTS: f64 = 0.05;

/// Formats of every controller that shows them.
pub fn formats(data: &ReportData) -> Markup {
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

/// A merit as the error table shows it.
struct Shown {
    name: &'static str,
    unit: &'static str,
    decimals: usize,
    /// Whether it is a percentage, so that a few hundredths of a point count as equal.
    percentage: bool,
    of: fn(&Merits) -> f64,
}

const SHOWN: [Shown; 10] = [
    shown("Mean torque", "Nm", 4, false, |m| m.mean_torque_nm),
    shown("Ripple pp", "%", 3, true, |m| m.ripple_pp_pct),
    shown("Ripple RMS", "%", 3, true, |m| m.ripple_rms_pct),
    shown("Torque 6th", "%", 3, true, |m| m.h6_pct),
    shown("Torque 12th", "%", 3, true, |m| m.h12_pct),
    shown("Current 5th", "%", 3, true, |m| m.i5_pct),
    shown("Current 7th", "%", 3, true, |m| m.i7_pct),
    shown("THD", "%", 3, true, |m| m.thd_pct),
    shown("Tracking", "A", 3, false, |m| m.tracking_rms_a),
    shown("Commutation", "\u{b5}s", 1, false, |m| m.commutation_us),
];

const fn shown(
    name: &'static str,
    unit: &'static str,
    decimals: usize,
    percentage: bool,
    of: fn(&Merits) -> f64,
) -> Shown {
    Shown {
        name,
        unit,
        decimals,
        percentage,
        of,
    }
}

/// Fixed and ideal values of a merit.
struct Pair {
    fixed: f64,
    ideal: f64,
}

impl Pair {
    fn alike(&self, percentage: bool) -> bool {
        let difference = (self.fixed - self.ideal).abs();
        difference <= RELATIVE * self.ideal.abs() || (percentage && difference <= POINTS)
    }
}

/// Fixed and ideal run of one variant, capture and speed.
struct Comparison<'a> {
    index: usize,
    variant: &'a Variant,
    capture: &'static str,
    fixed: &'a RunPoint,
    ideal: &'a RunPoint,
}

impl Comparison<'_> {
    fn pair(&self, shown: &Shown) -> Pair {
        Pair {
            fixed: (shown.of)(&self.fixed.merits),
            ideal: (shown.of)(&self.ideal.merits),
        }
    }
}

fn comparisons(data: &ReportData) -> Vec<Comparison<'_>> {
    let mut found = Vec::new();
    for (index, variant) in data.variants.iter().enumerate() {
        let of = |model: Model| variant.runs.iter().filter(move |run| run.model == model);
        let pairs = of(Model::Fixed).filter_map(|fixed: &Run| {
            let ideal = of(Model::Ideal).find(|ideal| ideal.capture == fixed.capture)?;
            Some((fixed, ideal))
        });
        for (fixed, ideal) in pairs {
            for point in &fixed.points {
                let twin = ideal.points.iter().find(|twin| twin.rpm == point.rpm);
                if let Some(twin) = twin {
                    found.push(Comparison {
                        index,
                        variant,
                        capture: capture_name(fixed.capture),
                        fixed: point,
                        ideal: twin,
                    });
                }
            }
        }
    }
    found
}

/// Differences of merits, and of signals where they were measured.
pub fn errors(data: &ReportData) -> Markup {
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
        @if !comparisons.is_empty() { (merit_table(&comparisons)) }
        @if !with_signals.is_empty() {
            h3 { "Signals" }
            p.note { "Distance of the emitted code from the ideal model, step by step, from the same state and samples." }
            div.scroll { (signal_table(&with_signals)) }
        }
    }
}

fn merit_table(comparisons: &[Comparison<'_>]) -> Markup {
    let total = comparisons.len() * SHOWN.len();
    let apart = comparisons
        .iter()
        .flat_map(|comparison| {
            SHOWN
                .iter()
                .map(|shown| comparison.pair(shown).alike(shown.percentage))
        })
        .filter(|alike| !alike)
        .count();
    html! {
        p {
            @if apart == 0 {
                span.good { "All " (grouped(total as u64)) " pairs are alike: " }
            } @else {
                strong { (apart) " of " (grouped(total as u64)) " pairs differ (marked \u{2260}): " }
            }
            "same start, same plant; alike means within 1 %, or within 0.05 points for percentages. Each cell shows fixed point above ideal float."
        }
        div.scroll {
            table.errors {
                thead {
                    tr {
                        th { "Hall edges" }
                        th.number { "rpm" }
                        @for shown in &SHOWN {
                            th.number { (shown.name) br; small { (shown.unit) } }
                        }
                    }
                }
                @for group in comparisons.chunk_by(|a, b| a.index == b.index) {
                    tbody {
                        tr {
                            th colspan=(SHOWN.len() + 2) scope="rowgroup" {
                                (variant_swatch(group[0].index)) " " (group[0].variant.label)
                            }
                        }
                        @for comparison in group { (merit_row(comparison)) }
                    }
                }
            }
        }
    }
}

fn merit_row(comparison: &Comparison<'_>) -> Markup {
    html! {
        tr {
            td { (comparison.capture) }
            td.number { (number(comparison.fixed.rpm, 0)) }
            @for shown in &SHOWN {
                @let pair = comparison.pair(shown);
                @let alike = pair.alike(shown.percentage);
                td.number.missed[!alike] {
                    @if !alike { "\u{2260}\u{a0}" }
                    (number(pair.fixed, shown.decimals)) br;
                    small { (number(pair.ideal, shown.decimals)) }
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
