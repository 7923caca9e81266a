//! PI control: proportional part, integral and EMF feed-forward, limited and pulsed.

use super::common_mode::CommonModeRule;
use super::dead_time::DeadTime;
use super::{Decision, Inputs, pulses};
use crate::exact::{Coefficient, Word, both, halve, round_half_up, within, word};
use crate::model::bit_true::constants::Scale;
use crate::model::bit_true::limit::{self, Limited};
use crate::model::variant::reference_gain;
use crate::model::{Reach, sector};
use crate::{Error, Saturation, Spec, Switch};

#[derive(Clone, Debug)]
pub struct PiPwm<W> {
    /// One controller for the pair.
    six_step: bool,
    saturation: Saturation,
    k_drop: Coefficient<W>,
    k_i: Coefficient<W>,
    integral_range: [f64; 2],
    dead_time: DeadTime<W>,
    /// Of three pulsed legs, or of the pair.
    legs: CommonModeRule<W>,
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
        Ok(Self {
            six_step: options.six_step == Switch::On,
            saturation: options.saturation,
            k_drop: scale.coefficient("k_drop", -scale.ohm * reference_gain(spec))?,
            k_i: scale.coefficient("k_i", spec.inverter.t_s / options.integral_time)?,
            dead_time: DeadTime::new(spec, scale)?,
            legs: match options.six_step {
                Switch::On => CommonModeRule::of_pair(spec, true, scale)?,
                Switch::Off => CommonModeRule::new(spec, options.common_mode, scale)?,
            },
            integral_range,
        })
    }

    #[inline]
    pub fn decide(&self, now: &Inputs<W>) -> Decision<W> {
        if self.six_step {
            return self.decide_pair(now);
        }
        // 9; without feed-forward the EMF is 0.
        let drop = both(|x| self.k_drop.mul(now.i[x]));
        let p = both(|x| now.j[x] + drop[x]);
        let u_unsat = both(|x| p[x] + now.integral[x] + now.e[x]);
        // 10, 11
        let limited = limit::limit(
            self.saturation,
            now.k,
            self.legs.reach(now.v_bus),
            u_unsat,
            now.e,
        );
        let Limited { u, legs, reach } = self.legs.readable(now.k, now.v_bus, &limited);
        // 12
        let [low, high] = self.integral_range;
        let integral = both(|x| {
            let distance = u[x] - now.e[x] - now.integral[x];
            let moved = now.integral[x] + self.k_i.mul(distance);
            within(moved, low, high)
        });
        Decision {
            u_unsat,
            u,
            reach,
            vector: 0,
            command: pulses::three(
                now,
                legs,
                self.dead_time.shifts(now, drop.map(|drop| -drop)),
                &self.legs,
                false,
            ),
            integral,
            hysteresis: now.hysteresis,
            past: now.past,
        }
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
            command: pulses::line(now, line, self.dead_time.shifts(now, flow), &self.legs),
            integral: [integral, word(0.0)],
            hysteresis: now.hysteresis,
            past: now.past,
        }
    }
}
