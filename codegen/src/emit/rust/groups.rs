//! Groups of signals: the phases of one quantity, or numbered words.
//!
//! `i_a, i_b, i_c` are one array in signatures, which keeps them short. Grouping depends on names
//! and shapes alone, so it is the same on both sides of a call.

use super::super::signal::{Shape, Signal};
use super::names::snake;
use super::source::{Source, quote};

/// Most arguments of a signature (clippy's `too_many_arguments`).
pub(super) const ARGUMENTS: usize = 7;

/// One argument or result: a single signal, or an array of signals of one shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Group {
    /// Positions in the grouped list.
    pub members: Vec<usize>,
    /// Word, flag or leg state.
    pub shape: Shape,
}

/// Groups the signals, each group at the position of its first member.
pub(super) fn group(signals: &[Signal]) -> Vec<Group> {
    let mut groups: Vec<(String, Group)> = vec![];
    for (position, signal) in signals.iter().enumerate() {
        let family = family(&signal.name);
        match groups
            .iter_mut()
            .find(|(known, group)| *known == family && group.shape == signal.shape)
        {
            Some((_, group)) => group.members.push(position),
            None => groups.push((
                family,
                Group {
                    members: vec![position],
                    shape: signal.shape,
                },
            )),
        }
    }
    for (_, group) in &mut groups {
        group
            .members
            .sort_by(|&left, &right| signals[left].name.cmp(&signals[right].name));
    }
    groups.into_iter().map(|(_, group)| group).collect()
}

/// Joins groups of one shape into arrays until at most `limit` groups are left: first the single
/// signals, then the arrays.
pub(super) fn bundle(mut groups: Vec<Group>, limit: usize) -> Vec<Group> {
    for singles in [true, false] {
        for shape in [Shape::Word, Shape::Flag, Shape::Leg] {
            if groups.len() > limit {
                let fits =
                    |group: &Group| group.shape == shape && (!singles || group.members.len() == 1);
                let members: Vec<usize> = groups
                    .iter()
                    .filter(|group| fits(group))
                    .flat_map(|group| group.members.clone())
                    .collect();
                if let Some(first) = groups.iter().position(fits) {
                    groups[first].members = members;
                    let mut position = 0;
                    groups.retain(|group| {
                        position += 1;
                        position - 1 <= first || !fits(group)
                    });
                }
            }
        }
    }
    groups
}

impl Group {
    /// `[i_a, i_b]`, or `sector`: as a pattern or as an expression.
    pub(super) fn names(&self, signals: &[Signal]) -> Source {
        self.of(|member| {
            let name = snake(&signals[member].name);
            quote!(#name)
        })
    }

    /// The same with `each` in place of the names.
    pub(super) fn of(&self, each: impl FnMut(usize) -> Source) -> Source {
        let each: Vec<Source> = self.members.iter().copied().map(each).collect();
        match each.as_slice() {
            [single] => single.clone(),
            many => array(many),
        }
    }

    /// `[Word; 2]`, or `Word`.
    pub(super) fn rust_type(&self) -> Source {
        let kind = rust_type(self.shape);
        match self.members.len() {
            1 => kind,
            count => {
                quote!([#kind; #count])
            }
        }
    }
}

/// The elements as an array; `[x; n]` if all are equal.
pub(super) fn array(elements: &[Source]) -> Source {
    match elements {
        [first, rest @ ..] if rest.iter().all(|element| element == first) => {
            let count = elements.len();
            quote!([#first; #count])
        }
        many => quote!([#(#many),*]),
    }
}

/// `Word`, `bool` or `LegState`.
pub(super) fn rust_type(shape: Shape) -> Source {
    match shape {
        Shape::Word => quote!(Word),
        Shape::Flag => quote!(bool),
        Shape::Leg => quote!(LegState),
    }
}

/// The name without its phase (`v_a_now` and `v_b_now` are one family) or without its number (`t1`
/// to `t6`).
fn family(name: &str) -> String {
    let mut phase = false;
    let parts: Vec<&str> = name
        .split('_')
        .map(|part| {
            let is_phase = !phase && matches!(part, "a" | "b" | "c");
            phase |= is_phase;
            if is_phase { "*" } else { part }
        })
        .collect();
    if phase {
        return parts.join("_");
    }
    let stem = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    if stem.len() < name.len() {
        format!("{stem}#")
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::{Shape, Signal, bundle, group};

    fn words(names: &[&str]) -> Vec<Signal> {
        names
            .iter()
            .map(|&name| Signal {
                name: name.to_owned(),
                shape: Shape::Word,
            })
            .collect()
    }

    fn shapes(names: &[&str], limit: usize) -> Vec<Vec<usize>> {
        bundle(group(&words(names)), limit)
            .into_iter()
            .map(|group| group.members)
            .collect()
    }

    #[test]
    fn phases_and_numbered_words_travel_together() {
        let names = ["j", "i_a", "v_a_now", "i_b", "t2", "v_b_now", "t1", "theta"];
        assert_eq!(
            shapes(&names, 7),
            [vec![0], vec![1, 3], vec![2, 5], vec![6, 4], vec![7]]
        );
    }

    #[test]
    fn long_lists_bundle_their_single_words_first() {
        let names = ["j", "i_a", "i_b", "k", "l"];
        assert_eq!(shapes(&names, 3), [vec![0, 3, 4], vec![1, 2]]);
        assert_eq!(shapes(&names, 1), [vec![0, 3, 4, 1, 2]]);
    }
}
