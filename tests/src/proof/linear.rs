//! Linear forms with integer coefficients over numbered variables, and facts about them.

use std::ops::{Add, Neg, Sub};

/// A constant and a weight per variable.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Linear {
    constant: i64,
    /// Without zeros at the end.
    weights: Vec<i64>,
}

impl Linear {
    /// A number.
    pub fn number(constant: i64) -> Self {
        Self {
            constant,
            weights: vec![],
        }
    }

    /// The variable of this number.
    pub fn variable(number: usize) -> Self {
        let mut weights = vec![0; number];
        weights.push(1);
        Self {
            constant: 0,
            weights,
        }
    }

    /// Its value, if it has no variable.
    pub fn as_number(&self) -> Option<i64> {
        self.weights.is_empty().then_some(self.constant)
    }

    /// `factor` times the form.
    #[must_use]
    pub fn times(&self, factor: i64) -> Self {
        let weights = self.weights.iter().map(|weight| factor * weight);
        Self::trimmed(factor * self.constant, weights.collect())
    }

    fn trimmed(constant: i64, mut weights: Vec<i64>) -> Self {
        while weights.last() == Some(&0) {
            weights.pop();
        }
        Self { constant, weights }
    }

    fn combined(&self, other: &Self, combine: impl Fn(i64, i64) -> i64) -> Self {
        let weight = |form: &Self, index| form.weights.get(index).copied().unwrap_or(0);
        let length = self.weights.len().max(other.weights.len());
        let weights = (0..length).map(|index| combine(weight(self, index), weight(other, index)));
        Self::trimmed(combine(self.constant, other.constant), weights.collect())
    }
}

impl Add for &Linear {
    type Output = Linear;

    fn add(self, other: Self) -> Linear {
        self.combined(other, |one, two| one + two)
    }
}

impl Sub for &Linear {
    type Output = Linear;

    fn sub(self, other: Self) -> Linear {
        self.combined(other, |one, two| one - two)
    }
}

impl Neg for &Linear {
    type Output = Linear;

    fn neg(self) -> Linear {
        self.times(-1)
    }
}

/// The fact that a sum of weighted variables is at least `bound`; the weights have no common
/// divisor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// Weights of the variables.
    pub weights: Vec<i64>,
    /// Lower bound of their sum.
    pub bound: i64,
}

impl Fact {
    /// The fact that the form is not negative. Without a common divisor of the weights the bound is
    /// the tightest one for integers.
    pub fn not_negative(form: &Linear) -> Self {
        let divisor = form.weights.iter().fold(0, |one, &two| gcd(one, two.abs()));
        let divisor = divisor.max(1);
        Self {
            weights: form.weights.iter().map(|weight| weight / divisor).collect(),
            bound: -form.constant.div_euclid(divisor),
        }
    }

    /// The fact that the form is at most -1.
    pub fn negative(form: &Linear) -> Self {
        Self::not_negative(&(&-form - &Linear::number(1)))
    }

    /// Whether it implies `other`.
    pub fn implies(&self, other: &Self) -> bool {
        self.weights == other.weights && self.bound >= other.bound
    }
}

fn gcd(one: i64, two: i64) -> i64 {
    if two == 0 { one } else { gcd(two, one % two) }
}

#[cfg(test)]
mod tests {
    use super::{Fact, Linear};

    #[test]
    fn facts_are_tight_for_whole_numbers() {
        let x = Linear::variable(1);
        // 3 x - 1 >= 0 means x >= 1, and 3 x - 1 < 0 means -x >= 0.
        let form = &x.times(3) - &Linear::number(1);
        let fact = Fact::not_negative(&form);
        assert_eq!((&fact.weights[..], fact.bound), (&[0, 1][..], 1));
        let fact = Fact::negative(&form);
        assert_eq!((&fact.weights[..], fact.bound), (&[0, -1][..], 0));
        assert_eq!((&x - &x).as_number(), Some(0));
    }
}
