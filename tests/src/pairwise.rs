//! A covering array: few rows in which every pair of values of any two axes occurs.
//!
//! Greedy and deterministic. First a row is sought for every pair, to find the pairs without any
//! row. Then rows are grown around an open pair, each further value being the one that closes most
//! open pairs.

use std::collections::{BTreeMap, BTreeSet};

/// Attempts at a row around one open pair.
const ATTEMPTS: usize = 40;

/// Two axes with a value each; the first axis is the lesser.
pub type Pair = ((usize, usize), (usize, usize));

/// Rows that cover all pairs, and the pairs without an accepted row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Covering {
    /// Rows: a value per axis.
    pub rows: Vec<Vec<usize>>,
    /// Pairs in no row.
    pub open: Vec<Pair>,
}

/// Covers the values of all pairs of axes that `is_paired` names, the lesser axis first, by rows that
/// `accepts` accepts. The axes have these numbers of values.
pub fn cover(
    lengths: &[usize],
    is_paired: impl Fn(usize, usize) -> bool,
    accepts: impl Fn(&[usize]) -> bool,
) -> Covering {
    let mut order = Shuffle(1);
    let mut witnesses: BTreeMap<Pair, Vec<usize>> = BTreeMap::new();
    let mut covering = Covering::default();
    let pairs = pairs(lengths, is_paired);
    for &pair in &pairs {
        if witnesses.contains_key(&pair) {
            continue;
        }
        // If few rows are accepted, random ones may all miss; that of the first values and accepted
        // ones are likelier.
        let first = std::iter::once(vec![0; lengths.len()]);
        let random = (0..ATTEMPTS).map(|_| order.row(lengths));
        let known: BTreeSet<Vec<usize>> = witnesses.values().cloned().collect();
        let rows = first.chain(random).chain(known);
        // A row with a pair for which none was found is left out: to check one takes long.
        let mut rows = rows
            .map(|row| with_pair(row, pair))
            .filter(|row| !covering.open.iter().any(|pair| covers(row, *pair)));
        if let Some(row) = rows.find(|row| accepts(row)) {
            let known = pairs.iter().filter(|pair| covers(&row, **pair));
            witnesses.extend(known.map(|pair| (*pair, row.clone())));
        } else {
            covering.open.push(pair);
        }
    }
    let mut open: BTreeSet<Pair> = witnesses.keys().copied().collect();
    while let Some(pair) = open.first() {
        let grown = (0..ATTEMPTS).map(|_| grow(*pair, lengths, &open, &covering.open, &mut order));
        let mut grown: Vec<Vec<usize>> = grown.collect();
        // The best one first: checking a row takes long.
        grown.sort_by_cached_key(|row| gain(row, &open));
        let row = grown.into_iter().rev().find(|row| accepts(row));
        let row = row.unwrap_or_else(|| witnesses[pair].clone());
        open.retain(|pair| !covers(&row, *pair));
        covering.rows.push(row);
    }
    covering
}

/// Places of few rows in which every value of every axis occurs that occurs in any.
pub fn each_value(rows: &[Vec<usize>]) -> Vec<usize> {
    let values = |row: &[usize]| row.iter().copied().enumerate().collect::<BTreeSet<_>>();
    let mut open: BTreeSet<(usize, usize)> = rows.iter().flat_map(|row| values(row)).collect();
    let mut taken = BTreeSet::new();
    while !open.is_empty() {
        let gain = |place: &usize| values(&rows[*place]).intersection(&open).count();
        let Some(place) = (0..rows.len()).max_by_key(gain) else {
            break;
        };
        open = &open - &values(&rows[place]);
        taken.insert(place);
    }
    taken.into_iter().collect()
}

/// The pairs to cover, the first axes first.
fn pairs(lengths: &[usize], is_paired: impl Fn(usize, usize) -> bool) -> Vec<Pair> {
    let mut pairs = vec![];
    for a in 0..lengths.len() {
        for b in (a + 1..lengths.len()).filter(|b| is_paired(a, *b)) {
            for x in 0..lengths[a] {
                pairs.extend((0..lengths[b]).map(|y| ((a, x), (b, y))));
            }
        }
    }
    pairs
}

fn with_pair(mut row: Vec<usize>, ((a, x), (b, y)): Pair) -> Vec<usize> {
    (row[a], row[b]) = (x, y);
    row
}

fn covers(row: &[usize], ((a, x), (b, y)): Pair) -> bool {
    row[a] == x && row[b] == y
}

fn gain(row: &[usize], open: &BTreeSet<Pair>) -> usize {
    open.iter().filter(|pair| covers(row, **pair)).count()
}

/// A row with the pair and, if possible, without forbidden ones.
fn grow(
    ((a, x), (b, y)): Pair,
    lengths: &[usize],
    open: &BTreeSet<Pair>,
    forbidden: &[Pair],
    order: &mut Shuffle,
) -> Vec<usize> {
    let mut row: Vec<Option<usize>> = vec![None; lengths.len()];
    (row[a], row[b]) = (Some(x), Some(y));
    for axis in order.of(lengths.len()) {
        if row[axis].is_some() {
            continue;
        }
        let made = |value: usize| {
            let others = row.iter().enumerate();
            let pairs = others.filter_map(|(other, taken)| {
                let (one, two) = ((axis, value), (other, (*taken)?));
                Some(if axis < other { (one, two) } else { (two, one) })
            });
            pairs.collect::<Vec<Pair>>()
        };
        let worth = |value: usize| {
            let pairs = made(value);
            let is_allowed = !pairs.iter().any(|pair| forbidden.contains(pair));
            let closed = pairs.iter().filter(|pair| open.contains(pair)).count();
            (is_allowed, closed)
        };
        let values = order.of(lengths[axis]);
        row[axis] = values.into_iter().max_by_key(|&value| worth(value));
    }
    row.into_iter().map(|value| value.unwrap_or(0)).collect()
}

/// Pseudo-random orders, the same in every run.
struct Shuffle(u64);

impl Shuffle {
    /// A number below `end`.
    fn below(&mut self, end: usize) -> usize {
        // Knuth's MMIX generator; the upper bits are the random ones.
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }

    fn of(&mut self, length: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..length).collect();
        for last in (1..length).rev() {
            order.swap(last, self.below(last + 1));
        }
        order
    }

    fn row(&mut self, lengths: &[usize]) -> Vec<usize> {
        lengths.iter().map(|&length| self.below(length)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{cover, covers, each_value};

    #[test]
    fn every_value_is_in_one_of_few_rows() {
        let covering = cover(&[3, 2, 4, 2, 3], |_, _| true, |row| row[0] + row[1] < 3);
        let places = each_value(&covering.rows);
        assert!(places.len() <= 6, "{places:?}");
        for (axis, length) in [3, 2, 4, 2, 3].into_iter().enumerate() {
            let mut values: Vec<usize> = places
                .iter()
                .map(|place| covering.rows[*place][axis])
                .collect();
            values.sort_unstable();
            values.dedup();
            assert_eq!(values, (0..length).collect::<Vec<_>>());
        }
        assert_eq!(each_value(&[]), [0; 0]);
    }

    #[test]
    fn every_pair_is_in_a_row_or_told() {
        let lengths = [3, 2, 4, 2, 3];
        // One pair, and a value that allows only one other.
        let forbidden = |row: &[usize]| row[0] == 2 && row[2] == 3 || row[4] == 1 && row[2] != 2;
        let covering = cover(&lengths, |_, _| true, |row| !forbidden(row));
        let open = [0, 1, 3].map(|value| ((2, value), (4, 1)));
        assert_eq!(covering.open, [&[((0, 2), (2, 3))][..], &open].concat());
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
    fn a_pair_of_few_rows_is_found() {
        // Beside the last axis' second value the others have their first ones.
        let lengths = [6, 6, 6, 6, 2];
        let accepts = |row: &[usize]| row[4] == 0 || row[..4] == [0; 4];
        let covering = cover(&lengths, |_, _| true, accepts);
        for axis in 0..4 {
            assert!(!covering.open.contains(&((axis, 0), (4, 1))));
        }
        assert!(covering.rows.contains(&vec![0, 0, 0, 0, 1]));
    }

    #[test]
    fn the_same_call_gives_the_same_rows() {
        let covered = || cover(&[3, 3, 2], |_, _| true, |_| true);
        assert_eq!(covered(), covered());
    }

    #[test]
    fn an_axis_paired_with_one_other_costs_few_rows() {
        let lengths = [3, 2, 11];
        let covering = cover(&lengths, |a, b| b != 2 || a == 1, |_| true);
        assert_eq!(covering.rows.len(), 22);
    }
}
