//! Plots of the three phases over an electrical turn that need no simulation.

use crate::report::plot::{Columns, FIRST_DEG, Point, Wave, wave};
use crate::report::{PHASES, Plot};
use hexagen_codegen::spec::EmfShape;

/// A signal without ripple.
pub fn columns(points: impl IntoIterator<Item = Point>) -> Columns {
    let (angle, mean): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    Columns {
        least: mean.clone(),
        most: mean.clone(),
        angle,
        mean,
    }
}

/// Signals of the three phases in units of their amplitude.
pub fn phases(description: &str, title: &str, of: impl Fn(usize) -> Columns) -> Plot {
    let phases = PHASES.into_iter().enumerate();
    wave(Wave {
        description: format!("{description} of the three phases over an electrical turn"),
        title: title.to_owned(),
        range: -1.2..1.2,
        signals: phases
            .map(|(phase, color)| {
                (
                    format!("phase {}", ["a", "b", "c"][phase]),
                    color,
                    of(phase),
                )
            })
            .collect(),
        ideal: Vec::new(),
        demand: None,
    })
}

/// The shape of the EMF.
pub fn emf_shape(shape: EmfShape) -> Plot {
    phases("EMF", "EMF in E", |phase| {
        let degrees = (0..=360).map(|k| FIRST_DEG + f64::from(k));
        columns(degrees.map(|degrees| {
            let theta = degrees - 120.0 * phase as f64;
            (degrees, shape.at(theta.to_radians()))
        }))
    })
}
