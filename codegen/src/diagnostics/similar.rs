//! Known words that a misspelt one may stand for.

use super::number::enumerated;
use strsim::normalized_damerau_levenshtein;

/// Shortest word that is looked for within names, in characters.
const SHORTEST: usize = 3;

/// Least similarity of a word with a name, or with its part between hyphens, of 1.
const ALIKE: f64 = 0.75;

/// Most names that are told.
const MOST: usize = 3;

/// The closest known word, if one is close.
pub fn nearest<'a>(word: &str, known: &[&'a str]) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .iter()
        .map(|near| {
            (
                normalized_damerau_levenshtein(&word, &near.to_lowercase()),
                *near,
            )
        })
        .filter(|(similarity, _)| *similarity >= 0.5)
        .max_by(|left, right| left.0.total_cmp(&right.0))
        .map(|(_, near)| near)
}

/// The known names that a word may stand for: one that is like it; else at most three that have it as a part, or are
/// like it between hyphens; else the closest one, if one is close.
pub fn similar<'n>(word: &str, known: &[&'n str]) -> Vec<&'n str> {
    let word = word.to_lowercase();
    let closest = nearest(&word, known);
    let is_like = |part: &str| normalized_damerau_levenshtein(part, &word) >= ALIKE;
    if let Some(name) = closest.filter(|name| is_like(name)) {
        return vec![name];
    }
    let is_long = word.chars().count() >= SHORTEST;
    let holds = |name: &&&str| name.contains(&word) || name.split('-').any(is_like);
    let held = known.iter().filter(holds).filter(|_| is_long).copied();
    let held: Vec<&str> = held.take(MOST).collect();
    if held.is_empty() {
        return closest.into_iter().collect();
    }
    held
}

/// `; did you mean x or y?` of quoted names; nothing of none.
pub fn did_you_mean_one(quoted: &[String]) -> String {
    if quoted.is_empty() {
        return String::new();
    }
    format!("; did you mean {}?", enumerated(quoted, "or"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_name_leads_to_the_names_that_have_it() {
        let known = [
            "nucleo-ihm07m1",
            "nucleo-ihm08m1",
            "teknic-m2310p",
            "vesc-6",
        ];
        let told = |word| similar(word, &known);
        assert_eq!(told("Teknic"), ["teknic-m2310p"]);
        assert_eq!(told("nuclo"), ["nucleo-ihm07m1", "nucleo-ihm08m1"]);
        assert_eq!(told("ihm08"), ["nucleo-ihm08m1"]);
        assert_eq!(told("teknic-m2310q"), ["teknic-m2310p"]);
        assert_eq!(told("vesc6"), ["vesc-6"]);
        assert!(told("hurst").is_empty());
        assert!(told("c-").is_empty());
        let quoted = ["`nucleo-ihm07m1`", "`nucleo-ihm08m1`"].map(str::to_owned);
        assert_eq!(
            did_you_mean_one(&quoted),
            "; did you mean `nucleo-ihm07m1` or `nucleo-ihm08m1`?"
        );
        assert_eq!(did_you_mean_one(&[]), "");
    }
}
