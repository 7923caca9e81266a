//! Rotation of an estimated EMF from period to period (section 8 of the semantics).

use crate::emf_shape::THIRD;
use crate::{EmfShape, Error, Spec};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_6, PI};

/// The rotation in physical units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmfMotion {
    /// The EMF turns (a sine); otherwise the off phase's EMF goes from one flat top to the other.
    pub turns: bool,
    /// c: motion in one period per product of two line EMFs, 1/V; of a sine, turn over sqrt(3) per
    /// line EMF.
    pub per_product: f64,
    /// Line EMF above which the motion no longer grows, volt.
    pub line_limit: f64,
}

impl EmfMotion {
    /// The motion of a drive's EMF.
    ///
    /// # Errors
    /// If the shape is inconsistent.
    pub fn new(spec: &Spec) -> Result<Self, Error> {
        let motor = &spec.motor;
        let shape = EmfShape::new(motor)?;
        // h: the mean of a minus b while these two conduct, from 30 to 90 degrees.
        let area =
            |theta: f64| shape.zero_sum_integral(theta) - shape.zero_sum_integral(theta - THIRD);
        let h = (area(FRAC_PI_2) - area(FRAC_PI_6)) * (3.0 / PI);
        let turn_per_speed = f64::from(motor.pole_pairs) * spec.inverter.t_s;
        let speed_per_line = 1.0 / (h * motor.emf_constant);
        let turns = shape.turns();
        let per_turn = if turns {
            1.0 / 3f64.sqrt()
        } else {
            // A third of twice the EMF at the sector's edge, over a sixth of a turn, per line EMF.
            2.0 / 3.0 * shape.unit(FRAC_PI_6) / h / (PI / 3.0)
        };
        let kept = 1.0 - spec.loop_options().emf_filter;
        let turn_max = match (kept > 0.0, turns) {
            (false, _) => 0.5,
            (true, true) => (8.0 / 5.0 * (1.0 - kept) / kept).sqrt().sqrt().min(0.5),
            (true, false) => ((kept.powi(-2) - 1.0) / 2.0).sqrt().min(0.5),
        };
        Ok(Self {
            turns,
            per_product: per_turn * turn_per_speed * speed_per_line,
            line_limit: turn_max / (turn_per_speed * speed_per_line),
        })
    }
}
