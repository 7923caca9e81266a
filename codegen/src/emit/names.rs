//! The drive's name in snake case.

/// `hub_drive` of `HubDrive`, `bldc_42_drive` of `BLDC42Drive`: an underscore before each capital
/// that follows a small letter or begins a word, and before each run of digits.
pub fn module_name(type_name: &str) -> String {
    let letters: Vec<char> = type_name.chars().collect();
    let mut name = String::new();
    for (index, &letter) in letters.iter().enumerate() {
        let before = index.checked_sub(1).map(|at| letters[at]);
        let behind = letters.get(index + 1);
        let begins = before.is_some_and(|before| {
            before != '_'
                && if letter.is_uppercase() {
                    !before.is_uppercase() || behind.is_some_and(|behind| behind.is_lowercase())
                } else {
                    letter.is_ascii_digit() && !before.is_ascii_digit()
                }
        });
        if begins {
            name.push('_');
        }
        name.extend(letter.to_lowercase());
    }
    name
}

#[cfg(test)]
mod tests {
    use super::module_name;

    #[test]
    fn words_are_set_apart() {
        assert_eq!(module_name("HubDrive"), "hub_drive");
        assert_eq!(module_name("BLDC42Drive"), "bldc_42_drive");
        assert_eq!(module_name("PMDrive"), "pm_drive");
    }
}
