//! PI control: proportional part, integral and EMF feed-forward, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::dead_time::DeadTime;
use super::intervals::{Modulated, Table2};
use super::{Decision, Inputs, pulses};
use crate::model::ideal::vector::{clarke, phases, to_ab};
use crate::model::variant::Variant;
use crate::model::{Reach, sector};
use crate::{Error, Saturation, Spec, Switch};
use nalgebra::{Vector2, Vector3};
use std::f64::consts::TAU;

#[derive(Clone, Copy, Debug)]
pub struct PiPwm {
    /// One controller for the pair.
    six_step: bool,
    saturation: Saturation,
    /// The voltage that turns the reference is fed forward.
    turning: bool,
    /// Proportional gain, V/A.
    k_p: f64,
    /// Share of the proportional voltage that is integrated per period.
    k_i: f64,
    /// Largest integral, volt.
    integral_max: f64,
    dead_time: DeadTime,
    /// Of three pulsed legs, or of the pair, of which one is low throughout as of vectors.
    legs: CommonModeRule,
    table2: Option<Table2>,
}

impl PiPwm {
    pub fn new(spec: &Spec, options: &crate::PiPwm) -> Result<Self, Error> {
        Ok(Self {
            six_step: options.six_step == Switch::On,
            saturation: options.saturation,
            turning: Variant::new(spec).turns_reference(),
            k_p: TAU * options.bandwidth * spec.motor.inductance,
            k_i: spec.inverter.t_s / options.integral_time,
            dead_time: DeadTime::new(spec, options.six_step == Switch::Off),
            legs: match options.six_step {
                Switch::On => CommonModeRule::of_vectors(spec)?,
                Switch::Off => CommonModeRule::new(spec, options.common_mode)?,
            },
            integral_max: spec.inverter.v_bus_max()?,
            table2: Table2::of(spec, options.modulation, (options.saturation, options.zero))?,
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        if self.six_step {
            return self.decide_pair(now);
        }
        let (i_due, forward) = if self.turning {
            let led = (now.i_ref - now.i_begin * now.phase.a) / now.phase.b;
            (now.i_due, now.e + led)
        } else {
            (now.i_ref, now.e)
        };
        let p = (i_due - now.i) * self.k_p;
        let u_unsat = p + now.integral + forward;
        let Modulated { u, reach, command } = match &self.table2 {
            Some(table2) => table2.modulate(now, &u_unsat, &now.e),
            None => self.pulses(now, &u_unsat),
        };
        let integral = now.integral + (p + u - u_unsat) * self.k_i;
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command,
            integral: to_ab(&integral).map(|s_x| s_x.clamp(-self.integral_max, self.integral_max)),
            rises: now.rises,
            past: now.past,
        }
    }

    /// The limited voltage by three pulses.
    fn pulses(&self, now: &Inputs, u_unsat: &Vector2<f64>) -> Modulated {
        let limited = self.legs.limited(now, self.saturation, u_unsat, &now.e);
        let shifts = self.dead_time.shifts(now, 1.0, limited.spread);
        Modulated {
            u: clarke(&limited.u),
            reach: limited.reach,
            command: pulses::three(now, &limited.u, &shifts, self.legs),
        }
    }

    /// One controller of the conducting pair's current.
    fn decide_pair(&self, now: &Inputs) -> Decision {
        let i = phases(&now.i);
        let ends = (now.sector_eff != 0)
            .then(|| (sector::PLUS[now.sector_eff], sector::MINUS[now.sector_eff]));
        let pair_current = ends.map_or(0.0, |(plus, minus)| (i[plus] - i[minus]) / 2.0);
        let [held, _] = to_ab(&now.integral);
        let part = (now.set_point - pair_current) * self.k_p;
        let u = part + held;
        let reach = self.legs.reach(now.v_bus);
        let line = (2.0 * u).clamp(-reach, reach);
        let integral = (held + (part + line / 2.0 - u) * self.k_i)
            .clamp(-self.integral_max, self.integral_max);
        let of_pair = |u: f64| {
            let mut of_pair = Vector3::zeros();
            if let Some((plus, minus)) = ends {
                (of_pair[plus], of_pair[minus]) = (u, -u);
            }
            clarke(&of_pair)
        };
        Decision {
            u_unsat: of_pair(u),
            u: of_pair(line / 2.0),
            reach: if line == 2.0 * u {
                Reach::Inside
            } else {
                Reach::Outside
            },
            vector: 0,
            command: pulses::line(now, line, &self.dead_time.shifts(now, 1.0, 0.0), self.legs),
            integral: [integral, 0.0],
            rises: now.rises,
            past: now.past,
        }
    }
}
