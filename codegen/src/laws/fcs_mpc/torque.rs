//! The weight of the torque error: it couples the legs, so the vectors are enumerated (semantics,
//! step 10w).

use super::changes::Changes;
use super::off_legs::OffLegs;
use super::score::{Candidate, Products, state_score, zero_of_pair};
use crate::blocks::Lowering;
use crate::ir::{Coefficient, Expr, Flag, Named, Phases, named, pick};
use crate::laws::current_loop::Front;
use crate::laws::whole_vectors::vector_legs;
use crate::spec::{Candidates, FcsMpcSpec};

/// Three-phase vectors in the order of their gate patterns, bit 0 leg a, bit 1 leg b, bit 2 leg c.
const BY_GATES: [usize; 6] = [3, 5, 4, 1, 2, 6];

/// Conducting pair with phase a, b or c off.
const LINES: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// A vector's score as products.
struct Weighed<'b> {
    vector: Expr<'b>,
    /// Vector number, for names.
    number: usize,
    /// At most two products, rounded once.
    products: Products<'b>,
    torque: Torque<'b>,
}

/// Contribution of the torque error to a score.
enum Torque<'b> {
    /// None: the pair's line voltage is zero.
    Nothing,
    /// The product of these factors.
    Factors(Products<'b>),
    /// The pair's line voltage by off phase: 1 the bus, -1 the bus reversed, 0 none.
    Lines([i32; 3]),
}

/// Scores of all candidates.
pub(super) struct Weighing<'l, 'b> {
    l: &'l Lowering<'b>,
    u: Phases<'b, 3>,
    /// Voltage of a high leg.
    bus: Expr<'b>,
    off_legs: Option<&'l OffLegs<'b>>,
    changes: Option<&'l Changes<'b>>,
    commutating: Option<Flag<'b>>,
    pair_zero: Expr<'b>,
    /// Whether leg a, leg b is off in the sector's pair.
    is_out: [Flag<'b>; 2],
    k_weight: Coefficient,
    /// Twice the deadbeat line voltage of the sector's pair.
    twice_line: Expr<'b>,
}

/// An off leg beside a driven pair.
#[derive(Clone, Copy)]
struct Beside<'b> {
    terminal: Expr<'b>,
    /// Twice its terminal voltage less that of the high leg; none if midway.
    offset: Option<Expr<'b>>,
}

impl<'l, 'b> Weighing<'l, 'b> {
    pub(super) fn new(
        l: &'l Lowering<'b>,
        options: &FcsMpcSpec,
        front: &Front<'b>,
        u: Phases<'b, 3>,
        off_legs: Option<&'l OffLegs<'b>>,
        changes: Option<&'l Changes<'b>>,
    ) -> Self {
        let (pair_zero, is_out) = zero_of_pair(l, front.sector);
        // A weight needs few bits, and products with 16-bit words have few to spare.
        let word = if options.common.word == 16 { 8 } else { 32 };
        let weight = 3.0 * options.torque_weight;
        let doc = "Weight of the torque error in scores.";
        let physical = format!("3 torque_weight = {weight}");
        let k_weight = l.coefficient("k_torque_weight", weight, word, doc, &physical);
        let lines = LINES.map(|[x, y]| u.0[x] - u.0[y]);
        named! {
            let line_twice = pick(is_out, lines) << 1;
        }
        Self {
            l,
            u,
            bus: front.reach.volts,
            off_legs,
            changes,
            commutating: front.commutation.map(|commutation| commutation.flag),
            pair_zero,
            is_out,
            k_weight,
            twice_line: line_twice,
        }
    }

    /// The vector of least score, one candidate after the other.
    pub(super) fn best(&self, candidates: Candidates) -> Expr<'b> {
        let (l, bus) = (self.l, self.bus);
        named! {
            let bus_reversed = -bus;
        }
        let terms = [self.factors(bus), self.factors(bus_reversed)];
        let pairs = match candidates {
            Candidates::ThreePhase => vec![],
            Candidates::Table2 => std::iter::once(self.pair_zero())
                .chain(self.pairs())
                .collect(),
            Candidates::All => self.pairs(),
        };
        let of_gates = BY_GATES.map(|number| self.three_phase(number));
        let three: Vec<Weighed<'b>> = std::iter::once(self.zero()).chain(of_gates).collect();
        let widths = three.iter().chain(&pairs).flat_map(Weighed::all_products);
        let widest = widths.chain(&terms).map(Products::bits).max();
        // The sum of three products of at most n + m - 1 bits has two bits more.
        let shift = widest.unwrap_or(62).saturating_sub(30);
        l.product_format("score", shift, "products of two voltages in scores");
        let term = |k: usize, name: &str| terms[k].sum(shift).unwrap_or(bus).named(name);
        let terms = [term(0, "torque_forward"), term(1, "torque_backward")];
        match (candidates, self.commutating) {
            (Candidates::All, _) => {
                self.least(three.into_iter().chain(pairs).collect(), shift, terms)
            }
            (Candidates::Table2, Some(commutating)) => {
                let three = self.least(three, shift, terms);
                commutating.choose(three, self.least(pairs, shift, terms))
            }
            _ => self.least(three, shift, terms),
        }
    }

    /// Factors of the torque term for a line voltage of the pair.
    fn factors(&self, line: Expr<'b>) -> Products<'b> {
        Products(vec![[line, self.k_weight * (line - self.twice_line)]])
    }

    /// A score over the bus plus the switching cost.
    fn with_changes(&self, along: Expr<'b>, number: usize) -> Expr<'b> {
        self.changes
            .map_or(along, |changes| along + changes.to(number))
    }

    /// V0.
    fn zero(&self) -> Weighed<'b> {
        let products = self.changes.map(|changes| [self.bus, changes.to(0)]);
        Weighed {
            vector: self.l.b.number(0),
            number: 0,
            products: Products(products.into_iter().collect()),
            torque: Torque::Nothing,
        }
    }

    fn three_phase(&self, number: usize) -> Weighed<'b> {
        let legs = vector_legs()[number];
        let high = legs.iter().filter(|&&leg| leg == 1).count();
        let lone = if high == 1 { 1 } else { -1 };
        let x = legs.iter().position(|&leg| leg == lone).unwrap_or(0);
        let along = (self.bus << 2) - (12 * lone) * self.u.0[x];
        Weighed {
            vector: self.l.b.number(number as i32),
            number,
            products: Products(vec![[self.bus, self.with_changes(along, number)]]),
            torque: Torque::Lines(LINES.map(|[x, y]| (legs[x] - legs[y]) / 2)),
        }
    }

    /// The zero vector of the sector's pair: its line voltage is zero.
    fn pair_zero(&self) -> Weighed<'b> {
        let aside = self
            .off_legs
            .map(|off_legs| off_legs.zero(self.u, self.is_out));
        let cost = self
            .changes
            .map(|changes| [self.bus, changes.to_zero(self.is_out)]);
        Weighed {
            vector: self.pair_zero,
            number: 13,
            products: Products(aside.into_iter().chain(cost).collect()),
            torque: Torque::Nothing,
        }
    }

    fn pairs(&self) -> Vec<Weighed<'b>> {
        let beside = self.beside_pairs();
        (7..13).map(|number| self.pair(number, &beside)).collect()
    }

    fn beside_pairs(&self) -> [Beside<'b>; 3] {
        let Some(off_legs) = self.off_legs else {
            named! {
                let half_bus = self.bus >> 1;
            }
            let midway = Beside {
                terminal: half_bus,
                offset: None,
            };
            return [midway; 3];
        };
        named! {
            let tau = off_legs.offsets.map(|offset| (offset + self.bus) >> 1);
        }
        [0, 1, 2].map(|x| Beside {
            terminal: tau.0[x],
            offset: Some(off_legs.offsets.0[x]),
        })
    }

    fn pair(&self, number: usize, beside: &[Beside<'b>; 3]) -> Weighed<'b> {
        let legs = vector_legs()[number];
        let place = |sign: i32| legs.iter().position(|&leg| leg == sign).unwrap_or(0);
        let (p, q, off) = (place(1), place(-1), place(0));
        let u = self.u.0;
        let aside = beside[off]
            .offset
            .map(|offset| [offset, offset - 6 * u[off]]);
        let along = 3 * self.bus - 6 * (u[p] - u[q]);
        let along = [self.bus, self.with_changes(along, number)];
        let mut terminals = [beside[off].terminal; 3];
        terminals[p] = self.bus;
        terminals[q] = self.l.b.number(0);
        let lines = LINES.map(|[x, y]| terminals[x] - terminals[y]);
        let line = pick(self.is_out, lines).named(&format!("line_{number}"));
        Weighed {
            vector: self.l.b.number(number as i32),
            number,
            products: Products(aside.into_iter().chain([along]).collect()),
            torque: Torque::Factors(self.factors(line)),
        }
    }

    /// The torque term of a score.
    fn term(
        &self,
        torque: &Torque<'b>,
        shift: u32,
        [forward, backward]: [Expr<'b>; 2],
    ) -> Option<Expr<'b>> {
        match torque {
            Torque::Nothing => None,
            Torque::Factors(factors) => factors.sum(shift),
            Torque::Lines(lines) => {
                let terms = lines.map(|line| match line {
                    1 => forward,
                    -1 => backward,
                    _ => self.l.b.number(0),
                });
                Some(pick(self.is_out, terms))
            }
        }
    }

    /// The first vector of the least score.
    fn least(&self, list: Vec<Weighed<'b>>, shift: u32, terms: [Expr<'b>; 2]) -> Expr<'b> {
        let candidates = list.into_iter().map(|one| {
            let parts = [
                one.products.sum(shift),
                self.term(&one.torque, shift, terms),
            ];
            let score = parts
                .into_iter()
                .flatten()
                .reduce(|score, term| score + term);
            let score = match score {
                None => self.l.b.number(0),
                Some(score) => {
                    state_score(self.l, score, shift);
                    score.named(&format!("score_{}", one.number))
                }
            };
            let vector = one.vector;
            (Candidate { vector, score }, one.number)
        });
        let best =
            candidates.reduce(|(best, _), (next, number)| (best.least(next, number), number));
        best.map_or(self.pair_zero, |(best, _)| best.vector)
    }
}

impl<'b> Weighed<'b> {
    fn all_products(&self) -> impl Iterator<Item = &Products<'b>> {
        let of_torque = match &self.torque {
            Torque::Factors(factors) => Some(factors),
            Torque::Nothing | Torque::Lines(_) => None,
        };
        std::iter::once(&self.products).chain(of_torque)
    }
}
