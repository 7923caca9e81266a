//! Stability of linear current loops: closed-loop poles on a plant whose R and L are not the model's.

use super::LoopDesign;
use crate::design::DiscretePlant;
use crate::spec::Spec;
use nalgebra::{DMatrix, DVector};

/// Stable ranges of true over stated inductance and resistance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableRange {
    /// Of the inductance.
    pub inductance: (f64, f64),
    /// Of the resistance.
    pub resistance: (f64, f64),
}

/// A linear loop without EMF and reference: one period of state `x` on the given plant.
pub trait LinearLoop {
    /// Length of the state.
    fn order(&self) -> usize;
    /// The state a period later.
    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64>;

    /// Spectral radius on a plant with `resistance_ratio` and `inductance_ratio` times the motor's
    /// R and L (per axis; EMF as a disturbance).
    fn spectral_radius(&self, spec: &Spec, resistance_ratio: f64, inductance_ratio: f64) -> f64 {
        // The plant is physical whatever the model's discretisation: its own discretisation is exact.
        let real = DiscretePlant::new(
            crate::spec::Discretisation::Exact,
            (spec.motor.resistance * resistance_ratio).max(1e-9),
            spec.motor.inductance * inductance_ratio,
            spec.inverter.t_s,
        );
        let order = self.order();
        let columns: Vec<DVector<f64>> = (0..order)
            .map(|axis| {
                let unit = DVector::from_fn(order, |row, _| f64::from(u8::from(row == axis)));
                self.advance(real, &unit)
            })
            .collect();
        let matrix = DMatrix::from_columns(&columns);
        matrix
            .complex_eigenvalues()
            .iter()
            .map(|pole| pole.norm())
            .fold(0.0, f64::max)
    }

    /// The ranges of true over stated R and L within which the loop is stable, one off at a time,
    /// searched from 0.1 to 10.
    fn stable_range(&self, spec: &Spec) -> StableRange {
        StableRange {
            inductance: stable_interval(|ratio| self.spectral_radius(spec, 1.0, ratio)),
            resistance: stable_interval(|ratio| self.spectral_radius(spec, ratio, 1.0)),
        }
    }
}

/// What an estimate of the EMF that takes over a share of what is seen makes of current and voltage alone: at
/// standstill, where it does not move on.
pub fn estimate(share: f64, design: &LoopDesign, i: [f64; 2], v_prev: f64, e_prev: f64) -> f64 {
    let seen = v_prev - design.k_di * (i[0] - i[1]) - design.k_r * i[1];
    // A share of 0 says that nothing is estimated.
    if share > 0.0 {
        e_prev + share * (seen - e_prev)
    } else {
        0.0
    }
}

/// The interval around 1 where `radius` stays below 1, between 0.1 and 10, to 1e-4 relative.
fn stable_interval(radius: impl Fn(f64) -> f64) -> (f64, f64) {
    if radius(1.0) >= 1.0 {
        return (1.0, 1.0);
    }
    let search = |direction: f64| {
        let (mut inside, mut outside) = (1.0_f64, 1.0_f64);
        while radius(outside) < 1.0 {
            inside = outside;
            outside *= 1.02_f64.powf(direction);
            if !(0.1..=10.0).contains(&outside) {
                return outside.clamp(0.1, 10.0);
            }
        }
        while (outside / inside - 1.0).abs() > 1e-4 {
            let middle = (inside * outside).sqrt();
            if radius(middle) < 1.0 {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    };
    (search(-1.0), search(1.0))
}
