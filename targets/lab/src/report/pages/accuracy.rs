//! Number formats of the emitted code, and its accuracy against floating point.

use super::{capture_name, variant_sign};
use crate::closed_loop::{FiguresOfMerit, POINTS, RELATIVE, share_of_allowance};
use crate::report::plot::histogram;
use crate::report::{Block, Cell, Column, Figure, Label, PHASES, Sign, Table};
use crate::results::{ErrorsSeen, Results, SameWords, Variant};
use crate::text::{TorqueScale, grouped, number};
use hexagen_codegen::diagnostics::{engineering, significant};
use hexagen_codegen::interface::{FormatEntry, Rounding};

/// Formats of every controller that shows them.
pub fn formats(data: &Results) -> Vec<Block> {
    let shown = data.variants.iter().filter_map(|variant| {
        let formats = &variant.generated.as_ref()?.formats;
        Some((
            format!("{}, {} formats", variant.label, formats.len()),
            formats,
        ))
    });
    let tables = shown
        .enumerate()
        .map(|(place, (summary, formats))| Block::Details {
            summary,
            is_open: place == 0,
            blocks: vec![Block::Table(format_table(formats))],
        });
    let tables: Vec<Block> = tables.collect();
    if tables.is_empty() {
        return Block::nothing("formats");
    }
    let note = "Chosen per signal from its interval. A word is the value times 2 to the power of its fraction bits, in units \
                of the base in the last column; for coefficients, the fraction bits are the shift of the product.";
    [Block::Note(note.to_owned())]
        .into_iter()
        .chain(tables)
        .collect()
}

fn format_table(formats: &[FormatEntry]) -> Table {
    let columns = [
        Column::text("Signal or coefficient"),
        Column::number("Word", ""),
        Column::number("Fraction bits", ""),
        Column::text("Rounding"),
        Column::text("Base and range"),
    ];
    let mut table = Table::new("", columns);
    for format in formats {
        let rounding = match format.rounding {
            Rounding::Floor => "floor",
            Rounding::RoundHalfUp => "round half up",
        };
        table.row([
            format!("`{}`", format.name),
            format!("i{}", format.storage_bits),
            number(f64::from(format.frac_bits), 0),
            rounding.to_owned(),
            format.meaning.clone(),
        ]);
    }
    table
}

/// A figure of merit in the error table.
struct Shown {
    name: &'static str,
    unit: &'static str,
    /// Units per unit of the figure of merit.
    per_si: f64,
    decimals: usize,
    of: fn(&FiguresOfMerit) -> Option<f64>,
}

impl Shown {
    fn new(
        name: &'static str,
        (unit, per_si, decimals): (&'static str, f64, usize),
        of: fn(&FiguresOfMerit) -> Option<f64>,
    ) -> Self {
        Self {
            name,
            unit,
            per_si,
            decimals,
            of,
        }
    }

    fn text(&self, value: Option<f64>) -> String {
        number(value.map(|value| self.per_si * value), self.decimals)
    }

    /// Whether fixed and ideal value count as equal, with a tolerance of a few hundredths of a
    /// point for percentages.
    fn is_alike(&self, at: &SameWords) -> bool {
        let (fixed, ideal) = ((self.of)(&at.fixed), (self.of)(&at.ideal));
        share_of_allowance(fixed, ideal, self.unit == "%") <= 1.0
    }

    /// Fixed point above ideal float.
    fn cell(&self, at: &SameWords) -> Cell {
        let [fixed, ideal] = [&at.fixed, &at.ideal].map(|figures| self.text((self.of)(figures)));
        let cell = Cell::from(fixed).detail(format!("\n{ideal}"));
        cell.missed_if(!self.is_alike(at))
    }
}

/// The figures of merit in the error table's columns.
fn shown_figures(scale: &TorqueScale) -> [Shown; 14] {
    let torque = (scale.unit, scale.per_nm, scale.decimals + 2);
    let percent = ("%", 1.0, 3);
    [
        Shown::new("Mean torque", torque, |m| m.mean_torque_nm),
        Shown::new("Ripple pp", percent, |m| m.ripple_pp_pct),
        Shown::new("Ripple RMS", percent, |m| m.ripple_rms_pct),
        Shown::new("Torque 6th", percent, |m| m.h6_pct),
        Shown::new("Torque 12th", percent, |m| m.h12_pct),
        Shown::new("Current 5th", percent, |m| m.i5_pct),
        Shown::new("Current 7th", percent, |m| m.i7_pct),
        Shown::new("Current 11th", percent, |m| m.i11_pct),
        Shown::new("Current 13th", percent, |m| m.i13_pct),
        Shown::new("THD", percent, |m| m.thd_pct),
        Shown::new("Tracking", ("A", 1.0, 3), |m| m.tracking_rms_a),
        Shown::new("Commu\u{ad}tation", ("\u{b5}s", 1.0, 1), |m| {
            m.commutation_us
        }),
        Shown::new("Switch\u{ad}ing", ("kHz", 1e-3, 3), |m| m.switching_hz),
        Shown::new("Satu\u{ad}rated", percent, |m| m.saturated_pct),
    ]
}

/// Differences of figures of merit, of signals if measured, and errors of single steps.
pub fn errors(data: &Results) -> Vec<Block> {
    let has_figures = data.variants.iter().flat_map(compared).next().is_some();
    let has_signals = data.variants.iter().any(|of| !of.signal_errors.is_empty());
    let mut blocks = Vec::new();
    if has_figures {
        blocks.extend(figures_of_merit(data));
    }
    if has_signals {
        blocks.extend(signals(data));
    }
    if blocks.is_empty() {
        blocks = Block::nothing("comparison of fixed point with float");
    }
    if !data.errors.is_empty() {
        blocks.extend(histograms(&data.errors));
    }
    blocks
}

/// The comparisons of a variant; a drive that tripped has none.
fn compared(variant: &Variant) -> impl Iterator<Item = &SameWords> {
    let none = FiguresOfMerit::default();
    let all = variant.same_words.iter();
    all.filter(move |at| at.fixed != none || at.ideal != none)
}

fn figures_of_merit(data: &Results) -> Vec<Block> {
    let shown = shown_figures(&TorqueScale::of(data.torque));
    let differing = |variant: &Variant| {
        let pairs = compared(variant).flat_map(|at| shown.iter().map(move |of| (of, at)));
        pairs.filter(|(of, at)| !of.is_alike(at)).count()
    };
    let comparisons = data.variants.iter().flat_map(compared).count();
    let total = grouped((comparisons * shown.len()) as u64);
    let apart: usize = data.variants.iter().map(differing).sum();
    let verdict = match apart {
        0 => format!("**All {total} pairs agree:**"),
        _ => format!("**{apart} of {total} pairs differ (marked \u{2260}):**"),
    };
    let how = format!(
        "{verdict} same start, same plant, and the same ADC counts and Hall codes for the ideal model, so that only arithmetic \
         differs. The tolerance is {} %, or {POINTS} points for percentages. Each cell shows \
         fixed point above ideal float. (In the result table above, the ideal model has a loop of its own, in which one ADC \
         count can lead to another trajectory.)",
        100.0 * RELATIVE
    );
    let meaning = "Tracking: root mean square of the current's distance from a quasi-square reference, whatever the drive's own is, so that a sine \
                   is never near it. Commutation: mean time from a change of the sector until the outgoing phase carries no more current. \
                   Saturated: periods whose command is on the edge of what the legs reach.";
    let mut blocks = vec![
        Block::Prose(how),
        Block::Note(meaning.to_owned()),
        Block::Table(figure_table(data, &shown)),
    ];
    let choosing = data
        .variants
        .iter()
        .filter(|variant| variant.chooses_vectors);
    let ties = choosing.filter(|variant| differing(variant) > 0);
    let ties: Vec<&str> = ties.map(|variant| variant.label.as_str()).collect();
    if !ties.is_empty() {
        blocks.push(Block::Note(format!(
            "{}: this controller applies one of a few whole vectors. If two of them are almost equal in cost, the last bit of a word \
             may decide, and after such a tie the two runs have different switching patterns: the mean torque agrees, ripple, harmonics \
             and switching frequency do not. From the same state, single decisions agree except for proven ties.",
            ties.join("; ")
        )));
    }
    blocks
}

fn figure_table(data: &Results, shown: &[Shown]) -> Table {
    let first = [Column::text("Hall edges"), Column::number("rpm", "")];
    let figures = shown.iter().map(|of| Column::number(of.name, of.unit));
    let mut table = Table::new("errors", first.into_iter().chain(figures));
    let variants = data.variants.iter().enumerate();
    for (index, variant) in variants.filter(|(_, variant)| compared(variant).next().is_some()) {
        let label = Cell::from(variant.label.clone()).signed(Some(variant_sign(index)));
        table.group(Label::Above(label));
        for at in compared(variant) {
            let first = [capture_name(at.capture).into(), number(at.rpm, 0).into()];
            let cells = shown.iter().map(|of| of.cell(at));
            table.row(first.into_iter().chain(cells));
        }
    }
    table
}

fn signals(data: &Results) -> [Block; 3] {
    let columns = [
        Column::text("Variant"),
        Column::text("Signal"),
        Column::number("Largest", ""),
        Column::number("RMS", ""),
        Column::number("Proven bound", ""),
        Column::text("Unit"),
    ];
    let mut table = Table::new("", columns);
    for variant in data
        .variants
        .iter()
        .filter(|of| !of.signal_errors.is_empty())
    {
        table.group(Label::Beside(variant.label.clone().into()));
        for error in &variant.signal_errors {
            table.row([
                format!("`{}`", error.signal),
                significant(error.largest),
                significant(error.rms),
                error.bound.map_or_else(String::new, significant),
                error.unit.clone(),
            ]);
        }
    }
    let note = "Error of the emitted code against the ideal model in single steps from the same state and samples.";
    [
        Block::Heading("Signals".to_owned()),
        Block::Note(note.to_owned()),
        Block::Table(table),
    ]
}

/// Errors of single steps and their proven bounds, per controller and word length.
fn histograms(errors: &[ErrorsSeen]) -> [Block; 4] {
    let note = "Default variants at the speeds above, 32- and 16-bit words: the signal of one step minus that of the ideal model from \
                the same state, phases a and b. The signal is the voltage before the limit (PHCC: the predicted \
                current error, times K). Steps in which a tie was decided differently are excluded. `hexagen compare` prints the \
                figures.";
    [
        Block::Heading("Errors of single steps against the proven bound".to_owned()),
        Block::Note(note.to_owned()),
        Block::Legend(vec![
            Sign::Field(PHASES[0], 1.0).means("measured errors, share on a logarithmic scale"),
            Sign::line(PHASES[2], 3.0).means("proven bound"),
        ]),
        Block::Figures {
            columns: 4,
            figures: errors.iter().map(histogram_of).collect(),
        },
    ]
}

fn histogram_of(seen: &ErrorsSeen) -> Figure {
    let [largest, bound] = [seen.largest_v, seen.bound_v]
        .map(|volts| engineering(volts, "V").replace(" u", " \u{b5}"));
    let (controller, word) = (&seen.controller, seen.word);
    let description =
        format!("Errors of {controller} with {word}-bit words: {largest} at most, proven {bound}");
    let caption = format!(
        "`{controller}`, **{word}\u{a0}bits**: {largest} of {bound}, SNR\u{a0}{}\u{a0}dB, decisions alike\u{a0}{}\u{a0}%",
        number(seen.snr_db, 0),
        number(seen.decisions_equal_pct, 1)
    );
    Figure::new(
        None,
        caption,
        histogram(description, seen.bound_v, &seen.counts),
    )
}
