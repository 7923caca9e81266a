//! Phase currents, trajectory and torque over one electrical turn.

use super::{as_line, has_proportional, phase_keys, plotted, switches};
use crate::closed_loop::Trace;
use crate::report::plot::{
    Columns, TURN, Wave, columns, reference_phase, torque_range, trajectory, wave,
};
use crate::report::{Block, Color, DEMAND, Figure, IDEAL, Key, PHASES, Plot, Sign, variant};
use crate::results::Results;
use crate::text::{TorqueScale, number};

/// Columns of a plot over one turn: one for each pixel or two; half of the page's bytes are theirs.
const COLUMNS: usize = 400;

/// A plotted record.
pub struct Panel<'a> {
    /// Index of its variant among those that can be switched off.
    pub variant: Option<usize>,
    /// Colour of its lines.
    pub color: Color,
    /// Subject, for screen readers: "PDCC at 400 rpm".
    pub of: String,
    /// Caption.
    pub caption: String,
    /// Demanded torque, Nm.
    pub demand: f64,
    /// Curves of the current that is demanded, of each phase that is shown.
    pub ideal: Vec<Vec<(f64, f64)>>,
    /// The record.
    pub trace: &'a Trace,
    /// Why there is no record.
    pub nothing: Option<String>,
}

impl Panel<'_> {
    /// A plot with the panel's caption, or the reason why there is none.
    pub fn figure(&self, plot: impl FnOnce() -> Plot) -> Figure {
        let nothing = self.nothing.as_ref();
        Figure {
            variant: self.variant,
            sign: Some(Sign::line(self.color, 3.0)),
            caption: self.caption.clone(),
            plot: nothing.is_none().then(plot),
            note: nothing.map(|why| format!("No plot: {why}.")),
        }
    }
}

/// Figures of currents with their ideal waves, all with the same axis.
pub fn current_figures<'a>(
    panels: &[Panel<'a>],
    amplitude: f64,
    (what, title): (&str, &str),
    signals: impl Fn(&Panel<'a>) -> Vec<(String, Color, Columns)>,
) -> Vec<Figure> {
    let signals: Vec<_> = panels.iter().map(signals).collect();
    let most = signals
        .iter()
        .flatten()
        .flat_map(|(_, _, columns)| columns.most.iter().chain(&columns.least))
        .fold(1.1 * amplitude.abs(), |most, i| most.max(i.abs()));
    let demanded = panels.iter().flat_map(|panel| panel.ideal.iter().flatten());
    let most = demanded.fold(most, |most, (_, i)| most.max(1.1 * i.abs()));
    let figures = panels.iter().zip(signals).map(|(panel, signals)| {
        panel.figure(|| {
            wave(Wave {
                description: format!("{what} of {}", panel.of),
                title: title.to_owned(),
                range: -most..most,
                signals,
                ideal: panel.ideal.clone(),
                demand: None,
            })
        })
    });
    figures.collect()
}

/// The current of a phase over a turn of a record.
pub fn phase_current(trace: &Trace, phase: usize) -> Columns {
    columns(trace, COLUMNS, |k| current_at(trace, phase, k))
}

/// The current of a phase in a bin of a record.
pub fn current_at(trace: &Trace, phase: usize, bin: usize) -> f64 {
    match phase {
        0 => trace.i_a[bin],
        1 => trace.i_b[bin],
        _ => -trace.i_a[bin] - trace.i_b[bin],
    }
}

/// Figures of torque, all with the same axis, in the unit that suits the torque `rated`.
pub fn torque_figures(panels: &[Panel<'_>], rated: f64) -> Vec<Figure> {
    let scale = TorqueScale::of(rated);
    let torques: Vec<Columns> = panels
        .iter()
        .map(|panel| {
            columns(panel.trace, COLUMNS, |k| {
                scale.per_nm * panel.trace.torque[k]
            })
        })
        .collect();
    let shown = panels
        .iter()
        .zip(&torques)
        .filter(|(panel, _)| panel.nothing.is_none());
    let range = torque_range(scale.per_nm * rated, shown.map(|(_, columns)| columns));
    let figures = panels.iter().zip(torques).map(|(panel, torque)| {
        panel.figure(|| {
            wave(Wave {
                description: format!("Torque of {}", panel.of),
                title: format!("torque in {}", scale.unit),
                range: range.clone(),
                signals: vec![("torque".to_owned(), panel.color, torque)],
                ideal: Vec::new(),
                demand: Some(scale.per_nm * panel.demand),
            })
        })
    });
    figures.collect()
}

/// Figures of the current in the alpha-beta plane, all with the same axes.
pub fn trajectory_figures(panels: &[Panel<'_>], current: f64) -> Vec<Figure> {
    let most = panels
        .iter()
        .flat_map(|panel| (0..panel.trace.theta_e.len()).map(|k| panel.trace.i_alpha_beta(k)))
        .fold(0.0_f64, |most, (alpha, beta)| {
            most.max(alpha.abs()).max(beta.abs())
        });
    // The corners lie 2/sqrt(3) of the current from the centre, their names outside.
    let reach = (1.04 * most).max(1.53 * current.abs());
    let figures = panels.iter().map(|panel| {
        panel.figure(|| {
            let description = format!("Current in the alpha-beta plane of {}", panel.of);
            trajectory(description, panel.trace, (current, reach), panel.color)
        })
    });
    figures.collect()
}

/// One panel per variant and speed, variants in rows.
fn panels<'a>(data: &'a Results, separator: &str) -> Vec<Panel<'a>> {
    let records = plotted(data).flat_map(|(index, variant)| {
        variant
            .records
            .iter()
            .map(move |record| (index, variant, record))
    });
    let panels = records.map(|(index, of, record)| {
        let (label, rpm) = (&of.label, number(record.rpm, 0));
        let reference = |phase| {
            let asked = (of.reference, of.set_point);
            reference_phase(asked, data.motor.emf_shape, phase, &TURN)
        };
        Panel {
            variant: Some(index),
            color: variant(index),
            of: format!("{label} at {rpm} rpm"),
            caption: format!("{label}{separator}**{rpm}\u{a0}rpm**"),
            demand: data.demand(of),
            ideal: (0..3).map(reference).collect(),
            trace: &record.trace,
            nothing: None,
        }
    });
    panels.collect()
}

/// Key of the ripple's band.
pub fn ripple_key(color: Color) -> Key {
    Sign::Field(color, 0.22).means("PWM ripple")
}

/// Key of the ideal wave.
pub fn ideal_key(text: &str) -> Key {
    Sign::line(IDEAL, 5.0).means(text)
}

/// Key of the demand.
pub fn demand_key() -> Key {
    Sign::Line(DEMAND, 1.5, (6.0, 4.0)).means("demand")
}

/// Phase currents over one turn, against the demanded ones.
pub fn currents(data: &Results) -> Vec<Block> {
    let panels = panels(data, ", ");
    if panels.is_empty() {
        return Block::nothing("records");
    }
    let signals = |panel: &Panel<'_>| {
        let phases = PHASES.into_iter().enumerate();
        phases
            .map(|(phase, color)| {
                let name = format!("phase {}", ["a", "b", "c"][phase]);
                (name, color, phase_current(panel.trace, phase))
            })
            .collect()
    };
    let names = ("Phase currents", "phase current in A");
    let mut keys = phase_keys(["phase a", "phase b", "phase c"]);
    keys.extend([ripple_key(PHASES[0]), ideal_key("demanded current")]);
    let note = "Lines are means over one control period. Sectors S1 to S6 are those of the true rotor angle; the conducting pair \
                changes at their boundaries.";
    vec![
        switches(data, as_line),
        Block::Legend(keys),
        Block::Note(note.to_owned()),
        Block::Figures {
            columns: 2,
            figures: current_figures(&panels, data.current, names, signals),
        },
    ]
}

/// Trajectories of the current in the alpha-beta plane.
pub fn trajectories(data: &Results) -> Vec<Block> {
    let panels = panels(data, "\n");
    if panels.is_empty() {
        return Block::nothing("records");
    }
    let color = variant(0);
    let reference = if has_proportional(data) {
        "hexagon between the corners (circles) of a quasi-square reference in sectors S1 to S6; a sinusoidal reference of that peak is the circle that touches its sides"
    } else {
        "ideal hexagon between the reference corners (circles) of sectors S1 to S6"
    };
    vec![
        switches(data, as_line),
        Block::Legend(vec![
            ideal_key(reference),
            Sign::line(color, 2.5).means("mean over one control period"),
            Sign::line(color, 1.0).means("with PWM ripple, pale"),
        ]),
        Block::Figures {
            columns: 4,
            figures: trajectory_figures(&panels, data.current),
        },
    ]
}

/// Torque over one turn.
pub fn torque(data: &Results) -> Vec<Block> {
    let panels = panels(data, ", ");
    if panels.is_empty() {
        return Block::nothing("records");
    }
    let mean = "mean over one control period, the basis of the ripple figures";
    vec![
        switches(data, as_line),
        Block::Legend(vec![
            Sign::line(variant(0), 2.5).means(mean),
            ripple_key(variant(0)),
            demand_key(),
        ]),
        Block::Figures {
            columns: 2,
            figures: torque_figures(&panels, data.torque),
        },
    ]
}
