//! Every path of decisions about the signs of linear forms, by repeated runs of a check.
//!
//! A run asks [`Path::is_negative`]; if the known facts leave both answers open, the run takes one,
//! and another run the other. Paths without an integer solution are left out, as far as rational
//! arithmetic can tell: at most too many remain, so a proof is never wrong.

use super::linear::{Fact, Linear};
use super::simplex::{Rational, common_point};
use std::collections::HashMap;

/// An assumption contradicts the known facts: the run ends without a verdict.
#[derive(Clone, Copy, Debug)]
pub struct Contradiction;

/// A decision, and whether the alternative is still to be followed.
#[derive(Clone, Copy, Debug)]
struct Decision {
    negative: bool,
    open: bool,
    /// The alternative is impossible.
    implied: bool,
}

/// One path.
#[derive(Debug, Default)]
pub struct Path {
    trail: Vec<Decision>,
    /// Decisions of the trail that this run has taken.
    taken: usize,
    facts: Vec<Fact>,
    /// Consequences of the facts, not used by the simplex method.
    implied: Vec<Fact>,
    /// A point that satisfies the facts.
    witness: Option<Vec<Rational>>,
    names: Vec<String>,
    /// Products and floors by their operands.
    defined: HashMap<Defined, Linear>,
}

/// Factors and shift of a product, or the operand of a floor.
type Defined = (Linear, Linear, u32);

/// Runs `check` on every path. The number of paths.
///
/// # Errors
/// The finding of `check` on the first refuted path, and the path.
pub fn for_all_paths(
    mut check: impl FnMut(&mut Path) -> Result<Result<(), String>, Contradiction>,
) -> Result<usize, String> {
    let mut trail = vec![];
    for number in 1.. {
        let mut path = Path {
            trail,
            ..Path::default()
        };
        if let Ok(Err(what)) = check(&mut path)
            && path.is_consistent()
        {
            return Err(format!("{what}{}", path.place()));
        }
        trail = path.trail;
        while trail.pop_if(|last| !last.open).is_some() {}
        match trail.last_mut() {
            None => return Ok(number),
            Some(last) => {
                last.negative = !last.negative;
                last.open = false;
            }
        }
    }
    Ok(0)
}

impl Path {
    /// A new whole number.
    pub fn variable(&mut self, name: &str) -> Linear {
        self.names.push(name.to_owned());
        Linear::variable(self.names.len() - 1)
    }

    /// A new flag.
    ///
    /// # Errors
    /// If the path ends.
    pub fn flag(&mut self, name: &str) -> Result<bool, Contradiction> {
        let chance = self.variable(name);
        self.is_negative(&chance)
    }

    /// A new whole number from 0 to below `end`.
    ///
    /// # Errors
    /// If the path ends.
    pub fn number(&mut self, name: &str, end: i64) -> Result<i64, Contradiction> {
        let chance = self.variable(name);
        for value in 0..end - 1 {
            if self.is_negative(&(&chance - &Linear::number(value + 1)))? {
                return Ok(value);
            }
        }
        Ok(end - 1)
    }

    /// Assumes that the form is not negative.
    ///
    /// # Errors
    /// If that is impossible.
    pub fn assume(&mut self, form: &Linear) -> Result<(), Contradiction> {
        let fact = Fact::not_negative(form);
        if fact.weights.is_empty() {
            return if fact.bound <= 0 {
                Ok(())
            } else {
                Err(Contradiction)
            };
        }
        self.facts.push(fact);
        // Earlier runs have come this way.
        if self.taken < self.trail.len() {
            self.witness = None;
            return Ok(());
        }
        self.witness = self.point(None);
        match self.witness {
            Some(_) => Ok(()),
            None => Err(Contradiction),
        }
    }

    /// Whether the form is negative, on this path.
    ///
    /// # Errors
    /// If neither is possible.
    pub fn is_negative(&mut self, form: &Linear) -> Result<bool, Contradiction> {
        if let Some(number) = form.as_number() {
            return Ok(number < 0);
        }
        let (yes, no) = (Fact::negative(form), Fact::not_negative(form));
        let mut known = self.facts.iter().chain(&self.implied);
        if let Some(fact) = known.find(|fact| fact.implies(&yes) || fact.implies(&no)) {
            return Ok(fact.implies(&yes));
        }
        let decision = if let Some(decision) = self.trail.get(self.taken) {
            *decision
        } else {
            let decision = self.decide(&yes, &no)?;
            self.trail.push(decision);
            decision
        };
        self.taken += 1;
        let fact = if decision.negative { yes } else { no };
        if decision.implied {
            self.implied.push(fact);
        } else {
            if self
                .witness
                .as_ref()
                .is_some_and(|point| !holds(&fact, point))
            {
                self.witness = None;
            }
            self.facts.push(fact);
        }
        Ok(decision.negative)
    }

    /// A decision that no earlier run has made.
    fn decide(&mut self, yes: &Fact, no: &Fact) -> Result<Decision, Contradiction> {
        if self.witness.is_none() {
            self.witness = self.point(None);
        }
        let witness = self.witness.as_ref().ok_or(Contradiction)?;
        let (seen_yes, seen_no) = (holds(yes, witness), holds(no, witness));
        let is_yes = seen_yes || self.point(Some(yes)).is_some();
        let is_no = seen_no || self.point(Some(no)).is_some();
        if !is_yes && !is_no {
            return Err(Contradiction);
        }
        Ok(Decision {
            negative: is_yes,
            open: is_yes && is_no,
            implied: is_yes != is_no,
        })
    }

    /// A point that satisfies the facts, and one more.
    fn point(&self, more: Option<&Fact>) -> Option<Vec<Rational>> {
        let facts: Vec<&Fact> = self.facts.iter().chain(more).collect();
        common_point(&facts, self.names.len())
    }

    /// floor(x / 2^bits).
    ///
    /// # Errors
    /// If the path ends.
    pub fn floored(&mut self, x: &Linear, bits: u32) -> Result<Linear, Contradiction> {
        if let Some(number) = x.as_number() {
            return Ok(Linear::number(number >> bits));
        }
        let key = (x.clone(), Linear::default(), bits);
        if let Some(known) = self.defined.get(&key) {
            return Ok(known.clone());
        }
        let floor = self.variable("floor");
        let rest = x - &floor.times(1 << bits);
        self.assume(&rest)?;
        self.assume(&(&Linear::number((1 << bits) - 1) - &rest))?;
        self.defined.insert(key, floor.clone());
        Ok(floor)
    }

    /// floor(x y / 2^bits), known only to be the same for the same factors.
    pub fn product(&mut self, x: &Linear, y: &Linear, bits: u32) -> Linear {
        match (x.as_number(), y.as_number()) {
            (Some(x), Some(y)) => {
                return Linear::number(((i128::from(x) * i128::from(y)) >> bits) as i64);
            }
            (Some(0), _) | (_, Some(0)) => return Linear::default(),
            _ => {}
        }
        let (one, two) = if x <= y { (x, y) } else { (y, x) };
        let key = (one.clone(), two.clone(), bits);
        if let Some(known) = self.defined.get(&key) {
            return known.clone();
        }
        let product = self.variable("product");
        self.defined.insert(key, product.clone());
        product
    }

    /// floor((x y + z w) / 2^bits), known only to be the same for the same products.
    pub fn sum_of_products(&mut self, factors: [[&Linear; 2]; 2], bits: u32) -> Linear {
        /// Distinct from the shifts of single products.
        const OF_SUMS: u32 = 128;
        let [first, second] = factors.map(|[x, y]| self.product(x, y, 0));
        let key = (&first + &second, Linear::default(), OF_SUMS + bits);
        if let Some(number) = key.0.as_number() {
            return Linear::number(number >> bits);
        }
        if let Some(known) = self.defined.get(&key) {
            return known.clone();
        }
        let sum = self.variable("sum");
        self.defined.insert(key, sum.clone());
        sum
    }

    /// Whether products of factors that are equal here can be equal, too: so far they were
    /// independent.
    fn is_consistent(&mut self) -> bool {
        let mut products: Vec<(Defined, Linear)> = self.defined.drain().collect();
        products.sort();
        for (later, (one, product)) in products.iter().enumerate() {
            for (two, other) in &products[..later] {
                let straight = [&one.0 - &two.0, &one.1 - &two.1];
                let crossed = [&one.0 - &two.1, &one.1 - &two.0];
                let same = one.2 == two.2
                    && (straight.iter().all(|form| self.is_zero(form))
                        || crossed.iter().all(|form| self.is_zero(form)));
                let difference = product - other;
                if same
                    && (self.assume(&difference).is_err() || self.assume(&-&difference).is_err())
                {
                    return false;
                }
            }
        }
        true
    }

    /// Whether the form can only be zero.
    fn is_zero(&self, form: &Linear) -> bool {
        match form.as_number() {
            Some(number) => number == 0,
            None => [form.clone(), -form]
                .iter()
                .all(|form| self.point(Some(&Fact::negative(form))).is_none()),
        }
    }

    /// The path, for messages.
    fn place(&self) -> String {
        let point = self.point(None).unwrap_or_default();
        let values = self.names.iter().zip(&point);
        let values = values.map(|(name, value)| format!(" {name} = {value}"));
        format!(", at{}", values.collect::<String>())
    }
}

fn holds(fact: &Fact, point: &[Rational]) -> bool {
    let whole = |number: i64| Rational::from_integer(i128::from(number));
    let terms = fact.weights.iter().zip(point);
    let sum: Rational = terms.map(|(&weight, value)| whole(weight) * value).sum();
    sum >= whole(fact.bound)
}

#[cfg(test)]
mod tests {
    use super::for_all_paths;
    use crate::proof::linear::Linear;

    #[test]
    fn orders_of_three_numbers_are_thirteen() {
        let mut orders = std::collections::BTreeSet::new();
        let paths = for_all_paths(|path| {
            let x = ["a", "b", "c"].map(|name| path.variable(name));
            let mut order = vec![];
            for (one, two) in [(0, 1), (1, 2), (0, 2)] {
                let less = path.is_negative(&(&x[one] - &x[two]))?;
                let greater = !less && path.is_negative(&(&x[two] - &x[one]))?;
                order.push((less, greater));
            }
            orders.insert(order);
            Ok(Ok(()))
        });
        assert_eq!(paths, Ok(13));
        assert_eq!(orders.len(), 13);
    }

    #[test]
    fn a_wrong_claim_is_refuted_with_its_place() {
        let claim = |limit: i64| {
            for_all_paths(|path| {
                let (x, y) = (path.variable("x"), path.variable("y"));
                path.assume(&(&x - &Linear::number(3)))?;
                path.assume(&(&y - &x))?;
                let sum = &x + &y;
                let half = path.floored(&sum, 1)?;
                let is_small = path.is_negative(&(&half - &Linear::number(limit)))?;
                Ok(if is_small {
                    Err("small".to_owned())
                } else {
                    Ok(())
                })
            })
        };
        assert_eq!(claim(3), Ok(1));
        let place = claim(4).expect_err("3 and 3 have the mean 3");
        assert!(place.contains("x = 3"), "{place}");
    }
}
