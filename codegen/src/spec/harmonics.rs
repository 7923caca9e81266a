//! An EMF shape as a Fourier series: of stated harmonics, or of a recorded trace.

use std::f64::consts::{PI, TAU};

/// Odd orders of the series: 1, 3, ... 23. Even ones cancel between the poles of a machine.
pub const ORDERS: usize = 12;

/// Steps of a half turn in which the greatest value is looked for.
const STEPS: u32 = 1800;

/// A third of a turn, by which phase b lags phase a.
const THIRD: f64 = TAU / 3.0;

/// The Fourier series of phase a's EMF with unit peak: the sum of s_n sin(n theta) + c_n cos(n theta).
/// Its fundamental rises through zero at angle 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonics {
    /// Coefficients s_n of orders 1, 3, ... 23.
    pub sines: [f64; ORDERS],
    /// Coefficients c_n.
    pub cosines: [f64; ORDERS],
}

/// The order at a place of the series.
fn order(place: usize) -> f64 {
    (2 * place + 1) as f64
}

impl Harmonics {
    /// The fundamental and the harmonics (order, amplitude over that of the fundamental, phase in
    /// radian): amplitude sin(order theta + phase). Other orders than 3, 5, ... 23 are left out.
    pub fn of(harmonics: impl IntoIterator<Item = (u32, f64, f64)>) -> Self {
        let mut series = Self {
            sines: [0.0; ORDERS],
            cosines: [0.0; ORDERS],
        };
        series.sines[0] = 1.0;
        for (order, amplitude, phase) in harmonics {
            let place = (order / 2) as usize;
            if Self::has_order(order) {
                series.sines[place] += amplitude * phase.cos();
                series.cosines[place] += amplitude * phase.sin();
            }
        }
        series.scaled(1.0 / series.peak())
    }

    /// Whether an order can be stated: odd, 3 to 23.
    pub fn has_order(order: u32) -> bool {
        order % 2 == 1 && (1..ORDERS).contains(&((order / 2) as usize))
    }

    fn scaled(self, by: f64) -> Self {
        Self {
            sines: self.sines.map(|value| value * by),
            cosines: self.cosines.map(|value| value * by),
        }
    }

    /// The sum over all orders of `term(order, sin(order theta), cos(order theta), s, c)`.
    fn sum(&self, theta: f64, term: impl Fn(f64, [f64; 2], [f64; 2]) -> f64) -> f64 {
        let (sin, cos) = theta.sin_cos();
        // A turn by twice the angle leads from one odd order to the next.
        let (sin_2, cos_2) = (2.0 * sin * cos, cos * cos - sin * sin);
        let mut wave = [sin, cos];
        let mut sum = 0.0;
        for place in 0..ORDERS {
            sum += term(order(place), wave, [self.sines[place], self.cosines[place]]);
            let [sin, cos] = wave;
            wave = [sin * cos_2 + cos * sin_2, cos * cos_2 - sin * sin_2];
        }
        sum
    }

    /// Unit EMF of phase a.
    pub fn at(&self, theta: f64) -> f64 {
        self.sum(theta, |_, [sin, cos], [s, c]| s * sin + c * cos)
    }

    /// Its integral over the angle, with zero mean over a turn.
    pub fn integral(&self, theta: f64) -> f64 {
        self.sum(theta, |order, [sin, cos], [s, c]| {
            (c * sin - s * cos) / order
        })
    }

    /// Amplitude of the fundamental.
    pub fn fundamental(&self) -> f64 {
        self.sines[0]
    }

    /// Greatest magnitude.
    fn peak(&self) -> f64 {
        greatest(|theta| self.at(theta))
    }

    /// Greatest EMF between two phases.
    pub fn line_peak(&self) -> f64 {
        greatest(|theta| self.at(theta) - self.at(theta - THIRD))
    }

    /// Half the sum of the squared amplitudes of the orders that `is_taken` takes.
    fn power(&self, is_taken: impl Fn(usize) -> bool) -> f64 {
        let places = (0..ORDERS).filter(|&place| is_taken(2 * place + 1));
        let squares = places.map(|place| self.sines[place].powi(2) + self.cosines[place].powi(2));
        squares.sum::<f64>() / 2.0
    }

    /// Least component of the EMF vector along its fundamental, over the fundamental.
    pub fn least_along(&self) -> f64 {
        let along = |theta: f64| {
            let [a, b, c] = [0.0, 1.0, 2.0].map(|lag| self.at(theta - lag * THIRD));
            // The fundamental lies along (sin theta, -cos theta).
            let (alpha, beta) = ((2.0 * a - b - c) / 3.0, (b - c) / 3_f64.sqrt());
            alpha * theta.sin() - beta * theta.cos()
        };
        let angles = (0..STEPS).map(|step| PI * f64::from(step) / f64::from(STEPS));
        let least = angles.map(along).fold(f64::INFINITY, f64::min);
        least / self.fundamental()
    }

    /// Sum of the harmonics' amplitudes times their orders, over the fundamental's.
    pub fn steepness(&self) -> f64 {
        let amplitude = |place: usize| self.sines[place].hypot(self.cosines[place]);
        let steep = (1..ORDERS).map(|place| order(place) * amplitude(place));
        steep.sum::<f64>() / self.fundamental()
    }

    /// The shape that a rotor shows which turns backward, phases b and c exchanged: -f(-theta).
    #[must_use]
    pub fn reversed(self) -> Self {
        Self {
            cosines: self.cosines.map(|value| -value),
            ..self
        }
    }

    /// Root mean square of a phase.
    pub fn rms(&self) -> f64 {
        self.power(|_| true).sqrt()
    }

    /// Root mean square between two phases: of orders that three divides nothing is left.
    pub fn line_rms(&self) -> f64 {
        (3.0 * self.power(|order| !order.is_multiple_of(3))).sqrt()
    }
}

/// Greatest magnitude of a function that is the opposite half a turn later.
fn greatest(function: impl Fn(f64) -> f64) -> f64 {
    let angles = (0..STEPS).map(|step| PI * f64::from(step) / f64::from(STEPS));
    angles.fold(0.0, |most: f64, theta| most.max(function(theta).abs()))
}

/// What a recorded trace of the EMF between two terminals shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// The shape of a phase's EMF, without the orders that three divides: they do not show between two
    /// terminals.
    pub shape: Harmonics,
    /// Greatest value between the terminals, in the unit of the samples.
    pub peak: f64,
    /// Root mean square of the offset and of even orders over that of the fundamental.
    pub uneven: f64,
    /// The same of the orders that three divides.
    pub triple: f64,
}

impl Trace {
    /// Of samples at equal steps over one electrical period, in forward rotation; `None` where the
    /// fundamental is less than a tenth of the greatest sample.
    pub fn of(samples: &[f64]) -> Option<Self> {
        // Orders from half the number of samples on cannot be told from lower ones.
        let orders = (samples.len().div_ceil(2)).min(2 * ORDERS);
        let parts: Vec<[f64; 2]> = (0..orders).map(|order| part(samples, order)).collect();
        let first = *parts.get(1)?;
        let fundamental = length(first);
        let greatest = samples
            .iter()
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        if fundamental <= greatest / 10.0 {
            return None;
        }
        let share = |is_taken: &dyn Fn(usize) -> bool| {
            let taken = parts
                .iter()
                .enumerate()
                .filter(|(order, _)| is_taken(*order));
            let squares = taken.map(|(order, part)| {
                // A constant has twice the power of an amplitude.
                length(*part).powi(2) * if order == 0 { 2.0 } else { 1.0 }
            });
            squares.sum::<f64>().sqrt() / fundamental
        };
        let uneven = share(&|order| order.is_multiple_of(2));
        let triple = share(&|order| order % 6 == 3);
        // Between phases a and b an order has 2 sin(order 60 degrees) of its amplitude, and the angle of
        // its sine is ahead by 90 degrees less order times 60.
        let ahead = |order: f64| PI / 2.0 - order * PI / 3.0;
        let phase_of = |part: [f64; 2]| part[1].atan2(part[0]);
        let start = phase_of(first) - ahead(1.0);
        let line = |order: f64| 2.0 * (order * PI / 3.0).sin();
        let odd = (3..orders).step_by(2).filter(|order| order % 3 != 0);
        let harmonics = odd.map(|number| {
            let order = number as f64;
            let amplitude = length(parts[number]) / fundamental * (line(1.0) / line(order));
            let phase = phase_of(parts[number]) - ahead(order) - order * start;
            (number as u32, amplitude, phase)
        });
        let shape = Harmonics::of(harmonics);
        let unit = fundamental / line(1.0) / shape.fundamental();
        Some(Self {
            shape,
            peak: unit * shape.line_peak(),
            uneven,
            triple,
        })
    }
}

/// Coefficients of sine and cosine of an order in a trace.
fn part(samples: &[f64], order: usize) -> [f64; 2] {
    let count = samples.len() as f64;
    let weight = if order == 0 { 1.0 } else { 2.0 } / count;
    let terms = samples.iter().enumerate().map(|(place, value)| {
        let (sin, cos) = (TAU * (order * place) as f64 / count).sin_cos();
        [value * sin, value * cos]
    });
    let [sine, cosine] = terms.fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]]);
    [weight * sine, weight * cosine]
}

fn length([sine, cosine]: [f64; 2]) -> f64 {
    sine.hypot(cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATED: [(u32, f64, f64); 3] = [(3, 0.2, 0.3), (5, 0.06, PI), (7, 0.03, 0.8)];

    #[test]
    fn the_series_has_its_amplitudes_and_unit_peak() {
        let shape = Harmonics::of(STATED);
        let unit = shape.fundamental();
        for theta in [-2.0, 0.0, 0.4, 1.5, 9.0] {
            let sum = |of_order: &dyn Fn((u32, f64, f64)) -> f64| {
                STATED.iter().map(|one| of_order(*one)).sum::<f64>()
            };
            let waves = sum(&|(n, share, phase)| share * (f64::from(n) * theta + phase).sin());
            let value = unit * (theta.sin() + waves);
            assert!((shape.at(theta) - value).abs() < 1e-12, "{theta}");
            let slope = (shape.integral(theta + 1e-5) - shape.integral(theta - 1e-5)) / 2e-5;
            assert!((slope - value).abs() < 1e-8, "{theta}");
        }
        let peak = (0..100_000).map(|k| shape.at(f64::from(k) * TAU / 1e5).abs());
        assert!((peak.fold(0.0, f64::max) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn a_trace_gives_the_shape_wherever_it_begins() {
        let stated = Harmonics::of(STATED.into_iter().filter(|(order, ..)| order % 3 != 0));
        for (count, begin) in [(48, 0.0), (101, 1.0), (720, -2.5)] {
            let samples: Vec<f64> = (0..count)
                .map(|k| begin + TAU * f64::from(k) / f64::from(count))
                .map(|theta| 7.5 * (stated.at(theta) - stated.at(theta - THIRD)))
                .collect();
            let trace = Trace::of(&samples).expect("has a fundamental");
            for place in 0..ORDERS {
                let far = (trace.shape.sines[place] - stated.sines[place])
                    .hypot(trace.shape.cosines[place] - stated.cosines[place]);
                assert!(
                    far < 1e-12,
                    "{count} samples, order {}: {far}",
                    2 * place + 1
                );
            }
            assert!((trace.peak - 7.5 * stated.line_peak()).abs() < 1e-9);
            assert!(trace.uneven < 1e-12 && trace.triple < 1e-12, "{trace:?}");
        }
    }

    #[test]
    fn a_trace_of_a_phase_and_one_of_another_length_are_told() {
        let stated = Harmonics::of(STATED);
        let over = |turns: f64, of: &dyn Fn(f64) -> f64| {
            let values: Vec<f64> = (0..200)
                .map(|k| of(turns * TAU * f64::from(k) / 200.0))
                .collect();
            Trace::of(&values)
        };
        let phase = over(1.0, &|theta| stated.at(theta)).expect("has a fundamental");
        assert!((phase.triple - 0.2).abs() < 1e-9, "{phase:?}");
        let line = |theta: f64| stated.at(theta) - stated.at(theta - THIRD);
        let cut = over(0.9, &line).expect("has a fundamental");
        assert!(cut.uneven > 0.05, "{cut:?}");
        let two = over(2.0, &line);
        assert_eq!(two, None);
        assert_eq!(over(1.0, &|_| 0.0), None);
    }
}
