//! Learning of the torque constant (section "Learning of the torque constant").

use crate::emf_shape::EmfShape;
use crate::model::variant::{LITTLE, SETTLED, flux_along};
use crate::spec::Switch;
use crate::{Error, Spec};

/// What is learnt of the torque constant.
#[derive(Clone, Copy, Debug)]
pub struct LearntTorque {
    /// Stated over learnt constant.
    pub ratio: f64,
    /// Periods of little current in a row.
    pub light: f64,
}

impl Default for LearntTorque {
    fn default() -> Self {
        Self {
            ratio: 1.0,
            light: 0.0,
        }
    }
}

/// What the EMF tells.
#[derive(Clone, Copy, Debug)]
pub struct TorqueLearning {
    /// Modelled EMF along the shape per angle of a period, volt per radian.
    along: f64,
    /// Volt per ampere of the set-point that the EMF must exceed.
    little: f64,
    /// Nominal.
    v_bus: f64,
}

impl TorqueLearning {
    /// `None` without `torque_learning`.
    pub fn new(spec: &Spec) -> Result<Option<Self>, Error> {
        if spec.loop_options().torque_learning == Switch::Off {
            return Ok(None);
        }
        let flux = flux_along(spec, &EmfShape::new(&spec.motor)?);
        Ok(Some(Self {
            along: flux / spec.inverter.t_s,
            little: LITTLE * spec.motor.resistance,
            v_bus: spec.inverter.v_bus,
        }))
    }

    /// The ratio behind a period; `error`: the EMF's along the shape in the last one.
    pub fn learn(&self, learnt: LearntTorque, error: f64, step_angle: f64) -> f64 {
        if learnt.light < SETTLED {
            return learnt.ratio;
        }
        let emf = self.along * step_angle;
        let beyond = emf - (emf + error) * learnt.ratio;
        let rise = step_angle.signum() * beyond / (64.0 * self.v_bus);
        (learnt.ratio + rise).clamp(2.0 / 3.0, 1.5)
    }

    /// Periods of little current in a row behind this one; `v_bus`: `None` while the bus voltage is stale.
    pub fn count(
        &self,
        light: f64,
        [current, error]: [f64; 2],
        v_bus: Option<f64>,
        step_angle: f64,
    ) -> f64 {
        let Some(v_bus) = v_bus else {
            return 0.0;
        };
        let drop = self.little * current.abs() + self.v_bus / 16.0;
        let emf = self.along * step_angle;
        let is_light = emf.abs() > drop;
        if is_light && (emf + error).abs() < 0.85 / 3_f64.sqrt() * v_bus {
            (light + 1.0).min(SETTLED)
        } else {
            0.0
        }
    }
}
