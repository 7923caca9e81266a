//! Choices written as words.

/// A word of an option and its meaning, a phrase that follows the word.
#[derive(Clone, Copy, Debug)]
pub struct Word {
    /// As it is written.
    pub word: &'static str,
    /// Meaning; empty where the word is clear.
    pub meaning: &'static str,
}

/// A choice written as one of several words.
pub trait Words: Copy + PartialEq + 'static {
    /// All choices.
    const CHOICES: &'static [Self];
    /// Their words, in the same order.
    const WORDS: &'static [Word];

    /// The word of this choice.
    fn word(self) -> &'static str {
        let at = Self::CHOICES.iter().position(|choice| *choice == self);
        at.map_or("", |at| Self::WORDS[at].word)
    }

    /// The choice of a word.
    fn from_word(given: &str) -> Option<Self> {
        let at = Self::WORDS.iter().position(|known| known.word == given)?;
        Self::CHOICES.get(at).copied()
    }
}

impl Words for bool {
    const CHOICES: &'static [Self] = &[true, false];
    const WORDS: &'static [Word] = &[
        Word {
            word: "on",
            meaning: "",
        },
        Word {
            word: "off",
            meaning: "",
        },
    ];
}

/// Declares a choice with its words.
macro_rules! words {
    ($(#[$about:meta])* $vis:vis enum $name:ident { $($word:literal = $choice:ident: $meaning:literal,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        $vis enum $name { $(#[doc = $meaning] $choice,)* }

        impl $crate::spec::words::Words for $name {
            const CHOICES: &'static [Self] = &[$(Self::$choice,)*];
            const WORDS: &'static [$crate::spec::words::Word] =
                &[$($crate::spec::words::Word { word: $word, meaning: $meaning },)*];
        }
    };
}
pub(crate) use words;
