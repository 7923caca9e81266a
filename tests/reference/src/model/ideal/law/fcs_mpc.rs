//! FCS-MPC: the candidate with the least distance to the deadbeat voltage, found by enumeration.

use super::off_leg::{TIE, floats, with_off_leg};
use super::whole::Whole;
use super::{Decision, Inputs, deadbeat, divided};
use crate::model::Reach;
use crate::model::ideal::vector::phases;
use crate::model::vectors;
use crate::{Candidates, Error, Spec, Switch};
use nalgebra::Vector2;

/// The options, with their constants of the drive.
#[derive(Clone, Debug)]
pub struct FcsMpc {
    options: crate::FcsMpc,
    /// Nominal bus, volt.
    v_bus: f64,
    whole: Whole,
}

impl FcsMpc {
    pub fn new(spec: &Spec, options: &crate::FcsMpc) -> Result<Self, Error> {
        Ok(Self {
            options: *options,
            v_bus: spec.inverter.v_bus,
            whole: Whole::new(spec)?,
        })
    }

    pub fn decide(&self, now: &Inputs) -> Decision {
        let options = &self.options;
        let u_unsat = deadbeat::voltage(now);
        let tie = TIE * (u_unsat.norm() + now.v_bus).powi(2);
        let weighted = options.modulated == Switch::Off
            && options.switching_weight + options.torque_weight > 0.0;
        let cost = |vector: usize| {
            let miss = u_unsat - self.voltage(now, vector);
            if options.horizon == 2 {
                miss.norm_squared() + self.second_miss(now, &miss)
            } else if weighted {
                miss.norm_squared() + self.weighed(now, vector, &miss)
            } else {
                miss.norm_squared()
            }
        };
        let (zero, others) =
            vectors::candidates(options.candidates, now.commutating, now.sector_eff);
        let (mut vector, mut least) = (zero, cost(zero));
        for place in others {
            let other = if weighted {
                vectors::weighted_order(place)
            } else {
                place
            };
            let found = cost(other);
            if found < least - tie {
                (vector, least) = (other, found);
            }
        }
        let (u, command) = match options.modulated {
            Switch::Off => {
                let turns_off = options.candidates != Candidates::ThreePhase;
                (
                    self.voltage(now, vector),
                    self.whole.command(now, vector, turns_off),
                )
            }
            Switch::On => divided::command(options, self.whole, now, &u_unsat, vector),
        };
        Decision {
            u_unsat,
            u,
            reach: Reach::Inside,
            vector,
            command,
            integral: [0.0; 2],
            rises: now.rises,
            past: deadbeat::past(now, &u),
        }
    }

    /// Contribution of the weights to a vector that misses the demanded voltage by this much
    /// (section 10w).
    fn weighed(&self, now: &Inputs, vector: usize, miss: &Vector2<f64>) -> f64 {
        let per_leg =
            (self.options.switching_weight / now.phase.b).powi(2) * now.v_bus / self.v_bus;
        let switching = per_leg * vectors::changes(now.vector_prev, vector);
        // The component of a zero-sum vector along the difference of two phases is that difference
        // over sqrt(3).
        let (x, y) = vectors::pair_of(now.sector_eff);
        let missed = phases(miss);
        let line = missed[x] - missed[y];
        switching + self.options.torque_weight * line * line / 3.0
    }

    /// The least square of the second period's miss, after a first vector that misses the demanded
    /// voltage by this much (section 10h).
    fn second_miss(&self, now: &Inputs, miss: &Vector2<f64>) -> f64 {
        let (a, b) = (now.phase.a, now.phase.b);
        // The first period ends with i_ref - b miss.
        let wanted = (now.i_ref - (now.i_ref - miss * b) * a) / b + now.e;
        let candidates = self.options.candidates;
        let (zero, others) = vectors::candidates(candidates, now.commutating, now.sector_eff);
        std::iter::once(zero)
            .chain(others)
            .map(|vector| (wanted - self.whole.voltage(now, vector)).norm_squared())
            .fold(f64::INFINITY, f64::min)
    }

    /// The assumed voltage of a vector.
    fn voltage(&self, now: &Inputs, vector: usize) -> Vector2<f64> {
        let Some(off) = vectors::off_leg(vector).filter(|_| floats(&self.options)) else {
            return self.whole.voltage(now, vector);
        };
        let terminal = self.whole.terminals(now, vector);
        with_off_leg(&self.options, now, terminal, off)
    }
}
