//! The discretised plant i(k+1) = a i(k) + b (v(k) - e(k)) of one phase (`hexagen::conventions`).

use crate::spec::{Discretisation, Spec};

/// Coefficients of the discretised phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscretePhase {
    /// Pole: the share of the current that is left after one period.
    pub a: f64,
    /// Ampere per volt applied for one period.
    pub b: f64,
}

impl DiscretePhase {
    /// The phase of the specified motor at the specified period and discretisation.
    pub fn new(spec: &Spec) -> Self {
        let (r, l, t_s) = (
            spec.motor.resistance,
            spec.motor.inductance,
            spec.inverter.t_s,
        );
        match spec.loop_options().discretisation {
            Discretisation::Exact => {
                let decay = -(-r * t_s / l).exp_m1();
                Self {
                    a: 1.0 - decay,
                    b: decay / r,
                }
            }
            Discretisation::Euler => Self {
                a: 1.0 - r * t_s / l,
                b: t_s / l,
            },
        }
    }
}

/// The limit of the believed change of current, ADC counts, of which so many are possible in one period: a power of two, at
/// least twice as many.
pub fn di_limit(possible: f64) -> f64 {
    (2.0 * possible).log2().ceil().exp2()
}
