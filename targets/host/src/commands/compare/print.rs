//! The comparison as tables.

use crate::cli::{Failure, paragraph, print_table, print_text};
use hexagen_lab::accuracy::{Accuracy, FigureDifference, Row};
use hexagen_lab::report::{Column, Table};
use hexagen_lab::text::significant;
use std::cmp::Reverse;

/// Prints the rows of all controllers. `own`: the motor file's kind.
///
/// # Errors
/// As [`print_text`].
pub fn of_all(rows: &[Row], own: &str) -> Result<(), Failure> {
    steps(rows)?;
    print_text("Every figure of merit: --controller with one variant, or --json.\n")?;
    let whom = format!(" for {own}, the motor file's kind, and for the others");
    print_text(&closing(&whom, rows))
}

/// Prints the rows of one variant, with all figures of merit.
///
/// # Errors
/// As [`print_text`].
pub fn of_one(rows: &[Row], variant: &str) -> Result<(), Failure> {
    steps(rows)?;
    for row in rows {
        let Some(accuracy) = &row.accuracy else {
            continue;
        };
        for at in &accuracy.closed_loop {
            print_text(&format!(
                "\n{}, {:.0} rpm ({}):",
                row.controller,
                at.rpm,
                accuracy.engine.name()
            ))?;
            match at.tripped {
                Some(trip) => print_text(&trip.to_string())?,
                None => print_table(&figure_table(&at.figures))?,
            }
        }
    }
    print_text(&paragraph(
        "\nideal: with the ADC words and the state of the fixed-point drive; alone: in its own closed loop. NO: apart by \
         more than 0.5 %, or 0.05 percentage points; a word length suffices up to four times that, which no motor shows.\n",
    ))?;
    print_text(&closing(&format!(" for {variant}"), rows))
}

/// The tables of single steps.
fn steps(rows: &[Row]) -> Result<(), Failure> {
    print_table(&accuracy_table(rows))?;
    for reason in rows.iter().filter_map(|row| row.refused.as_ref()) {
        print_text(&paragraph(reason))?;
    }
    print_text(&paragraph(
        "SNR, largest error and proven bound: of the deadbeat voltage in volt (p-pwm, pi-pwm: the voltage of the current controller; phcc: the predicted error of the current times K), \
         one step from the same state, phases a and b.\n\
         Decisions: sector, commutation, limit, vector. Where they differ (by rounding of a tie), errors are not compared.\n\
         Closed loop: the figure that differs most, relative to its tolerance (0.5 %, or 0.05 percentage points), same starts and ADC words. \
         Controllers of whole vectors diverge after a tie.\n\
         Duty: compare value minus exact duty, timer counts, without and with limiting, each with its proven bound and \
         half a count for the rounding of the compare value.\n",
    ))?;
    print_table(&step_table(rows))
}

/// A sentence for each word length, widest first; `whom`: for whom a word length that all can have suffices.
fn closing(whom: &str, rows: &[Row]) -> String {
    let mut words: Vec<u32> = rows.iter().map(|row| row.word).collect();
    words.sort_unstable_by_key(|word| Reverse(*word));
    words.dedup();
    let sentences = words
        .into_iter()
        .map(|word| paragraph(&of_word(whom, rows, word)));
    sentences.collect::<Vec<_>>().join("\n")
}

/// Difference in closed loop, in tolerances, up to which nobody would see it on a motor: 2 %, or 0.2 points.
const SUFFICIENT: f64 = 4.0;

/// How far the drives of a word length are from floating point, at most.
fn of_word(whom: &str, rows: &[Row], word: u32) -> String {
    let of_word = || rows.iter().filter(|row| row.word == word);
    let compared =
        of_word().filter_map(|row| Some((row.controller.as_str(), row.accuracy.as_ref()?)));
    let compared: Vec<(&str, &Accuracy)> = compared.collect();
    let apart = compared.iter();
    let apart = apart.map(|(_, accuracy)| accuracy.one_step.compares_apart_counts);
    let Some(apart) = apart.max() else {
        return format!("With words of {word} bits nothing could be compared.");
    };
    let step = match apart {
        0 => "every compare value of a step is that of floating point".to_owned(),
        1 => "no compare value of a step is more than 1 count from floating point".to_owned(),
        counts => format!("compare values of a step are up to {counts} counts from floating point"),
    };
    let runs = compared
        .iter()
        .flat_map(|(_, accuracy)| &accuracy.closed_loop);
    let trips = match runs.filter(|at| at.tripped.is_some()).count() {
        0 => String::new(),
        trips => format!("; {trips} runs trip and are not compared"),
    };
    let change = largest_change(&compared);
    let change = change.map_or(String::new(), |change| format!(", and {change}"));
    format!(
        "{}: {step}{change}{trips}.",
        sufficiency(whom, &of_word().collect::<Vec<_>>())
    )
}

/// Whether the word length of these rows suffices: for all of them, or not for some. A drive that is refused, or trips, is
/// not one of those for which it does.
fn sufficiency(whom: &str, rows: &[&Row]) -> String {
    let suffices = |accuracy: &Accuracy| {
        let furthest = accuracy.furthest(|figure| figure.in_closed_loop().0);
        let is_near = furthest.is_none_or(|(figure, _)| figure.in_closed_loop().0 <= SUFFICIENT);
        is_near && accuracy.closed_loop.iter().all(|at| at.tripped.is_none())
    };
    let short = rows
        .iter()
        .filter(|row| !row.accuracy.as_ref().is_some_and(suffices));
    let mut short: Vec<&str> = short.map(|row| row.controller.as_str()).collect();
    short.dedup();
    let word = rows.first().map_or(0, |row| row.word);
    match short.len() {
        0 => format!("Words of {word} bits suffice{whom}"),
        all if all == rows.len() => format!("Words of {word} bits do not suffice{whom}"),
        _ => format!(
            "Words of {word} bits suffice, but not for {}",
            short.join(" and ")
        ),
    }
}

/// A controller without its options.
fn kind(controller: &str) -> &str {
    controller.split(':').next().unwrap_or(controller)
}

/// The figure of merit that changes most in its own closed loop.
fn largest_change(compared: &[(&str, &Accuracy)]) -> Option<String> {
    let in_closed_loop = |figure: &FigureDifference| figure.in_closed_loop().0;
    let furthest = compared.iter().filter_map(|(controller, accuracy)| {
        let (figure, rpm) = accuracy.furthest(in_closed_loop)?;
        Some((controller, figure, rpm))
    });
    let (controller, figure, rpm) = furthest.max_by(|(_, one, _), (_, other, _)| {
        in_closed_loop(one).total_cmp(&in_closed_loop(other))
    })?;
    let (_, change) = figure.in_closed_loop();
    Some(format!(
        "in closed loop the figure that changes most, {}, changes by {change} ({} at {rpm:.0} rpm)",
        figure.figure,
        kind(controller),
    ))
}

/// A table with the figures of each that generates: numbers, and behind them a text.
fn table<const N: usize>(
    rows: &[Row],
    header: [&str; N],
    text: Option<&str>,
    cells: impl Fn(&Accuracy) -> Vec<String>,
) -> Table {
    let numbers = ["word"].into_iter().chain(header);
    let numbers = numbers.map(|name| Column::number(name, ""));
    let columns = [Column::text("controller")].into_iter().chain(numbers);
    let mut table = Table::new("", columns.chain(text.map(Column::text)));
    for row in rows {
        let mut all = vec![row.controller.clone(), row.word.to_string()];
        match &row.accuracy {
            Some(accuracy) => all.extend(cells(accuracy)),
            None => all.push("refused".to_owned()),
        }
        table.row(all);
    }
    table
}

fn accuracy_table(rows: &[Row]) -> Table {
    let header = ["SNR dB", "largest V", "bound V", "ratio", "decisions %"];
    table(rows, header, Some("closed loop"), |accuracy| {
        let one_step = &accuracy.one_step;
        let mut trips = accuracy
            .closed_loop
            .iter()
            .filter(|at| at.tripped.is_some());
        let closed_loop = match (
            trips.next(),
            accuracy.furthest(|figure| figure.of_allowance),
        ) {
            (Some(at), _) => format!("trips, {:.0} rpm", at.rpm),
            (None, Some((figure, rpm))) => {
                format!("{}: {}, {rpm:.0} rpm", figure.text(), figure.figure)
            }
            (None, None) => String::new(),
        };
        vec![
            format!("{:.1}", one_step.snr_db),
            significant(one_step.largest_v, 3),
            significant(one_step.bound_v, 3),
            format!("{:.3}", one_step.seen_to_bound),
            format!("{:.2}", one_step.decisions_equal_pct),
            closed_loop,
        ]
    })
}

fn step_table(rows: &[Row]) -> Table {
    let header = [
        "steps",
        "rms V",
        "duty max",
        "bound",
        "limited",
        "bound",
        "duty rms",
        "equal %",
        "equal steps %",
        "counts apart",
    ];
    table(rows, header, None, |accuracy| {
        let one_step = &accuracy.one_step;
        let bound = |counts: f64| {
            if counts.is_finite() {
                significant(counts, 3)
            } else {
                "-".to_owned()
            }
        };
        vec![
            one_step.steps.to_string(),
            significant(one_step.rms_v, 3),
            significant(one_step.duty_largest_counts, 3),
            bound(one_step.duty_bound_counts),
            significant(one_step.duty_limited_counts, 3),
            bound(one_step.duty_limited_bound_counts),
            significant(one_step.duty_rms_counts, 3),
            format!("{:.2}", one_step.equal_compares_pct),
            format!("{:.2}", one_step.equal_steps_pct),
            one_step.compares_apart_counts.to_string(),
        ]
    })
}

fn figure_table(figures: &[FigureDifference]) -> Table {
    let mut table = Table::listed(
        ["figure of merit"],
        ["fixed", "ideal", "alone", "unit", "close"],
    );
    for figure in figures {
        table.row([
            figure.figure.to_owned(),
            significant(figure.fixed, 5),
            significant(figure.ideal, 5),
            significant(figure.ideal_alone, 5),
            figure.unit.to_owned(),
            if figure.close { "yes" } else { "NO" }.to_owned(),
        ]);
    }
    table
}
