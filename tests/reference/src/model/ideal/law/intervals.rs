//! Modulation by Table 2 (section 11t): the paper's (14), (15) and (16) by magnitude and angle.

use super::common_mode::CommonModeRule;
use super::{Command, Inputs};
use crate::model::Reach;
use crate::model::ideal::Duties;
use crate::model::ideal::limit;
use crate::model::ideal::vector::{clarke, phases};
use crate::model::sector::OUT_PHASE;
use crate::model::vectors::{self, FIRST_PAIR, FIRST_PAIR_ZERO};
use crate::{Error, Modulation, Saturation, Spec, Zero};
use hexagen::LegState;
use nalgebra::{Rotation2, Vector2};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, TAU};

#[derive(Clone, Copy, Debug)]
pub struct Table2 {
    saturation: Saturation,
    zero: Zero,
    legs: CommonModeRule,
}

/// A limited voltage and its command.
pub struct Modulated {
    pub u: Vector2<f64>,
    pub reach: Reach,
    pub command: Command,
}

impl Table2 {
    /// None with another modulation.
    pub fn of(
        spec: &Spec,
        modulation: Modulation,
        (saturation, zero): (Saturation, Zero),
    ) -> Result<Option<Self>, Error> {
        if modulation != Modulation::Table2 {
            return Ok(None);
        }
        Ok(Some(Self {
            saturation,
            zero,
            legs: CommonModeRule::of_vectors(spec)?,
        }))
    }

    pub fn modulate(&self, now: &Inputs, u: &Vector2<f64>, e: &Vector2<f64>) -> Modulated {
        let bus = self.legs.reach(now.v_bus);
        // The pair vectors' hexagon is that of the three-phase ones turned by 30 degrees, sqrt(3)/2 as large.
        let (turn, size) = if now.commutating {
            (0.0, bus)
        } else {
            (FRAC_PI_6, bus * 3_f64.sqrt() / 2.0)
        };
        let turned = Rotation2::new(turn);
        let limited = limit::limit(
            self.saturation,
            &phases(&(turned * u)),
            &phases(&(turned * e)),
            size,
        );
        let u = turned.inverse() * clarke(&limited.u);
        Modulated {
            u,
            reach: limited.reach,
            command: Command::idle(self.duties(now, &u)),
        }
    }

    /// The vectors on both sides of a voltage, their times and legs.
    fn duties(&self, now: &Inputs, u: &Vector2<f64>) -> Duties {
        // V1 stands at 240 degrees, V12 at 270; each next one 60 degrees on. The modulus of one for the whole period is
        // 2/3 of the bus, or 1/sqrt(3) of it.
        let (first_angle, factor) = if now.commutating {
            (4.0 * FRAC_PI_3, 3_f64.sqrt())
        } else {
            (4.5 * FRAC_PI_3, 2.0)
        };
        let ahead = (u.y.atan2(u.x) - first_angle).rem_euclid(TAU);
        let place = ((ahead / FRAC_PI_3) as usize).min(5);
        let beyond = ahead - place as f64 * FRAC_PI_3;
        let share = |angle: f64| (factor * u.norm() / now.v_bus * angle.sin()).max(0.0);
        let (t_a, t_b) = (share(FRAC_PI_3 - beyond), share(beyond));
        let after = (place + 1) % 6;
        let number = |place: usize| place + if now.commutating { 1 } else { FIRST_PAIR };
        let vectors = [(number(place), t_a), (number(after), t_b)];
        // In commutation the vector with two high legs comes first, so that no leg turns on again.
        let is_turned = now.commutating && high_legs(vectors[0].0) == 1;
        let [(first, t_first), (second, t_second)] = if is_turned {
            [vectors[1], vectors[0]]
        } else {
            vectors
        };
        let zero = match self.zero {
            Zero::PairLow if !now.commutating && now.sector_eff > 0 => {
                vectors::states(FIRST_PAIR_ZERO + OUT_PHASE[now.sector_eff])
            }
            Zero::PairLow | Zero::AllLow => [LegState::Low; 3],
        };
        Duties {
            duty: [
                t_first.min(self.legs.top),
                (t_first + t_second).min(self.legs.top),
                0.0,
            ],
            state: vectors::states(first),
            later: Some([vectors::states(second), zero]),
        }
    }
}

fn high_legs(vector: usize) -> usize {
    vectors::LEGS[vector].iter().filter(|leg| **leg > 0).count()
}
