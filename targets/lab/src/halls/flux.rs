//! The flux linkage of a shorted motor, from its currents.
//!
//! Terminals tied together hold `0 = R i + L di/dt + e`. So the integral of the EMF is
//! `psi = -(integral of R i) - L i`: on a circle around a fixed centre, at the rotor's angle, whatever the speed.

use super::Reading;
use crate::plant::clarke;
use hexagen_codegen::spec::{MotorSpec, Spec};
use nalgebra::{Matrix2, Matrix5, Vector2, Vector5};
use std::f64::consts::TAU;

/// A vector in the stationary plane.
pub(super) type Vector = [f64; 2];

/// Share of the circle's width between two points that count for its shape: points are then even along it, and
/// those of a rotor that stands count once.
const STEP: f64 = 0.03;

/// Phase currents of a sample as a vector, ampere, with the stated gains and offsets.
pub(super) fn current(spec: &Spec, counts: impl Iterator<Item = u16>) -> Vector {
    let sensed = spec.inverter.sensed_phases.phases();
    let mut currents = [None; 3];
    for ((phase, sensor), count) in sensed.iter().zip(spec.inverter.sensors()).zip(counts) {
        currents[*phase] = Some(sensor.gain * (f64::from(count) - f64::from(sensor.offset)));
    }
    let rest: f64 = -currents.iter().flatten().sum::<f64>();
    let (alpha, beta) = clarke(currents.map(|current| current.unwrap_or(rest)));
    [alpha, beta]
}

/// The flux linkage at each reading up to a constant, and up to a drift by the sensors' offsets.
pub(super) fn integrated(motor: &MotorSpec, row_time: f64, readings: &[Reading]) -> Vec<Vector> {
    let (r_ts, l) = (motor.resistance * row_time, motor.inductance);
    let mut charge = [0.0; 2];
    let mut before: Option<Vector> = None;
    let integral = readings.iter().map(|Reading { current, .. }| {
        // By the trapezoidal rule.
        let before = before.replace(*current).unwrap_or(*current);
        for x in 0..2 {
            charge[x] += r_ts * 0.5 * (before[x] + current[x]);
        }
        std::array::from_fn(|x| -charge[x] - l * current[x])
    });
    integral.collect()
}

/// Takes a drift off: two readings at one angle have one flux linkage. `same`: pairs of such readings.
///
/// What an offset adds grows with time, so a pair counts by its distance, squared in the fit.
pub(super) fn without_drift(flux: &mut [Vector], same: &[[usize; 2]]) {
    let distance = |[first, last]: &[usize; 2]| (last - first) as f64;
    let weight: f64 = same.iter().map(|pair| distance(pair).powi(2)).sum();
    if weight == 0.0 {
        return;
    }
    for x in 0..2 {
        let moved = |pair: &[usize; 2]| flux[pair[1]][x] - flux[pair[0]][x];
        let slope = same
            .iter()
            .map(|pair| moved(pair) * distance(pair))
            .sum::<f64>()
            / weight;
        for (place, point) in flux.iter_mut().enumerate() {
            point[x] -= slope * place as f64;
        }
    }
}

/// The circle on which the flux linkage turns.
pub(super) struct Circle {
    centre: Vector,
    /// Volt-second.
    pub radius: f64,
    /// Its narrowest width over its widest: 1 for sound sensors.
    pub roundness: f64,
    /// Readings that are apart on it.
    pub apart: Vec<usize>,
}

impl Circle {
    /// The circle about the ellipse nearest to the points, `a x^2 + b x y + c y^2 + d x + e y = 1` by least squares,
    /// which does not mind that some parts of the turn have more points; none where they do not surround anything.
    pub fn of(flux: &[Vector]) -> Option<Self> {
        let apart = apart(flux);
        let count = apart.len() as f64;
        let points = || apart.iter().map(|place| flux[*place]);
        let mean: Vector =
            std::array::from_fn(|x| points().map(|point| point[x]).sum::<f64>() / count);
        let scale = points()
            .map(|[x, y]| (x - mean[0]).hypot(y - mean[1]))
            .sum::<f64>()
            / count;
        if apart.len() < 12 || scale <= 0.0 {
            return None;
        }
        let (mut normal, mut right) = (Matrix5::zeros(), Vector5::zeros());
        for point in points() {
            let [x, y] = [0, 1].map(|own| (point[own] - mean[own]) / scale);
            let row = Vector5::new(x * x, x * y, y * y, x, y);
            normal += row * row.transpose();
            right += row;
        }
        let fit = normal.cholesky()?.solve(&right);
        let form = Matrix2::new(fit[0], 0.5 * fit[1], 0.5 * fit[1], fit[2]);
        let linear = Vector2::new(fit[3], fit[4]);
        let own = form.try_inverse()? * linear * -0.5;
        let axes = form.symmetric_eigenvalues();
        let (least, most) = (axes.min(), axes.max());
        // The form about the centre; a hyperbola has no radius.
        let level = 1.0 - 0.5 * linear.dot(&own);
        let is_ellipse = least > 0.0 && level > 0.0;
        let radius = (level / (least * most).sqrt()).sqrt();
        is_ellipse.then(|| Self {
            centre: [mean[0] + scale * own.x, mean[1] + scale * own.y],
            radius: scale * radius,
            roundness: (least / most).sqrt(),
            apart,
        })
    }

    /// The rotor's electrical angle, radians: the EMF `sin(theta)` of phase a has the integral `-cos(theta)`.
    pub fn angle(&self, [alpha, beta]: Vector) -> f64 {
        (self.centre[1] - beta)
            .atan2(self.centre[0] - alpha)
            .rem_euclid(TAU)
    }
}

/// The first of the points, and each that is a step away from the one before.
fn apart(flux: &[Vector]) -> Vec<usize> {
    let extent = |x: usize| {
        let all = || flux.iter().map(|point| point[x]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    };
    let step = STEP * extent(0).max(extent(1));
    let mut last: Option<Vector> = None;
    let is_apart = |place: &usize| {
        let [x, y] = flux[*place];
        let is_far = last.is_none_or(|[last_x, last_y]| (x - last_x).hypot(y - last_y) > step);
        if is_far {
            last = Some([x, y]);
        }
        is_far
    };
    (0..flux.len()).filter(is_apart).collect()
}
