//! The result table: every run, its figures of merit at each speed, its limit, and what was expected.

use super::{TorqueScale, capture_name, model_name, number, ripple, variant_swatch, variant_text};
use hexagen_lab::closed_loop::{Held, LimitOutcome, Side};
use hexagen_lab::results::{
    Expectation, Expected, Judged, Results, Run, RunPoint, judge_limit, judge_mean, judge_pp,
    judge_rms,
};
use maud::{Markup, html};

/// The table, how many expected figures were met, and how to read it.
pub fn section(data: &Results) -> Markup {
    let judged: Vec<Judged> = data
        .variants
        .iter()
        .flat_map(|variant| &variant.runs)
        .flat_map(|run| judge_run(data, run))
        .filter(|judged| judged.expected.is_some())
        .collect();
    let met = judged.iter().filter(|judged| judged.met).count();
    html! {
        @if !judged.is_empty() {
            p {
                @if met == judged.len() {
                    span.good { "All " (judged.len()) " expected figures are met. " }
                } @else {
                    strong { (met) " of " (judged.len()) " expected figures are met; the others are marked \u{2260}. " }
                }
                "Expected figures stand in grey beside the measured ones; they count as met within 1 % of mean torque, \
                 15 % or 0.5 points of ripple, and 2 points of the speed limit."
            }
        }
        p.note {
            "Ripple is torque after a moving mean over one control period, in percent of its mean: peak to peak (worst of three starts) and RMS. \
             The limit is the first speed at which mean torque "
            (match data.held {
                Held::AtLeast => "falls below 97 % of the demand, as in the design document's table: more than the demand counts as held.",
                Held::Within => "is no longer within 3 % of the demand, on either side.",
            })
            " A drive that trips has no figures."
        }
        div.scroll {
            table.results {
                (head(data))
                @for (index, variant) in data.variants.iter().enumerate() {
                    tbody {
                        @for (row, run) in variant.runs.iter().enumerate() {
                            tr {
                                @if row == 0 {
                                    th scope="rowgroup" rowspan=(variant.runs.len()) {
                                        @if !variant.records.is_empty() { (variant_swatch(index)) " " }
                                        (variant.label)
                                        @if !variant.variant.is_empty() {
                                            br;
                                            // How Hall edges are read stands in a column of its own.
                                            (variant_text(&without_capture(&variant.variant)))
                                        }
                                    }
                                }
                                td.name { (model_name(run.model)) }
                                td { (capture_name(run.capture)) }
                                (figures(data, run))
                            }
                        }
                    }
                }
            }
        }
        @for note in &data.notes { p { (prose(note)) } }
    }
}

fn without_capture(variant: &str) -> String {
    variant
        .replace(",hall_capture=timer", "")
        .replace(",hall_capture=sampled", "")
}

fn head(data: &Results) -> Markup {
    html! {
        thead {
            tr {
                th rowspan="2" { "Variant" }
                th rowspan="2" { "Model" }
                th rowspan="2" { "Hall" }
                @for rpm in &data.speeds_rpm {
                    th.group.edge colspan="3" { (number(*rpm, 0)) " rpm" }
                }
                th.number.edge rowspan="2" { "Limit" br; small { "% of rated speed" } }
            }
            tr {
                @for _ in &data.speeds_rpm {
                    th.number.edge { "Mean" br; small { (TorqueScale::of(data).unit) } }
                    th.number { "Ripple pp" br; small { "%" } }
                    th.number { "Ripple RMS" br; small { "%" } }
                }
            }
        }
    }
}

/// The run's point at a speed.
fn point_at(run: &Run, rpm: f64) -> Option<&RunPoint> {
    run.points.iter().find(|point| point.rpm == rpm)
}

/// Mean, peak-to-peak and RMS ripple at one speed.
fn judge_point(run: &Run, rpm: f64) -> Option<[Judged; 3]> {
    let expected = run.expected.as_ref().and_then(|expected| expected.at(rpm));
    point_at(run, rpm).map(|point| {
        [
            judge_mean(&point.figures, expected),
            judge_pp(&point.figures, expected),
            judge_rms(&point.figures, expected),
        ]
    })
}

/// All judged figures of a run that are in the table.
fn judge_run(data: &Results, run: &Run) -> Vec<Judged> {
    let points = data
        .speeds_rpm
        .iter()
        .filter_map(|&rpm| judge_point(run, rpm));
    let limit = judge_limit(run.limit.as_ref(), run.expected.as_ref());
    points.flatten().chain([limit]).collect()
}

fn figures(data: &Results, run: &Run) -> Markup {
    let scale = TorqueScale::of(data);
    let mean = |torque: f64| scale.text(torque, 0);
    let whole = |value: f64| number(value, 0);
    // A column for expected figures only where some row has one keeps plain tables narrow.
    let any_expected = data
        .variants
        .iter()
        .flat_map(|variant| &variant.runs)
        .any(|run| run.expected.is_some());
    let cell = |judged: Judged,
                edge: bool,
                show: &dyn Fn(f64) -> String,
                expected: &dyn Fn(f64) -> String| {
        html! {
            td.number.edge[edge].missed[!judged.met] {
                @if !judged.met { "\u{2260}\u{a0}" }
                (judged.measured.map_or_else(|| "\u{2013}".to_owned(), show))
                @if any_expected {
                    span.expected { (judged.expected.map_or_else(String::new, |wanted| expectation(wanted, expected))) }
                }
            }
        }
    };
    let lost = run.limit.as_ref().and_then(|limit| limit.lost);
    let above = if lost == Some(Side::Above) {
        ", torque above"
    } else {
        ""
    };
    html! {
        @for &rpm in &data.speeds_rpm {
            @match judge_point(run, rpm) {
                Some(_) if point_at(run, rpm).is_some_and(|point| point.tripped.is_some()) => {
                    td.number.edge.missed colspan="3" { "trips" }
                }
                Some([torque, pp, rms]) => {
                    (cell(torque, true, &mean, &mean))
                    (cell(pp, false, &ripple, &ripple))
                    (cell(rms, false, &ripple, &ripple))
                }
                None => { td.number.edge {} td {} td {} }
            }
        }
        @match run.limit.as_ref().map(|limit| limit.outcome) {
            Some(LimitOutcome::NotReached) => {
                td.number.edge.missed[!judge_limit(run.limit.as_ref(), run.expected.as_ref()).met] {
                    "above " (run.limit.as_ref().and_then(|limit| limit.limit_pct).map_or_else(String::new, |x| number(x, 0)))
                    @if any_expected {
                        span.expected { (expected_limit(run.expected.as_ref())) }
                    }
                }
            }
            Some(LimitOutcome::NeverHeld) => {
                td.number.edge.missed[!judge_limit(run.limit.as_ref(), run.expected.as_ref()).met] {
                    "never held" (above)
                    @if any_expected {
                        span.expected { (expected_limit(run.expected.as_ref())) }
                    }
                }
            }
            Some(LimitOutcome::Found) => {
                (cell(judge_limit(run.limit.as_ref(), run.expected.as_ref()), true, &|x| number(x, 1) + above, &whole))
            }
            None => {
                td.number.edge {
                    "\u{2013}"
                    @if any_expected {
                        span.expected { (expected_limit(run.expected.as_ref())) }
                    }
                }
            }
        }
    }
}

fn expected_limit(expected: Option<&Expected>) -> String {
    expected
        .and_then(|expected| expected.limit)
        .map_or_else(String::new, |wanted| expectation(wanted, &|x| number(x, 0)))
}

/// A note: percentages do not break before their sign, and what stands between back-ticks is code.
fn prose(text: &str) -> Markup {
    let text = text.replace(" %", "\u{a0}%");
    html! {
        @for (place, part) in text.split('`').enumerate() {
            @if place % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

/// An expectation as the page writes it.
fn expectation(wanted: Expectation, show: &dyn Fn(f64) -> String) -> String {
    wanted.text("\u{2013}", show)
}
