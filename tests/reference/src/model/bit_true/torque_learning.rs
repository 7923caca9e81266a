//! Learning of the torque constant (section "Learning of the torque constant").

use super::scale::Scale;
use super::state::{State, Torque};
use crate::emf_shape::EmfShape;
use crate::exact::{Coefficient, Shift, Word, either, lesser, pow2, round_half_up, within, word};
use crate::model::variant::{LITTLE, SETTLED, flux_along, reference_gain};
use crate::spec::Switch;
use crate::{Error, Spec};
use std::f64::consts::TAU;

impl<W: Word> Torque<W> {
    /// Bits of a torque, in those of the stated constant.
    #[inline]
    pub fn scaled(&self, bits: W) -> W {
        Shift::new(28).round_product(self.ratio, within(bits, -pow2(30), pow2(30)))
    }
}

/// Constants of the learning.
#[derive(Clone, Debug)]
pub struct TorqueLearning<W> {
    along: Coefficient<W>,
    learn: Coefficient<W>,
    little: Coefficient<W>,
    free: Coefficient<W>,
    least: f64,
    limits: [f64; 2],
    product: Shift,
}

impl<W: Word> TorqueLearning<W> {
    /// `None` without `torque_learning`.
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Option<Self>, Error> {
        if spec.loop_options().torque_learning == Switch::Off {
            return Ok(None);
        }
        let words = |volts: f64| volts / scale.w * scale.two_v;
        let speed = TAU / pow2(32) / spec.inverter.t_s;
        let v_bus = spec.inverter.v_bus;
        let flux = flux_along(spec, &EmfShape::new(&spec.motor)?);
        let little = LITTLE * spec.motor.resistance / reference_gain(spec);
        Ok(Some(Self {
            along: scale.coefficient("k_along", words(flux) * speed)?,
            learn: scale.coefficient("k_learn", pow2(28) / 64.0 / words(v_bus))?,
            little: scale.coefficient("k_little", little)?,
            free: scale.coefficient("k_free", 0.85 / 3_f64.sqrt())?,
            least: round_half_up(words(v_bus / 16.0)),
            limits: [2.0 / 3.0, 1.5].map(|ratio| round_half_up(ratio * pow2(28))),
            product: Shift::new(28),
        }))
    }

    /// The ratio behind a period, from the EMF's error along the shape in the last one.
    #[inline]
    pub fn learn(&self, state: &State<W>, step_angle: W) -> W {
        let old = state.torque.ratio;
        if state.timing.edges < 2 || state.torque.light < SETTLED {
            return old;
        }
        let emf = self.along.mul(step_angle);
        let beyond = emf - self.product.floor_product(emf + state.emf_error[0], old);
        let beyond = either(step_angle >= 0.0, beyond, -beyond);
        within(old + self.learn.mul(beyond), self.limits[0], self.limits[1])
    }

    /// Periods in a row behind this one in which the EMF tells the constant; `error`: its error along the shape,
    /// `v_bus`: `None` while the bus voltage is stale.
    #[inline]
    pub fn count(&self, light: W, [j, error]: [W; 2], v_bus: Option<W>, step_angle: W) -> W {
        let Some(v_bus) = v_bus else {
            return word(0.0);
        };
        let drop = self.little.mul(j.abs()) + self.least;
        let emf = self.along.mul(step_angle);
        let is_light = emf.abs() > drop;
        let is_free = self.free.mul(v_bus) > (emf + error).abs();
        either(is_light && is_free, lesser(light + 1.0, SETTLED), word(0.0))
    }
}
