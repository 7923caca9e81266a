//! The speed controller (section "Speed loop").

use super::constants::Constants;
use super::fade::limited;
use super::scale::Scale;
use crate::exact::{
    Coefficient, Word, floor, floor_constant, floor_weighted, input, pow2, within, word,
};
use crate::model::variant::reference_gain;
use crate::{Error, Spec};
use std::f64::consts::TAU;

/// Constants of the controller.
#[derive(Clone, Debug)]
pub struct Regulator<W> {
    k_rpm: Coefficient<W>,
    k_speed: Coefficient<W>,
    k_speed_share: Coefficient<W>,
    max_bits: f64,
    error_max: f64,
    /// J_TOP.
    pub top: W,
    /// The same for the integral.
    integral_top: W,
    /// 2^-n.
    to_voltage: f64,
    /// Ampere per word of the integral.
    pub ampere: f64,
}

impl<W: Word> Regulator<W> {
    /// `None` without a speed loop.
    pub fn new(spec: &Spec, scale: &Scale, k: &Constants<W>) -> Result<Option<Self>, Error> {
        if !scale.variant.options.has_speed_loop() {
            return Ok(None);
        }
        let (motor, inverter, options) = (&spec.motor, &spec.inverter, spec.loop_options());
        let bandwidth = TAU * options.speed_bandwidth;
        let tick = inverter.t_s / inverter.ticks;
        let unit = TAU / (pow2(32) * tick * f64::from(motor.pole_pairs));
        let gain = bandwidth * options.inertia / motor.torque_constant;
        let stiffness = reference_gain(spec);
        let extra = scale.extra_bits("speed_integral")?;
        let share = bandwidth * inverter.t_s / 4.0;
        let top = k.k_set.mul(word(k.i_max_bits));
        Ok(Some(Self {
            k_rpm: scale.coefficient("k_rpm", TAU / 60.0 / unit / 65_536.0)?,
            k_speed: scale
                .coefficient("k_speed", gain * unit * stiffness / scale.w * scale.two_v)?,
            k_speed_share: scale.coefficient("k_speed_share", share * pow2(extra))?,
            max_bits: floor_constant(60.0 * inverter.omega_max / TAU * 65_536.0)
                .min(2_147_483_647.0),
            error_max: floor_constant(2.0 * inverter.max_current / (gain * unit)).min(pow2(30)),
            top,
            integral_top: top * pow2(extra),
            to_voltage: pow2(-extra),
            ampere: k.volt * pow2(-extra) / stiffness,
        }))
    }

    /// `speed_ref` of a speed in rpm, bits of an `I16F16`.
    pub fn reference(&self, bits: i32) -> W {
        self.k_rpm
            .mul(within(input(bits), -self.max_bits, self.max_bits))
    }

    /// The set-point, within +-`most` and the limits of the bus, and the integral after the step.
    #[inline]
    pub fn regulate(
        &self,
        (reference, speed): (W, W),
        most: W,
        allowed: [Option<W>; 2],
        integral: W,
    ) -> (W, W) {
        let error = within(reference - speed, -self.error_max, self.error_max);
        let part = self.k_speed.mul(error);
        let open = part + floor_weighted(integral, self.to_voltage);
        let j = limited(allowed, within(open, -most.abs(), most.abs()));
        let moved = integral + self.k_speed_share.mul(part + (j - open) * 4.0);
        (
            j,
            floor(within(moved, -self.integral_top, self.integral_top)),
        )
    }
}
