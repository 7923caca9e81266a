//! PI control: proportional part, integral and EMF feed-forward, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::dead_time::DeadTime;
use super::intervals::{Modulated, Table2};
use super::{Decision, Inputs, pulses};
use crate::exact::{Coefficient, Word, both, halve, round_half_up, within, word};
use crate::model::bit_true::limit::Limited;
use crate::model::bit_true::scale::Scale;
use crate::model::{Reach, sector};
use crate::{DiscretePhase, Error, Saturation, Spec, Switch};
use std::f64::consts::TAU;

#[derive(Clone, Debug)]
pub struct PiPwm<W> {
    /// One controller for the pair.
    six_step: bool,
    saturation: Saturation,
    k_drop: Coefficient<W>,
    turning: Option<Turning<W>>,
    k_i: Coefficient<W>,
    integral_range: [f64; 2],
    dead_time: DeadTime<W>,
    /// Of three pulsed legs, or of the pair.
    legs: CommonModeRule<W>,
    table2: Option<Table2<W>>,
}

/// Coefficients of a reference that turns.
#[derive(Clone, Debug)]
struct Turning<W> {
    /// `k_due`.
    due: Coefficient<W>,
    /// `k_lead`.
    lead: Coefficient<W>,
    /// `k_di`, of the dead-time compensation.
    di: Coefficient<W>,
}

impl<W: Word> Turning<W> {
    fn new(spec: &Spec, k_p: f64, scale: &Scale) -> Result<Option<Self>, Error> {
        if !scale.variant.turns_reference() {
            return Ok(None);
        }
        let DiscretePhase { a, b } = DiscretePhase::new(spec);
        let compensates = scale.variant.compensates();
        Ok(Some(Self {
            due: scale.coefficient("k_due", k_p * b)?,
            lead: scale.coefficient("k_lead", -a)?,
            di: scale.only_if(compensates, "k_di", scale.ohm / b)?,
        }))
    }
}

impl<W: Word> PiPwm<W> {
    pub fn new(spec: &Spec, options: &crate::PiPwm, scale: &Scale) -> Result<Self, Error> {
        let bus = round_half_up(spec.inverter.v_bus_max()? / scale.w * scale.two_v);
        let integral_range = if options.feed_forward == Switch::On {
            [-bus, bus]
        } else {
            let limit = bus.log2().ceil().exp2();
            [-limit, limit - 1.0]
        };
        let k_p = TAU * options.bandwidth * spec.motor.inductance;
        Ok(Self {
            six_step: options.six_step == Switch::On,
            saturation: options.saturation,
            k_drop: scale.coefficient("k_drop", -scale.ohm * k_p)?,
            turning: Turning::new(spec, k_p, scale)?,
            k_i: scale.coefficient("k_i", spec.inverter.t_s / options.integral_time)?,
            dead_time: DeadTime::new(spec, options.six_step == Switch::Off, scale)?,
            legs: match options.six_step {
                Switch::On => CommonModeRule::of_pair(spec, true, scale)?,
                Switch::Off => CommonModeRule::new(spec, options.common_mode, scale)?,
            },
            integral_range,
            table2: Table2::of(
                spec,
                options.modulation,
                (options.saturation, options.zero),
                scale,
            )?,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        if self.six_step {
            return self.decide_pair(now);
        }
        // 9; without feed-forward the EMF is 0.
        let drop = both(|x| self.k_drop.mul(now.i[x]));
        let (due, forward) = match &self.turning {
            Some(turning) => (
                now.j_due.map(|j_x| turning.due.mul(j_x)),
                both(|x| now.e[x] + now.j[x] + turning.lead.mul(now.j_begin[x])),
            ),
            None => (now.j, now.e),
        };
        let p = both(|x| due[x] + drop[x]);
        let u_unsat = both(|x| p[x] + now.integral[x] + forward[x]);
        // 10, 11
        let flow = match &self.turning {
            Some(turning) => both(|x| turning.di.mul(now.i[x])),
            None => drop.map(|drop| -drop),
        };
        let Modulated { u, reach, command } = match &self.table2 {
            Some(table2) => table2.modulate(now, u_unsat, now.e),
            None => self.pulses(now, u_unsat, flow),
        };
        // 12
        let [low, high] = self.integral_range;
        let integral = both(|x| {
            let distance = u[x] - forward[x] - now.integral[x];
            let moved = now.integral[x] + self.k_i.mul(distance);
            within(moved, low, high)
        });
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command,
            integral,
            hysteresis: now.hysteresis,
            past: now.past,
        }
    }

    /// The limited voltage by three pulses.
    #[inline]
    fn pulses(&self, now: &Inputs<W>, u_unsat: [W; 2], flow: [W; 2]) -> Modulated<W> {
        let Limited {
            u,
            legs,
            reach,
            spread,
        } = self.legs.limited(now, self.saturation, u_unsat, now.e);
        let shifts = self.dead_time.shifts(now, flow, spread);
        let (command, _) = pulses::three(now, legs, shifts, &self.legs, false);
        Modulated { u, reach, command }
    }

    /// One controller of the conducting pair's current.
    fn decide_pair(&self, now: &Inputs<W>) -> Decision<W> {
        // 9
        let i = [now.i[0], now.i[1], -(now.i[0] + now.i[1])];
        let ends = (now.sector_eff != 0)
            .then(|| (sector::PLUS[now.sector_eff], sector::MINUS[now.sector_eff]));
        let pair_current = ends.map_or(word(0.0), |(plus, minus)| halve(i[plus]) - halve(i[minus]));
        let flow = both(|x| -self.k_drop.mul(now.i[x]));
        let part = now.set_point + self.k_drop.mul(pair_current);
        let u = part + now.integral[0];
        // 10
        let line_reach = self.legs.reach(now.v_bus);
        let line = within(u * 2.0, -line_reach, line_reach);
        // 12
        let limited = halve(line);
        let [low, high] = self.integral_range;
        let moved = now.integral[0] + self.k_i.mul(limited - now.integral[0]);
        let integral = within(moved, low, high);
        let phases = |u: W| {
            let mut phases = [word(0.0); 3];
            if let Some((plus, minus)) = ends {
                (phases[plus], phases[minus]) = (u, -u);
            }
            [phases[0], phases[1]]
        };
        Decision {
            u_unsat: phases(u),
            u: phases(limited),
            reach: if line == u * 2.0 {
                Reach::Inside
            } else {
                Reach::Outside
            },
            vector: 0,
            command: pulses::line(
                now,
                line,
                self.dead_time.shifts(now, flow, word(0.0)),
                &self.legs,
            ),
            integral: [integral, word(0.0)],
            hysteresis: now.hysteresis,
            past: now.past,
        }
    }
}
