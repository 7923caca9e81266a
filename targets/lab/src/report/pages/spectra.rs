//! Harmonics of the phase current, with the ideal wave, and of the torque.

use super::{has_proportional, plotted, switches};
use crate::closed_loop::{
    Trace, harmonic_of_quasi_square, harmonics_of_current, harmonics_of_torque,
};
use crate::report::plot::{Bar, Bars, bars};
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
    let ideal = if has_proportional(data) {
        "quasi-square wave, for comparison: 100 % divided by the order (neither a sine nor an ideal torque has a harmonic)"
    } else {
        "ideal quasi-square wave: 100 % divided by the order (an ideal torque has no harmonic)"
    };
    let mut blocks = vec![
        switches(data, |color| Sign::Field(color, 1.0)),
        Block::Legend(vec![Sign::line(INK, 2.0).means(ideal)]),
    ];
    blocks.extend(KINDS.iter().map(|kind| plots(data, kind)));
    blocks
}

/// A plot per speed, all with the same axis.
fn plots(data: &Results, kind: &Kind) -> Block {
    let at = |rpm: f64| -> Vec<(usize, &str, Spectrum)> {
        let records = plotted(data).filter_map(move |(index, variant)| {
            let record = variant.records.iter().find(|record| record.rpm == rpm)?;
            let spectrum = (kind.of)(&record.trace, HIGHEST);
            Some((index, variant.label.as_str(), spectrum))
        });
        records.collect()
    };
    let speeds = data.speeds_rpm.iter().map(|&rpm| (rpm, at(rpm)));
    let speeds: Vec<_> = speeds.filter(|(_, all)| !all.is_empty()).collect();
    let all = speeds.iter().flat_map(|(_, all)| all);
    let all = all.map(|(_, _, spectrum)| spectrum);
    let top = top(all, kind.orders, (kind.least, 100.0));
    let figures = speeds.iter().map(|(rpm, spectra)| {
        let rpm = number(*rpm, 0);
        let bar = |(index, label, spectrum): &(usize, &str, Spectrum)| Bar {
            name: (*label).to_owned(),
            variant: Some(*index),
            color: variant(*index),
            values: values(spectrum, kind.orders),
        };
        let plot = bars(Bars {
            description: format!("Harmonics of the {} at {rpm} rpm", kind.name.to_lowercase()),
            x_title: "order of the harmonic",
            y_title: kind.y_title,
            top,
            groups: kind.orders.iter().map(usize::to_string).collect(),
            bars: spectra.iter().map(bar).collect(),
            ideal: kind.orders.iter().copied().filter_map(kind.ideal).collect(),
        });
        Figure::new(None, format!("{}, **{rpm} rpm**", kind.name), plot)
    });
    Block::Figures {
        columns: 2,
        figures: figures.collect(),
    }
}

/// The values of a spectrum at some orders.
pub fn values(spectrum: &Spectrum, orders: &[usize]) -> Vec<Option<f64>> {
    orders.iter().map(|&order| spectrum[order]).collect()
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
