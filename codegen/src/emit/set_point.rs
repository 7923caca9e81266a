//! How the words of the set-point are shared: those that a setter writes together are replaced
//! together, every other one for itself.

use crate::ir::{Program, Word};

/// Words of the set-point that are replaced as one.
pub struct Shared<'a> {
    /// The word's own name, or that of what a setter sets: `bus` of `set_bus`.
    pub name: String,
    /// Places among the program's words, and the words.
    pub words: Vec<(usize, &'a Word)>,
}

/// The program's set-point words, in the order of their first ones.
pub fn shared(program: &Program) -> Vec<Shared<'_>> {
    let mut groups: Vec<Vec<usize>> = (0..program.params.len()).map(|word| vec![word]).collect();
    for setter in &program.setters {
        let writes = |group: &Vec<usize>| {
            let mut written = setter.next_params.iter();
            written.any(|(param, _)| group.contains(&param.index()))
        };
        let (written, others): (Vec<_>, Vec<_>) = groups.into_iter().partition(writes);
        groups = others;
        let mut together = written.concat();
        if !together.is_empty() {
            together.sort_unstable();
            groups.push(together);
        }
    }
    groups.sort_unstable();
    let named = |group: Vec<usize>| {
        let words: Vec<(usize, &Word)> = group
            .into_iter()
            .map(|word| (word, &program.params[word]))
            .collect();
        Shared {
            name: name(program, &words),
            words,
        }
    };
    groups.into_iter().map(named).collect()
}

fn name(program: &Program, words: &[(usize, &Word)]) -> String {
    if let [(_, only)] = words {
        return only.name.clone();
    }
    let writes = |index: usize| {
        let mut setters = program.setters.iter();
        setters.find(|setter| {
            let mut written = setter.next_params.iter();
            written.any(|(param, _)| param.index() == index)
        })
    };
    let setter = words.first().and_then(|&(index, _)| writes(index));
    let name = setter.map_or("words", |setter| setter.name.as_str());
    name.trim_start_matches("set_").to_owned()
}
