//! The discrete-time R-L plant of one phase: i(k+1) = a i(k) + b (v(k) - e(k)).

use crate::spec::Discretisation;

/// Pole and gain of the discrete plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscretePlant {
    /// Pole a, dimensionless, in (0, 1).
    pub pole: f64,
    /// Gain b, ampere per volt.
    pub gain: f64,
}

impl DiscretePlant {
    /// Discretises resistance (ohm) and inductance (henry) for a period `t_s` (seconds).
    pub fn new(method: Discretisation, resistance: f64, inductance: f64, t_s: f64) -> Self {
        let decay = resistance * t_s / inductance;
        match method {
            Discretisation::Exact => {
                // exp_m1 keeps the digits of 1 - a when R Ts/L is small.
                let lost = -(-decay).exp_m1();
                Self {
                    pole: 1.0 - lost,
                    gain: lost / resistance,
                }
            }
            Discretisation::Euler => Self {
                pole: 1.0 - decay,
                gain: t_s / inductance,
            },
        }
    }

    /// The period, in seconds, at which a plant of this resistance and inductance has the `gain`,
    /// ampere per volt.
    pub fn period_of(method: Discretisation, resistance: f64, inductance: f64, gain: f64) -> f64 {
        match method {
            Discretisation::Exact => -(-resistance * gain).ln_1p() * inductance / resistance,
            Discretisation::Euler => gain * inductance,
        }
    }

    /// K = 1/b, volt per ampere: the voltage over one period that changes the current by 1 A.
    pub fn stiffness(self) -> f64 {
        1.0 / self.gain
    }
}
