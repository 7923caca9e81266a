//! One sixth of an electrical turn of the motor file's own controller, with the commutation where it has
//! one, the first plots of the page: phase currents, and the torque beside that of the other variants.

use super::plotted;
use super::waves::current_at;
use crate::report::plot::{
    ANGLE, Axis, Columns, Series, Stroke, columns_between, reference_phase, torque_range,
};
use crate::report::{AXIS, Block, DEMAND, Figure, IDEAL, PHASES, Plot, variant};
use crate::results::{Record, Results, Variant};
use crate::text::{TorqueScale, number};
use std::ops::Range;

/// Half a sector on either side of the boundary between S1 and S2, in degrees.
const WINDOW: Range<f64> = 0.0..60.0;

/// The boundary, in degrees.
const BOUNDARY: f64 = 30.0;

/// Columns of the window: a zoom to a quarter still has one for every few pixels.
const COLUMNS: usize = 480;

/// Width and height of a plot.
const SIZE: (f64, f64) = (550.0, 280.0);

/// The plots; nothing if the controller has no record.
pub fn blocks(data: &Results) -> Vec<Block> {
    let own = data.own_variant();
    let Some((own, record)) = own.and_then(|own| Some((own, own.records.last()?))) else {
        return Vec::new();
    };
    let note = "Drag over a plot to zoom, or spread two fingers on a touch screen; double-click or double-tap to see all of it again; a \
                click on a name switches its line on or off. With the \
                keyboard, arrow keys read the values of a plot, + and \u{2212} zoom, and 0 shows all of it. Bands are PWM ripple, lines means over \
                one control period.";
    let rpm = number(record.rpm, 0);
    vec![
        Block::Heading(format!("One sixth of an electrical turn at {rpm} rpm")),
        Block::Figures {
            columns: 2,
            figures: vec![
                Figure::new(None, "Phase currents", currents(data, own, record)),
                Figure::new(None, "Torque", torque(data, own, record)),
            ],
        },
        Block::Note(note.to_owned()),
    ]
}

/// An empty plot over the window, with the boundary between the sectors.
fn window(description: String, y: Axis) -> Plot {
    let x = Axis::stepped(ANGLE, &WINDOW, 10.0);
    let mut plot = Plot::new(description, SIZE, x, y);
    let (low, high) = plot.y.range;
    let sides = [("S1", WINDOW.start), ("S2", BOUNDARY)];
    for (sector, from) in sides {
        plot.write_above(sector, (from + 15.0, high), (AXIS, 0.95));
    }
    let boundary = [(BOUNDARY, low), (BOUNDARY, high)];
    plot.line(boundary, Stroke::dashed(AXIS, 1.0, (2.0, 3.0)));
    plot
}

fn currents(data: &Results, own: &Variant, record: &Record) -> Plot {
    let trace = &record.trace;
    let phases = [0, 1, 2]
        .map(|phase| columns_between(trace, &WINDOW, COLUMNS, |k| current_at(trace, phase, k)));
    let all = phases.iter().flat_map(|of| of.most.iter().chain(&of.least));
    let most = all.fold(1.1 * own.set_point.abs(), |most, i| most.max(i.abs()));
    let y = Axis::new("phase current in A", &(-most..most), 8);
    let description =
        "Phase currents of the motor file's controller in one sixth of an electrical turn";
    let mut plot = window(description.to_owned(), y);
    for phase in 0..3 {
        let reference = (own.reference, own.set_point);
        let ideal = reference_phase(reference, data.motor.emf_shape, phase, &WINDOW);
        plot.line(ideal, Stroke::solid(IDEAL, 3.0));
    }
    for (phase, columns) in phases.into_iter().enumerate() {
        let name = format!("phase {}", ["a", "b", "c"][phase]);
        plot.series(Series::of_columns(
            name,
            columns,
            Stroke::solid(PHASES[phase], 1.6),
        ));
    }
    plot
}

/// Torque of every recorded variant at the record's speed; all but the own one are switched off at
/// first, and the axis is that of the own one.
fn torque(data: &Results, drive: &Variant, record: &Record) -> Plot {
    let scale = TorqueScale::of(data.torque);
    let demand = scale.per_nm * data.demand(drive);
    let own = data.own.as_ref().map(|own| own.variant);
    let of = |record: &Record| {
        columns_between(&record.trace, &WINDOW, COLUMNS, |k| {
            scale.per_nm * record.trace.torque[k]
        })
    };
    let range = torque_range(demand, [&of(record)].into_iter());
    let y = Axis::new(format!("torque in {}", scale.unit), &range, 8);
    let mut plot = window("Torque in one sixth of an electrical turn".to_owned(), y);
    let across = [(WINDOW.start, demand), (WINDOW.end, demand)];
    plot.line(across, Stroke::dashed(DEMAND, 1.0, (6.0, 4.0)));
    for (index, other) in plotted(data) {
        let at = other.records.iter().find(|other| other.rpm == record.rpm);
        let Some(at) = at else { continue };
        let is_own = Some(index) == own;
        let mut columns: Columns = of(at);
        if !is_own {
            // One band is legible, several are not.
            (columns.least, columns.most) = (columns.mean.clone(), columns.mean.clone());
        }
        let stroke = Stroke::solid(variant(index), 1.6);
        let series = Series::of_columns(other.label.clone(), columns, stroke);
        plot.series(Series {
            is_off: !is_own,
            ..series
        });
    }
    plot
}
