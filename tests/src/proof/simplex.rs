//! Whether linear facts have a common rational point: the exact simplex method with Bland's rule.

use super::linear::Fact;
use num_rational::Ratio;

/// An exact number.
pub type Rational = Ratio<i128>;

/// A point (a value per variable) that satisfies all facts; `None` if there is no such point.
///
/// The facts' sums are further variables with a lower bound each. Rows express the dependent
/// variables in terms of the free ones; a dependent variable below its bound is exchanged for a
/// free one until none is. Of several choices the first variable is taken, so that no exchange
/// repeats.
pub fn common_point(facts: &[&Fact], variables: usize) -> Option<Vec<Rational>> {
    Tableau::new(facts, variables).solve()
}

struct Tableau {
    /// The number of variables without bound; those of the facts follow.
    unbounded: usize,
    /// Lower bounds of the others.
    bounds: Vec<Rational>,
    /// Value of every variable.
    values: Vec<Rational>,
    /// Variables of the columns.
    free: Vec<usize>,
    /// Variables of the rows.
    dependent: Vec<usize>,
    /// Weights of the free variables in each dependent one.
    rows: Vec<Vec<Rational>>,
}

impl Tableau {
    fn new(facts: &[&Fact], variables: usize) -> Self {
        let zero = Rational::from_integer(0);
        let row = |fact: &&Fact| {
            let mut row = vec![zero; variables];
            for (place, weight) in row.iter_mut().zip(&fact.weights) {
                *place = Rational::from_integer(i128::from(*weight));
            }
            row
        };
        let bound = |fact: &&Fact| Rational::from_integer(i128::from(fact.bound));
        Self {
            unbounded: variables,
            bounds: facts.iter().map(bound).collect(),
            values: vec![zero; variables + facts.len()],
            free: (0..variables).collect(),
            dependent: (variables..variables + facts.len()).collect(),
            rows: facts.iter().map(row).collect(),
        }
    }

    fn solve(mut self) -> Option<Vec<Rational>> {
        while let Some(row) = self.first_violated() {
            let column = self.exchangeable(row)?;
            self.exchange(row, column);
        }
        self.values.truncate(self.unbounded);
        Some(self.values)
    }

    fn bound(&self, variable: usize) -> Option<Rational> {
        let place = variable.checked_sub(self.unbounded)?;
        Some(self.bounds[place])
    }

    fn first_violated(&self) -> Option<usize> {
        let rows = 0..self.rows.len();
        let is_violated = |&row: &usize| {
            let variable = self.dependent[row];
            self.bound(variable)
                .is_some_and(|bound| self.values[variable] < bound)
        };
        rows.filter(is_violated)
            .min_by_key(|&row| self.dependent[row])
    }

    /// The column of a free variable that can raise the row's variable.
    fn exchangeable(&self, row: usize) -> Option<usize> {
        let zero = Rational::from_integer(0);
        let can_raise = |&column: &usize| {
            let (weight, variable) = (self.rows[row][column], self.free[column]);
            let can_fall = self
                .bound(variable)
                .is_none_or(|bound| self.values[variable] > bound);
            weight > zero || weight < zero && can_fall
        };
        let columns = 0..self.free.len();
        columns
            .filter(can_raise)
            .min_by_key(|&column| self.free[column])
    }

    /// Raises the row's variable to its bound and exchanges it for the column's.
    fn exchange(&mut self, row: usize, column: usize) {
        let zero = Rational::from_integer(0);
        let (leaving, entering) = (self.dependent[row], self.free[column]);
        let pivot = self.rows[row][column];
        let target = self.bound(leaving).unwrap_or(self.values[leaving]);
        let change = (target - self.values[leaving]) / pivot;
        self.values[leaving] = target;
        self.values[entering] += change;
        for (other, weights) in self.rows.iter().enumerate() {
            if other != row && weights[column] != zero {
                self.values[self.dependent[other]] += weights[column] * change;
            }
        }
        // entering = (leaving - the other terms)/pivot
        let mut solved: Vec<Rational> = self.rows[row].iter().map(|&w| -w / pivot).collect();
        solved[column] = pivot.recip();
        for (other, weights) in self.rows.iter_mut().enumerate() {
            let factor = weights[column];
            if other == row || factor == zero {
                continue;
            }
            weights[column] = zero;
            for (weight, solved) in weights.iter_mut().zip(&solved) {
                if *solved != zero {
                    *weight += factor * solved;
                }
            }
        }
        self.rows[row] = solved;
        self.dependent[row] = entering;
        self.free[column] = leaving;
    }
}

#[cfg(test)]
mod tests {
    use super::{Rational, common_point};
    use crate::proof::linear::Fact;

    fn fact(weights: &[i64], bound: i64) -> Fact {
        let weights = weights.to_vec();
        Fact { weights, bound }
    }

    #[test]
    fn a_point_is_found_or_there_is_none() {
        let mut random = fastrand::Rng::with_seed(1);
        let (mut found, mut none) = (0, 0);
        for _ in 0..1500 {
            let facts: Vec<Fact> = (0..random.usize(1..9))
                .map(|_| fact(&[random.i64(-3..4), random.i64(-3..4)], random.i64(-6..7)))
                .collect();
            let all: Vec<&Fact> = facts.iter().collect();
            if let Some(point) = common_point(&all, 2) {
                found += 1;
                let whole = |number: i64| Rational::from_integer(i128::from(number));
                let holds = |fact: &Fact| {
                    let terms = fact.weights.iter().zip(&point);
                    let sum: Rational = terms.map(|(&weight, value)| whole(weight) * value).sum();
                    sum >= whole(fact.bound)
                };
                assert!(facts.iter().all(holds), "{facts:?} {point:?}");
            } else {
                none += 1;
                // In sixths.
                let holds = |x: i64, y: i64| {
                    let mut all = facts.iter();
                    all.all(|fact| fact.weights[0] * x + fact.weights[1] * y >= 6 * fact.bound)
                };
                let mut grid = (-60..=60).flat_map(|x| (-60..=60).map(move |y| (x, y)));
                assert!(!grid.any(|(x, y)| holds(x, y)), "{facts:?}");
            }
        }
        assert!(found > 200 && none > 200, "{found} {none}");
    }
}
