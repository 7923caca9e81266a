//! Numbers of the deadbeat law in SI units, and the range of R and L in which its loop is stable.

use super::{EmfSource, PdccSpec};
use crate::design::DiscretePlant;
use crate::scaling::Scaled;
use crate::spec::Spec;
use nalgebra::{DMatrix, DVector};

/// Coefficients of the deadbeat law (semantics page), SI.
#[derive(Clone, Debug, PartialEq)]
pub struct PdccDesign {
    /// Discrete plant.
    pub plant: DiscretePlant,
    /// K = 1/b, V/A: weight of the current difference in the EMF estimate, and of the reference.
    pub k_di: f64,
    /// (1 - a)/b = R, ohm.
    pub k_r: f64,
    /// K a^2 (delay 1) or K a (delay 0), V/A: what the present current costs.
    pub k_hold: f64,
    /// 1 - a.
    pub k_decay: f64,
    /// Largest believed current change per period, ampere: twice what the largest bus can do.
    pub di_max: f64,
    /// Largest believed zero-sum phase EMF, volt.
    pub e_limit: f64,
}

impl PdccDesign {
    /// Designs the law for a checked specification.
    pub fn new(spec: &Spec, options: &PdccSpec) -> Self {
        let (motor, inverter) = (&spec.motor, &spec.inverter);
        let plant = DiscretePlant::new(
            options.discretisation,
            motor.resistance,
            motor.inductance,
            inverter.t_s,
        );
        let k_di = plant.stiffness();
        let hold = plant.pole.powi(if options.delay == 1 { 2 } else { 1 });
        let adc_span = f64::from((1_u32 << inverter.adc_bits) - 1) * inverter.adc_gain.abs();
        Self {
            plant,
            k_di,
            k_r: (1.0 - plant.pole) / plant.gain,
            k_hold: k_di * hold,
            k_decay: 1.0 - plant.pole,
            di_max: (2.0 * adc_span).min(2.0 * plant.gain * 4.0 / 3.0 * inverter.greatest_bus()),
            e_limit: 1.5 * motor.emf_constant * inverter.maximum_speed,
        }
    }

    /// The same design with the coefficients as they were rounded.
    #[must_use]
    pub fn rounded(&self, scaled: &Scaled) -> Self {
        let volt_per_ampere = scaled.scale.current() / scaled.scale.voltage();
        let held = |name: &str, unit: f64, exact: f64| {
            let constant = scaled
                .graph
                .program()
                .constants
                .iter()
                .find(|constant| constant.name == name);
            let format = scaled.formats.iter().find(|format| format.name == name);
            match (constant, format) {
                (Some(constant), Some(format)) => {
                    f64::from(constant.raw) / f64::from(format.frac_bits).exp2() * unit
                }
                _ => exact,
            }
        };
        Self {
            k_di: held("k_di", volt_per_ampere, self.k_di),
            k_r: held("k_r", volt_per_ampere, self.k_r),
            k_hold: held("k_hold", volt_per_ampere, self.k_hold),
            k_decay: held("k_decay", 1.0, self.k_decay),
            ..self.clone()
        }
    }

    /// Spectral radius of the current loop on a plant with `resistance_ratio` and `inductance_ratio`
    /// times the model's R and L (per axis; EMF as a disturbance).
    pub fn spectral_radius(
        &self,
        spec: &Spec,
        options: &PdccSpec,
        resistance_ratio: f64,
        inductance_ratio: f64,
    ) -> f64 {
        // The plant is physical whatever the model's discretisation: its own discretisation is exact.
        let real = DiscretePlant::new(
            crate::design::Discretisation::Exact,
            (spec.motor.resistance * resistance_ratio).max(1e-9),
            spec.motor.inductance * inductance_ratio,
            spec.inverter.t_s,
        );
        let step = |x: &DVector<f64>| self.loop_step(options, real, x);
        let order = 5;
        let columns: Vec<DVector<f64>> = (0..order)
            .map(|axis| {
                step(&DVector::from_fn(order, |row, _| {
                    f64::from(u8::from(row == axis))
                }))
            })
            .collect();
        let matrix = DMatrix::from_columns(&columns);
        matrix
            .complex_eigenvalues()
            .iter()
            .map(|pole| pole.norm())
            .fold(0.0, f64::max)
    }

    /// One period of the loop without EMF and reference; state i, i_prev, v_now, v_prev, e_prev.
    fn loop_step(&self, options: &PdccSpec, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
        let [i, i_prev, v_now, v_prev, e_prev] = [x[0], x[1], x[2], x[3], x[4]];
        let e = match options.emf {
            EmfSource::Model => 0.0,
            EmfSource::Estimated => {
                let seen = v_prev - self.k_di * (i - i_prev) - self.k_r * i_prev;
                e_prev + options.emf_filter * (seen - e_prev)
            }
        };
        if options.delay == 1 {
            let u = -self.k_hold * i + self.k_decay * (v_now - e) + 2.0 * e - v_now;
            DVector::from_vec(vec![real.pole * i + real.gain * v_now, i, u, v_now, e])
        } else {
            let u = -self.k_hold * i + e;
            DVector::from_vec(vec![real.pole * i + real.gain * u, i, 0.0, u, e])
        }
    }

    /// The stable interval of true over model inductance at nominal resistance, searched from 0.1 to 10.
    pub fn stable_inductance(&self, spec: &Spec, options: &PdccSpec) -> (f64, f64) {
        stable_interval(|ratio| self.spectral_radius(spec, options, 1.0, ratio))
    }

    /// The stable interval of true over model resistance at nominal inductance, searched from 0.1 to 10.
    pub fn stable_resistance(&self, spec: &Spec, options: &PdccSpec) -> (f64, f64) {
        stable_interval(|ratio| self.spectral_radius(spec, options, ratio, 1.0))
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
