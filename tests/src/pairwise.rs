//! A covering array: few rows in which every pair of values of any two axes occurs.
//!
//! Greedy and deterministic. Rows are grown around a pair that is still open, each further value
//! being the one that closes most open pairs; rows that are refused are tried again in another order.

use std::collections::BTreeSet;

/// Attempts at a row around one open pair.
const ATTEMPTS: usize = 40;

/// Two axes with a value each; the first axis is the lesser.
pub type Pair = ((usize, usize), (usize, usize));

/// Rows that cover all pairs, and the pairs that no accepted row was found for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Covering {
    /// Rows: a value per axis.
    pub rows: Vec<Vec<usize>>,
    /// Pairs that are in no row.
    pub open: Vec<Pair>,
}

/// Covers all pairs of axes with so many values each by rows that `accepts` takes.
pub fn cover(lengths: &[usize], accepts: impl Fn(&[usize]) -> bool) -> Covering {
    let mut open: BTreeSet<Pair> = BTreeSet::new();
    for a in 0..lengths.len() {
        for b in a + 1..lengths.len() {
            for x in 0..lengths[a] {
                open.extend((0..lengths[b]).map(|y| ((a, x), (b, y))));
            }
        }
    }
    let mut covering = Covering::default();
    let mut order = Shuffle(1);
    while let Some(&pair) = open.first() {
        let row = (0..ATTEMPTS)
            .filter_map(|_| {
                let row = grow(pair, lengths, &open, &mut order);
                accepts(&row).then_some(row)
            })
            .max_by_key(|row| gain(row, &open));
        if let Some(row) = row {
            open.retain(|pair| !covers(&row, *pair));
            covering.rows.push(row);
        } else {
            open.remove(&pair);
            covering.open.push(pair);
        }
    }
    covering
}

fn covers(row: &[usize], ((a, x), (b, y)): Pair) -> bool {
    row[a] == x && row[b] == y
}

fn gain(row: &[usize], open: &BTreeSet<Pair>) -> usize {
    open.iter().filter(|pair| covers(row, **pair)).count()
}

fn grow(
    ((a, x), (b, y)): Pair,
    lengths: &[usize],
    open: &BTreeSet<Pair>,
    order: &mut Shuffle,
) -> Vec<usize> {
    let mut row: Vec<Option<usize>> = vec![None; lengths.len()];
    (row[a], row[b]) = (Some(x), Some(y));
    for axis in order.of(lengths.len()) {
        if row[axis].is_some() {
            continue;
        }
        let closes = |value: usize| {
            let others = row.iter().enumerate();
            let pairs = others.filter_map(|(other, taken)| {
                let (one, two) = ((axis, value), (other, (*taken)?));
                Some(if axis < other { (one, two) } else { (two, one) })
            });
            pairs.filter(|pair| open.contains(pair)).count()
        };
        let values = order.of(lengths[axis]);
        row[axis] = values.into_iter().max_by_key(|&value| closes(value));
    }
    row.into_iter().map(|value| value.unwrap_or(0)).collect()
}

/// Orders that differ from call to call, the same in every run.
struct Shuffle(u64);

impl Shuffle {
    fn of(&mut self, length: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..length).collect();
        for last in (1..length).rev() {
            // Knuth's MMIX generator; the upper bits are the random ones.
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            order.swap(last, (self.0 >> 33) as usize % (last + 1));
        }
        order
    }
}

#[cfg(test)]
mod tests {
    use super::{cover, covers};

    #[test]
    fn every_pair_is_in_a_row_or_told() {
        let lengths = [3, 2, 4, 2, 3];
        let forbidden = |row: &[usize]| row[0] == 2 && row[2] == 3;
        let covering = cover(&lengths, |row| !forbidden(row));
        assert_eq!(covering.open, [((0, 2), (2, 3))]);
        assert!(covering.rows.len() < 20, "{} rows", covering.rows.len());
        assert!(!covering.rows.iter().any(|row| forbidden(row)));
        for a in 0..lengths.len() {
            for b in a + 1..lengths.len() {
                for x in 0..lengths[a] {
                    for y in 0..lengths[b] {
                        let pair = ((a, x), (b, y));
                        let found = covering.rows.iter().any(|row| covers(row, pair));
                        assert!(found || covering.open.contains(&pair), "{pair:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_same_call_gives_the_same_rows() {
        assert_eq!(cover(&[3, 3, 2], |_| true), cover(&[3, 3, 2], |_| true));
    }
}
