//! The comparison as tables.

use crate::cli::{Failure, print_table, print_text};
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
    let is_own = |row: &&Row| row.controller.split(':').next() == Some(own);
    let (of_kind, others): (Vec<&Row>, Vec<&Row>) = rows.iter().partition(is_own);
    let groups = [
        (format!("{own}, the motor file's kind"), of_kind),
        ("Other controllers".to_owned(), others),
    ];
    let groups = groups.iter().filter(|(_, rows)| !rows.is_empty());
    let closing: Vec<String> = groups.map(|(whose, rows)| closing(whose, rows)).collect();
    print_text(&closing.join("\n"))
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
    print_text(
        "\nideal: with the ADC words and the state of the fixed-point drive; alone: in its own closed loop. NO: apart by \
         more than 0.5 %, or 0.05 percentage points; a word length suffices up to four times that, which no motor shows.\n",
    )?;
    print_text(&closing(variant, &rows.iter().collect::<Vec<_>>()))
}

/// The tables of single steps.
fn steps(rows: &[Row]) -> Result<(), Failure> {
    print_table(&accuracy_table(rows))?;
    for reason in rows.iter().filter_map(|row| row.refused.as_ref()) {
        print_text(reason)?;
    }
    print_text(
        "SNR, largest error and proven bound: of the deadbeat voltage in volt (p-pwm, pi-pwm: the voltage of the current controller; phcc: the predicted error of the current times K), \
         one step from the same state, phases a and b.\n\
         Decisions: sector, commutation, limit, vector. Where they differ (by rounding of a tie), errors are not compared.\n\
         Closed loop: the figure that differs most, relative to its tolerance (0.5 %, or 0.05 percentage points), same starts and ADC words. \
         Controllers of whole vectors diverge after a tie.\n\
         Duty: compare value minus exact duty, timer counts, without and with limiting, each with its proven bound and \
         half a count for the rounding of the compare value.\n",
    )?;
    print_table(&step_table(rows))
}

/// A sentence for each word length, widest first.
fn closing(whose: &str, rows: &[&Row]) -> String {
    let mut words: Vec<u32> = rows.iter().map(|row| row.word).collect();
    words.sort_unstable_by_key(|word| Reverse(*word));
    words.dedup();
    let sentences = words
        .into_iter()
        .map(|word| format!("{whose}: {}", of_word(rows, word)));
    sentences.collect::<Vec<_>>().join("\n")
}

/// Difference in closed loop, in tolerances, up to which nobody would see it on a motor: 2 %, or 0.2 points.
const SUFFICIENT: f64 = 4.0;

/// How far the drives of a word length are from floating point, at most.
fn of_word(rows: &[&Row], word: u32) -> String {
    let rows = rows.iter().filter(|row| row.word == word);
    let compared = rows.filter_map(|row| Some((&row.controller, row.accuracy.as_ref()?)));
    let compared: Vec<_> = compared.collect();
    let apart = compared.iter();
    let apart = apart.map(|(_, accuracy)| accuracy.one_step.compares_apart_counts);
    let in_closed_loop = |figure: &FigureDifference| figure.in_closed_loop().0;
    let furthest = compared.iter().filter_map(|(controller, accuracy)| {
        let (figure, rpm) = accuracy.furthest(in_closed_loop)?;
        Some((controller, figure, rpm))
    });
    let furthest = furthest
        .max_by(|(_, one, _), (_, other, _)| in_closed_loop(one).total_cmp(&in_closed_loop(other)));
    let Some(apart) = apart.max() else {
        return format!("with words of {word} bits nothing could be compared.");
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
    let Some((controller, figure, rpm)) = furthest else {
        return format!("with words of {word} bits {step}{trips}.");
    };
    let (share, change) = figure.in_closed_loop();
    let most = format!(
        "in its own closed loop the figure that changes most, {}, changes by {change} ({controller} at {rpm:.0} rpm)",
        figure.figure,
    );
    if share <= SUFFICIENT {
        format!("words of {word} bits suffice: {step}, and {most}{trips}.")
    } else {
        format!("words of {word} bits show: {most}, although {step}{trips}.")
    }
}

/// A table with the figures of each that generates.
fn table<const N: usize>(
    rows: &[Row],
    header: [&str; N],
    cells: impl Fn(&Accuracy) -> Vec<String>,
) -> Table {
    let numbers = ["word"].into_iter().chain(header);
    let numbers = numbers.map(|name| Column::number(name, ""));
    let mut table = Table::new("", [Column::text("controller")].into_iter().chain(numbers));
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
    let header = [
        "SNR dB",
        "largest V",
        "bound V",
        "ratio",
        "decisions %",
        "closed loop",
    ];
    table(rows, header, |accuracy| {
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
    table(rows, header, |accuracy| {
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
