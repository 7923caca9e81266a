//! The result table: every run, its figures of merit at each speed, its limit, and the expected
//! figures.

use super::{capture_name, variant_sign};
use crate::closed_loop::{Held, LimitOutcome, Side, SpeedLimit};
use crate::engine::Model;
use crate::report::{Block, Cell, Column, Label, Table, Tone};
use crate::results::{
    Capture, Judged, Results, Run, RunPoint, Variant, judge_limit, judge_mean, judge_pp, judge_rms,
};
use crate::text::{TorqueScale, number, ripple};

/// The table, how many expected figures were met, how to read it, and notes on it.
pub fn results_blocks(data: &Results) -> Vec<Block> {
    let held = match data.held {
        Held::AtLeast => {
            "falls below 97 % of the demand, as in the design document's table (more than the demand counts as held)."
        }
        Held::Within => "is no longer within 3 % of the demand, on either side.",
    };
    let how = format!(
        "Ripple is torque after a moving mean over one control period, in percent of its mean: peak to peak (worst of three starts) and RMS. \
         The limit is the first speed at which mean torque {held} A drive that trips has no figures."
    );
    let met = met(data).map(Block::Prose).into_iter();
    let notes = data.notes.iter().map(|note| Block::Prose(note.clone()));
    met.chain([Block::Note(how), Block::Table(table(data))])
        .chain(notes)
        .collect()
}

/// How many of the expected figures are met; `None` if there are none.
fn met(data: &Results) -> Option<String> {
    let judged: Vec<Judged> = data
        .variants
        .iter()
        .flat_map(|variant| &variant.runs)
        .flat_map(|run| judge_run(data, run))
        .filter(|judged| judged.expected.is_some())
        .collect();
    let met = judged.iter().filter(|judged| judged.met).count();
    let count = match judged.len() {
        0 => return None,
        all if met == all => format!("**All {all} expected figures are met.**"),
        all => {
            format!("**{met} of {all} expected figures are met; the others are marked \u{2260}.**")
        }
    };
    Some(format!(
        "{count} Expected figures are next to the measured ones; the tolerances are 1 % of mean torque, \
         15 % or 0.5 points of ripple, and 2 points of the speed limit."
    ))
}

/// One row per variant, best first: its fixed-point code, how often each of its switches turns on at
/// the highest speed, and how far the ideal model and sampled edges differ from it.
pub fn variants_table(data: &Results) -> Table {
    let unit = TorqueScale::of(data.torque).unit;
    let mut columns = vec![Column::text("Variant")];
    for rpm in &data.speeds_rpm {
        let group = format!("{} rpm", number(*rpm, 0));
        let figures = [("Mean", unit), ("Ripple", "% pp")];
        columns.extend(figures.map(|(name, unit)| Column::number(name, unit).of(group.clone())));
    }
    columns.push(Column::number("Limit", "%"));
    columns.push(Column::number("Switching", "kHz"));
    columns.push(Column::number("Ideal", "% pp more"));
    columns.push(Column::number("Sampled", "% pp more"));
    let mut table = Table::new("variants", columns);
    let mut order: Vec<&Variant> = data
        .variants
        .iter()
        .filter(|variant| !variant.runs.is_empty())
        .collect();
    // Held furthest first; of those that hold as far, the smoothest.
    let key = |variant: &Variant| {
        let run = &variant.runs[0];
        let limit = run.limit.as_ref().and_then(|limit| limit.limit_pct);
        (
            limit.unwrap_or(0.0),
            -ripple_at_top(run).unwrap_or(f64::MAX),
        )
    };
    order.sort_by(|left, right| {
        let (left, right) = (key(left), key(right));
        right.0.total_cmp(&left.0).then(right.1.total_cmp(&left.1))
    });
    for variant in order {
        table.row(variant_row(data, variant));
    }
    table
}

/// Peak-to-peak ripple at the highest speed of the table, percent.
fn ripple_at_top(run: &Run) -> Option<f64> {
    run.points.last()?.figures.ripple_pp_pct
}

fn variant_row(data: &Results, variant: &Variant) -> Vec<Cell> {
    let scale = TorqueScale::of(data.torque);
    let fixed = &variant.runs[0];
    let mut cells = vec![Cell::from(variant.label.clone())];
    for &rpm in &data.speeds_rpm {
        match point_at(fixed, rpm) {
            Some(point) if point.tripped.is_none() => cells.extend([
                Cell::from(scale.text(point.figures.mean_torque_nm, 0)),
                Cell::from(ripple(point.figures.ripple_pp_pct)),
            ]),
            _ => cells.push(Cell::from("trips").toned(Tone::Missed).across(2)),
        }
    }
    cells.push(limit_text(fixed.limit.as_ref()).into());
    let switching = fixed.points.last().and_then(|top| top.figures.switching_hz);
    cells.push(number(switching.map(|hertz| 1e-3 * hertz), 1).into());
    let more = |model: Model, capture| {
        let run = variant
            .runs
            .iter()
            .find(|run| run.model == model && run.capture == capture)?;
        Some(ripple_at_top(run)? - ripple_at_top(fixed)?)
    };
    let ideal = more(Model::Ideal, fixed.capture);
    let sampled = if fixed.capture == Capture::Timer {
        more(Model::Fixed, Capture::Sampled)
    } else {
        None
    };
    for difference in [ideal, sampled] {
        let text = difference.map_or("-".to_owned(), |points| format!("{points:+.1}"));
        cells.push(Cell::from(text));
    }
    cells
}

fn table(data: &Results) -> Table {
    let unit = TorqueScale::of(data.torque).unit;
    let mut columns = vec![
        Column::text("Variant"),
        Column::text("Model"),
        Column::text("Hall"),
    ];
    for rpm in &data.speeds_rpm {
        let group = format!("{} rpm", number(*rpm, 0));
        let figures = [("Mean", unit), ("Ripple pp", "%"), ("Ripple RMS", "%")];
        columns.extend(figures.map(|(name, unit)| Column::number(name, unit).of(group.clone())));
    }
    columns.push(Column::number("Limit", "% of rated speed"));
    let mut table = Table::new("results", columns);
    for (index, variant) in data.variants.iter().enumerate() {
        table.group(Label::Beside(label(index, variant)));
        for run in &variant.runs {
            table.row(row(data, run));
        }
    }
    table
}

fn label(index: usize, variant: &Variant) -> Cell {
    let is_plotted = !variant.records.is_empty();
    // Hall capture has a column of its own.
    let text = variant.variant.replace(",hall_capture=timer", "");
    let text = text.replace(",hall_capture=sampled", "");
    let detail = if text.is_empty() {
        String::new()
    } else {
        format!("\n`{text}`")
    };
    Cell::from(variant.label.clone())
        .signed(is_plotted.then(|| variant_sign(index)))
        .detail(detail)
}

/// A model's name.
fn model_name(model: Model) -> &'static str {
    match model {
        Model::Fixed => "fixed\u{a0}point",
        Model::BitTrue => "bit-true\u{a0}model",
        Model::Ideal => "ideal\u{a0}float",
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

fn row(data: &Results, run: &Run) -> Vec<Cell> {
    let scale = TorqueScale::of(data.torque);
    let mut cells = vec![
        model_name(run.model).into(),
        capture_name(run.capture).into(),
    ];
    for &rpm in &data.speeds_rpm {
        let trips = point_at(run, rpm).is_some_and(|point| point.tripped.is_some());
        match judge_point(run, rpm) {
            Some(_) if trips => cells.push(Cell::from("trips").toned(Tone::Missed).across(3)),
            Some([torque, pp, rms]) => cells.extend([
                judged_cell(torque, |torque| scale.text(torque, 0)),
                judged_cell(pp, ripple),
                judged_cell(rms, ripple),
            ]),
            None => cells.push(Cell::default().across(3)),
        }
    }
    cells.push(limit_cell(run));
    cells
}

/// A measured figure with the expected one.
fn judged_cell(judged: Judged, show: impl Fn(Option<f64>) -> String) -> Cell {
    with_expected(show(judged.measured), judged, |value| show(Some(value)))
}

fn with_expected(measured: String, judged: Judged, show: impl Fn(f64) -> String) -> Cell {
    let expected = judged.expected;
    let expected = expected.map_or_else(String::new, |wanted| wanted.text("\u{2013}", show));
    Cell::from(measured).detail(expected).missed_if(!judged.met)
}

fn limit_cell(run: &Run) -> Cell {
    let limit = run.limit.as_ref();
    let above = match limit.and_then(|limit| limit.lost) {
        Some(Side::Above) => ", torque above",
        Some(Side::Below) | None => "",
    };
    let text = limit_text(limit) + above;
    let judged = judge_limit(limit, run.expected.as_ref());
    with_expected(text, judged, |percent| number(percent, 0))
}

fn limit_text(limit: Option<&SpeedLimit>) -> String {
    let percent = limit.and_then(|limit| limit.limit_pct);
    match limit.map(|limit| limit.outcome) {
        Some(LimitOutcome::NotReached) => format!("above {}", number(percent, 0)),
        Some(LimitOutcome::NeverHeld) => "never held".to_owned(),
        Some(LimitOutcome::Found) => number(percent, 1),
        None => number(None, 0),
    }
}
