//! Numbers of the predictive laws in SI units.

use super::emf::OBSERVER_GAIN;
use crate::design::DiscretePlant;
use crate::scaling::Scaled;
use crate::spec::{EmfShape, LoopOptions, Spec};
use std::f64::consts::{FRAC_PI_6, PI};

/// Coefficients of prediction, EMF estimate and deadbeat voltage (shared semantics page), SI.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopDesign {
    /// Discrete plant.
    pub plant: DiscretePlant,
    /// K = 1/b, V/A: weight of the current difference in the EMF estimate, and of the reference.
    pub k_di: f64,
    /// (1 - a)/b = R, ohm.
    pub k_r: f64,
    /// K a^2 (delay 1) or K a (delay 0), V/A: weight of the present current in the deadbeat
    /// voltage.
    pub k_hold: f64,
    /// 1 - a.
    pub k_decay: f64,
    /// Largest plausible change of current per period, ampere: twice the one of the largest bus or
    /// of the ADC's range, rounded up to a power of two of ADC counts for a saturating instruction.
    pub di_limit: f64,
    /// Largest plausible zero-sum phase EMF, volt: one and a half times that of the greatest speed, up to the next
    /// power of two of timer counts, at which a saturating instruction limits.
    pub e_limit: f64,
    /// Limit of the modelled EMF's error, volt: half the largest bus, up to the next power of two of
    /// timer counts, at which a saturating instruction limits.
    pub emf_error_limit: f64,
    /// Greatest gain of the observer.
    pub observer_gain: f64,
    /// Motion of an estimated EMF in one period per product of two line EMFs, 1/V; of a sine, the
    /// tangent of its turn over sqrt(3), per line EMF.
    pub slope: f64,
    /// Line EMF above which that motion no longer grows, volt.
    pub line_limit: f64,
}

/// Largest advance per period, radian, of an estimate with the filter share `filter`, such that its
/// errors shrink. The linearised motion of a trapezoid amplifies them by sqrt(1 + 2 angle^2). A
/// sine turned to second order grows by angle^4/8, and an error of its length, from which the speed
/// is taken, by 5/8 angle^4.
fn greatest_turn(shape: EmfShape, filter: f64) -> f64 {
    let growth = 1.0 / (1.0 - filter);
    let turn = match shape {
        EmfShape::Sinusoidal | EmfShape::Harmonics(_) => (1.6 * (growth - 1.0)).powf(0.25),
        EmfShape::Trapezoidal { .. } => ((growth.powi(2) - 1.0) / 2.0).sqrt(),
    };
    turn.min(0.5)
}

/// Greatest length of the proportional current per ampere of set-point.
fn longest_shape(spec: &Spec) -> f64 {
    let motor = &spec.motor;
    2.0 / 3.0 * spec.torque_constant() / motor.emf_constant / motor.emf_shape.least_length()
}

impl LoopDesign {
    /// The longest period of whole timer counts with a plant gain b of at most `gain`, seconds.
    pub fn longest_period(spec: &Spec, gain: f64) -> f64 {
        let (motor, method) = (&spec.motor, spec.controller.common().discretisation);
        let limit = DiscretePlant::period_of(method, motor.resistance, motor.inductance, gain);
        spec.inverter.period_within(limit)
    }

    /// Designs the law for a checked specification.
    pub fn new(spec: &Spec, options: &LoopOptions) -> Self {
        let (motor, inverter) = (&spec.motor, &spec.inverter);
        let plant = DiscretePlant::new(
            options.discretisation,
            motor.resistance,
            motor.inductance,
            inverter.t_s,
        );
        let k_di = plant.stiffness();
        let hold = plant.pole.powi(if options.delay == 1 { 2 } else { 1 });
        let (shape, electrical) = (motor.emf_shape, f64::from(motor.pole_pairs) * inverter.t_s);
        let line = shape.quasi_square_factor() * motor.emf_constant;
        let count = inverter.adc_gain.abs();
        let volt = inverter.v_bus / f64::from(inverter.timer_period);
        let span = f64::from((1_u32 << inverter.adc_bits) - 1);
        let saturated = |volts: f64| (volts / volt).log2().ceil().exp2() * volt;
        let possible = plant.gain * 4.0 / 3.0 * inverter.greatest_bus() / count;
        Self {
            plant,
            k_di,
            k_r: (1.0 - plant.pole) / plant.gain,
            k_hold: k_di * hold,
            k_decay: 1.0 - plant.pole,
            di_limit: (2.0 * possible.min(span)).log2().ceil().exp2() * count,
            e_limit: saturated(1.5 * motor.emf_constant * inverter.maximum_speed),
            emf_error_limit: saturated(inverter.greatest_bus() / 2.0),
            observer_gain: OBSERVER_GAIN * longest_shape(spec).powi(2),
            slope: match shape {
                EmfShape::Sinusoidal | EmfShape::Harmonics(_) => electrical / (3f64.sqrt() * line),
                EmfShape::Trapezoidal { .. } => {
                    let turn = electrical / (shape.quasi_square_factor() * line);
                    2.0 / PI * shape.at(FRAC_PI_6) * turn
                }
            },
            line_limit: line * greatest_turn(shape, options.emf_filter) / electrical,
        }
    }

    /// The same design with the rounded coefficients.
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
            k_decay: held("k_decay", 1.0, held("k_fade", -1.0, self.k_decay)),
            ..self.clone()
        }
    }
}
