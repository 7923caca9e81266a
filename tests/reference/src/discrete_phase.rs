//! The discretised plant i(k+1) = a i(k) + b (v(k) - e(k)) of one phase (`hexagen::conventions`).

use crate::Error;
use crate::spec::{Discretisation, Inverter, Spec};

/// Coefficients of the discretised phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscretePhase {
    /// Pole: the fraction of the current left after one period.
    pub a: f64,
    /// Amperes per volt applied for one period.
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

    /// The limit of the plausible current change in one period, ADC counts: a power of two, at
    /// least twice the change possible with the largest bus or within the ADCs' range.
    ///
    /// # Errors
    /// If the specification of the bus is inconsistent.
    pub fn di_limit(&self, inverter: &Inverter) -> Result<f64, Error> {
        let span = f64::from((1_u32 << inverter.adc_bits) - 1);
        let possible = self.b * 4.0 / 3.0 * inverter.v_bus_max()? / inverter.adc_gain.first().abs();
        Ok((2.0 * possible.min(span)).log2().ceil().exp2())
    }
}
