//! Harmonics of the phase current, with the ideal wave, and of the torque.

use super::plotted;
use crate::closed_loop::{
    Trace, harmonic_of_quasi_square, harmonics_of_current, harmonics_of_torque,
};
use crate::report::plot::{Bars, bars};
use crate::report::{Block, Figure, INK, Sign, variant};
use crate::results::Results;
use crate::text::number;

/// Orders of the current's plot: those of the quasi-square wave.
pub const CURRENT_ORDERS: [usize; 8] = [5, 7, 11, 13, 17, 19, 23, 25];

/// Orders of the torque's plot.
const TORQUE_ORDERS: [usize; 4] = [6, 12, 18, 24];

/// Highest computed order.
pub const HIGHEST: usize = 25;

/// A spectrum: one value per order, if defined.
pub type Spectrum = Vec<Option<f64>>;

/// A kind of spectrum.
struct Kind {
    name: &'static str,
    y_title: &'static str,
    orders: &'static [usize],
    /// Minimum of the vertical axis' end.
    least: f64,
    of: fn(&Trace, usize) -> Spectrum,
    ideal: fn(usize) -> Option<f64>,
}

const KINDS: [Kind; 2] = [
    Kind {
        name: "Phase current",
        y_title: "% of the fundamental",
        orders: &CURRENT_ORDERS,
        least: 22.0,
        of: harmonics_of_current,
        ideal: |order| Some(harmonic_of_quasi_square(order)),
    },
    Kind {
        name: "Torque",
        y_title: "% of mean torque",
        orders: &TORQUE_ORDERS,
        least: 1.0,
        of: harmonics_of_torque,
        ideal: |_| None,
    },
];

/// The plots.
pub fn blocks(data: &Results) -> Vec<Block> {
    if plotted(data).next().is_none() {
        return Block::nothing("records");
    }
    let variants = plotted(data);
    let fields = variants.map(|(k, of)| Sign::Field(variant(k), 1.0).means(of.label.clone()));
    let ideal =
        "ideal quasi-square wave: 100 % divided by the order (an ideal torque has no harmonic)";
    let mut blocks = vec![
        Block::Legend(fields.collect()),
        Block::Legend(vec![Sign::line(INK, 2.0).means(ideal)]),
    ];
    blocks.extend(KINDS.iter().map(|kind| plots(data, kind)));
    blocks
}

/// A plot per speed, all with the same axis.
fn plots(data: &Results, kind: &Kind) -> Block {
    let at = |rpm: f64| {
        let records = plotted(data).filter_map(move |(index, variant)| {
            let record = variant.records.iter().find(|record| record.rpm == rpm)?;
            Some((super::variant(index), (kind.of)(&record.trace, HIGHEST)))
        });
        records.unzip()
    };
    let speeds: Vec<(f64, (Vec<_>, Vec<Spectrum>))> =
        data.speeds_rpm.iter().map(|&rpm| (rpm, at(rpm))).collect();
    let all = speeds.iter().flat_map(|(_, (_, spectra))| spectra);
    let top = top(all, kind.orders, (kind.least, 100.0));
    let running = speeds.into_iter().filter(|(_, (_, all))| !all.is_empty());
    let figures = running.map(|(rpm, (colors, spectra))| {
        let rpm = number(rpm, 0);
        let plot = bars(Bars {
            description: format!("Harmonics of the {} at {rpm} rpm", kind.name.to_lowercase()),
            x_title: "order of the harmonic",
            y_title: kind.y_title,
            top,
            colors,
            groups: groups(&spectra, kind.orders, kind.ideal),
        });
        Figure::new(None, format!("{}, **{rpm} rpm**", kind.name), plot)
    });
    Block::Figures {
        columns: 2,
        figures: figures.collect(),
    }
}

/// A group of bars per order.
pub fn groups(
    spectra: &[Spectrum],
    orders: &[usize],
    ideal: fn(usize) -> Option<f64>,
) -> Vec<(String, Vec<Option<f64>>, Option<f64>)> {
    let group = |&order: &usize| {
        let values = spectra.iter().map(|spectrum| spectrum[order]);
        (order.to_string(), values.collect(), ideal(order))
    };
    orders.iter().map(group).collect()
}

/// The vertical axis' end: the greatest harmonic, within both limits, with a margin.
pub fn top<'a>(
    spectra: impl Iterator<Item = &'a Spectrum>,
    orders: &[usize],
    (least, most): (f64, f64),
) -> f64 {
    let values = spectra.flat_map(|spectrum| orders.iter().filter_map(|&order| spectrum[order]));
    1.06 * values.fold(least, f64::max).min(most)
}
