//! The choice of a vector as in its semantics page: one candidate after the other, the first with
//! the least score.

use hexagen_codegen::spec::Candidates;
use hexagen_tests::proof::linear::Linear;
use hexagen_tests::proof::paths::{Contradiction, Path};

/// Legs a, b, c of the vectors by number: high, low or off.
const LEGS: [&[u8; 3]; 16] = [
    b"---", b"--+", b"+-+", b"+--", b"++-", b"-+-", b"-++", b"0-+", b"+-0", b"+0-", b"0+-", b"-+0",
    b"-0+", b"0--", b"-0-", b"--0",
];

/// The leg that is off in sectors 1 to 6.
const OFF: [usize; 6] = [0, 2, 1, 0, 2, 1];

/// A leg that is off, as in the physical prediction.
#[derive(Clone, Debug)]
pub struct OffLeg {
    /// Negative if its predicted current flows into the motor through a diode, and out of it.
    pub inward: Linear,
    pub outward: Linear,
    /// Lift of its EMF above the driven legs' mean.
    pub lift: Linear,
    /// Twice its terminal next to a pair that is driven high and low, minus the bus.
    pub offset: Linear,
}

/// Inputs of the choice.
#[derive(Clone, Debug)]
pub struct Situation {
    pub candidates: Candidates,
    pub sector: usize,
    pub commutating: bool,
    pub bus: Linear,
    pub u: [Linear; 3],
    /// `None` if they count as midway.
    pub off_legs: Option<[OffLeg; 3]>,
    /// Shift of the products in scores.
    pub shift: u32,
    /// Cost of turning legs a, b, c high, low and off over the bus, if weighted.
    pub changes: Option<[[Linear; 3]; 3]>,
}

/// Phase voltages of a vector in sixths of the bus, an off leg midway.
pub fn sixths(vector: usize) -> [i64; 3] {
    let legs = LEGS[vector].map(|leg| i64::from(leg == b'+') - i64::from(leg == b'-'));
    let is_pair = LEGS[vector].contains(&b'0');
    let sum: i64 = legs.iter().sum();
    legs.map(|leg| 3 * leg - if is_pair { 0 } else { sum })
}

impl Situation {
    /// The number of the applied vector.
    pub fn vector(&self, path: &mut Path) -> Result<usize, Contradiction> {
        Ok(self.least(path)?.0)
    }

    /// That vector with its score.
    pub fn least(&self, path: &mut Path) -> Result<(usize, Linear), Contradiction> {
        let list = self.list();
        let rounded = self.off_legs.is_some() && list.iter().any(|&vector| vector >= 7);
        let list = if rounded {
            self.first_of_each_kind(&list, path)?
        } else {
            list
        };
        let mut least = (list[0], self.score(list[0], rounded, path)?);
        for &vector in &list[1..] {
            let score = self.score(vector, rounded, path)?;
            if path.is_negative(&(&score - &least.1))? {
                least = (vector, score);
            }
        }
        Ok(least)
    }

    /// The vector that shares the period with `vector`, and the terminals of the legs: their
    /// fraction of the bus.
    pub fn shared(&self, vector: usize, path: &mut Path) -> Result<[Linear; 3], Contradiction> {
        let mut terminals = [(); 3].map(|()| Linear::default());
        if vector < 7 {
            let mut others = (0..7).filter(|&other| other != vector);
            let mut partner = others.next().unwrap_or(0);
            for other in others {
                let difference = &self.by_bus(other) - &self.by_bus(partner);
                if path.is_negative(&difference)? {
                    partner = other;
                }
            }
            let is_high = |vector: usize, x: usize| LEGS[vector][x] == b'+';
            let high = |vector: usize| (0..3).filter(|&x| is_high(vector, x)).count();
            let (lower, upper) = if high(vector) < high(partner) {
                (vector, partner)
            } else {
                (partner, vector)
            };
            assert!((0..3).all(|x| !is_high(lower, x) || is_high(upper, x)));
            let twice = &self.by_bus(lower) - &self.by_bus(upper);
            let t = path.floored(&(&self.bus.times(4) + &twice), 3)?;
            let t = self.within_rails(&t, path)?;
            for (x, terminal) in terminals.iter_mut().enumerate() {
                if is_high(lower, x) {
                    *terminal = self.bus.clone();
                } else if is_high(upper, x) {
                    *terminal = t.clone();
                }
            }
            return Ok(terminals);
        }
        let off = LEGS[vector]
            .iter()
            .position(|&leg| leg == b'0')
            .unwrap_or(0);
        let mut pairs = (7..13).filter(|&pair| LEGS[pair][off] == b'0');
        let leg = |pair: usize, wanted: u8| LEGS[pair].iter().position(|&leg| leg == wanted);
        let first = pairs.next().unwrap_or(7);
        let (Some(mut p), Some(mut q)) = (leg(first, b'+'), leg(first, b'-')) else {
            return Ok(terminals);
        };
        if path.is_negative(&(&self.u[p] - &self.u[q]))? {
            (p, q) = (q, p);
        }
        let mut t = &self.u[p] - &self.u[q];
        if let Some(off_legs) = &self.off_legs {
            let leg = &off_legs[off];
            if path.is_negative(&leg.inward)? {
                t = &self.u[p] + &path.floored(&self.u[p], 1)?;
            } else if path.is_negative(&leg.outward)? {
                t = &self.u[p] + &path.floored(&(&self.bus + &self.u[p]), 1)?;
            }
        }
        terminals[p] = self.within_rails(&t, path)?;
        Ok(terminals)
    }

    fn within_rails(&self, t: &Linear, path: &mut Path) -> Result<Linear, Contradiction> {
        Ok(if path.is_negative(t)? {
            Linear::default()
        } else if path.is_negative(&(&self.bus - t))? {
            self.bus.clone()
        } else {
            t.clone()
        })
    }

    fn list(&self) -> Vec<usize> {
        let mut list = self.numbered();
        if self.changes.is_some() {
            // In the order of gate patterns.
            let place = |vector: &usize| match vector {
                1..7 => [4, 5, 1, 3, 2, 6][vector - 1],
                13.. => 0,
                _ => *vector,
            };
            list.sort_by_key(place);
        }
        list
    }

    fn numbered(&self) -> Vec<usize> {
        match (self.sector, self.candidates) {
            (_, Candidates::ThreePhase) => (0..7).collect(),
            (_, Candidates::All) => (0..13).collect(),
            (_, Candidates::Table2) if self.commutating => (0..7).collect(),
            (sector, Candidates::Table2) => {
                std::iter::once(13 + OFF[sector - 1]).chain(7..13).collect()
            }
        }
    }

    /// Of V1 to V6, and of the two vectors with the same leg off, only the exactly better one.
    fn first_of_each_kind(
        &self,
        list: &[usize],
        path: &mut Path,
    ) -> Result<Vec<usize>, Contradiction> {
        let kind = |vector: usize| match vector {
            0 if self.changes.is_some() => 0,
            1..7 => 0,
            7..13 => 1 + (vector - 7) % 3,
            _ => 4,
        };
        let mut kept: Vec<usize> = vec![];
        for &vector in list {
            match kept.iter().position(|&known| kind(known) == kind(vector)) {
                Some(place) if kind(vector) < 4 => {
                    let [known, new] = [kept[place], vector].map(|vector| self.by_bus(vector));
                    if path.is_negative(&(&new - &known))? {
                        kept[place] = vector;
                    }
                }
                _ => kept.push(vector),
            }
        }
        kept.sort_by_key(|&vector| if vector >= 13 { 0 } else { vector });
        Ok(kept)
    }

    /// 6 (|v|^2 - 2 u v), without the off leg, over the bus.
    pub fn by_bus(&self, vector: usize) -> Linear {
        let find = |wanted: u8| LEGS[vector].iter().position(|&leg| leg == wanted);
        let is_high = |leg: &&u8| **leg == b'+';
        let high: Vec<&u8> = LEGS[vector].iter().filter(is_high).collect();
        let bus = &self.bus;
        let own = match (find(b'+'), find(b'-'), find(b'0')) {
            (Some(p), Some(q), Some(_)) => &bus.times(3) - &(&self.u[p] - &self.u[q]).times(6),
            (Some(x), _, None) if high.len() == 1 => &bus.times(4) - &self.u[x].times(12),
            (Some(_), Some(x), None) => &bus.times(4) + &self.u[x].times(12),
            _ => Linear::default(),
        };
        let Some(changes) = &self.changes else {
            return own;
        };
        let legs = LEGS[vector].iter().zip(changes);
        legs.fold(own, |sum, (leg, [high, low, off])| match leg {
            b'+' => &sum + high,
            b'-' => &sum + low,
            _ => &sum + off,
        })
    }

    fn score(
        &self,
        vector: usize,
        rounded: bool,
        path: &mut Path,
    ) -> Result<Linear, Contradiction> {
        let by_bus = self.by_bus(vector);
        if !rounded || vector == 0 && self.changes.is_none() {
            return Ok(by_bus);
        }
        let off = LEGS[vector].iter().position(|&leg| leg == b'0');
        let off_leg = off.and_then(|off| Some((off, &self.off_legs.as_ref()?[off])));
        let Some((off, off_leg)) = off_leg else {
            let score = path.product(&self.bus, &by_bus, self.shift);
            // The floor of a product with a positive factor has the sign of the other.
            let negative = path.is_negative(&by_bus)?;
            path.assume(&if negative {
                &-&score - &Linear::number(1)
            } else {
                score.clone()
            })?;
            return Ok(score);
        };
        if vector < 13 {
            let aside = &off_leg.offset - &self.u[off].times(6);
            let factors = [[&off_leg.offset, &aside], [&self.bus, &by_bus]];
            return Ok(path.sum_of_products(factors, self.shift));
        }
        let tau = off_leg.terminal(&self.bus, &Linear::default(), path)?;
        let aside = &tau.times(4) - &self.u[off].times(12);
        Ok(match &self.changes {
            None => path.product(&tau, &aside, self.shift),
            Some(_) => path.sum_of_products([[&tau, &aside], [&self.bus, &by_bus]], self.shift),
        })
    }
}

impl OffLeg {
    /// Position of the leg next to driven legs with that mean.
    pub fn terminal(
        &self,
        bus: &Linear,
        mean: &Linear,
        path: &mut Path,
    ) -> Result<Linear, Contradiction> {
        let floating = mean + &self.lift;
        Ok(if path.is_negative(&self.inward)? {
            Linear::default()
        } else if path.is_negative(&self.outward)? {
            bus.clone()
        } else if path.is_negative(&floating)? {
            Linear::default()
        } else if path.is_negative(&(bus - &floating))? {
            bus.clone()
        } else {
            floating
        })
    }
}
