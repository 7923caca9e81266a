//! Emitted Rust as text, written through templates that look like those of the `quote` crate.
//!
//! In macros, which run unoptimised, a text takes a third of the time of tokens; the compiler
//! parses it in one piece. Texts may also be made in any thread, tokens may not.

use std::fmt;

/// A piece of Rust: lexical tokens separated by white space, so that equal tokens are equal text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Source(String);

impl Source {
    /// No code at all.
    pub(super) fn new() -> Self {
        Self::default()
    }

    /// Code given as text.
    pub(super) fn of(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    /// The text.
    pub(super) fn as_str(&self) -> &str {
        &self.0
    }

    /// Adds a token of a template.
    pub(super) fn push(&mut self, token: &str) {
        if !self.0.is_empty() {
            self.0.push(' ');
        }
        self.0.push_str(token);
    }

    /// Adds the value of a template's variable.
    pub(super) fn insert(&mut self, part: &(impl Part + ?Sized)) {
        let before = self.0.len();
        if before > 0 {
            self.0.push(' ');
        }
        let begin = self.0.len();
        part.write(&mut self.0);
        if self.0.len() == begin {
            self.0.truncate(before);
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromIterator<Self> for Source {
    fn from_iter<T: IntoIterator<Item = Self>>(parts: T) -> Self {
        let mut all = Self::new();
        for part in parts {
            all.insert(&part);
        }
        all
    }
}

/// A variable of a template.
pub(super) trait Part {
    /// Adds it to a text.
    fn write(&self, text: &mut String);
}

impl Part for Source {
    fn write(&self, text: &mut String) {
        text.push_str(&self.0);
    }
}

/// A text is a string literal.
impl Part for str {
    fn write(&self, text: &mut String) {
        text.push('"');
        for letter in self.chars() {
            match letter {
                // Unescaped as far as a literal allows.
                ' ' | '!' | '#'..='[' | ']'..='~' => text.push(letter),
                _ => text.extend(letter.escape_debug()),
            }
        }
        text.push('"');
    }
}

impl Part for String {
    fn write(&self, text: &mut String) {
        self.as_str().write(text);
    }
}

impl Part for usize {
    fn write(&self, text: &mut String) {
        text.push_str(&self.to_string());
    }
}

impl<T: Part + ?Sized> Part for &T {
    fn write(&self, text: &mut String) {
        (**self).write(text);
    }
}

impl<T: Part> Part for Option<T> {
    fn write(&self, text: &mut String) {
        if let Some(part) = self {
            part.write(text);
        }
    }
}

/// A variable of a repetition: iterators by value, lists by reference.
pub(super) trait Parts: Iterator + Sized {
    /// The parts in order.
    fn parts(self) -> Self {
        self
    }
}

impl<T: Iterator> Parts for T {}

/// See [`Parts`].
pub(super) trait ListedParts {
    /// Element of the list.
    type Listed;
    /// The parts in order.
    fn parts(&self) -> std::slice::Iter<'_, Self::Listed>;
}

impl<T> ListedParts for [T] {
    type Listed = T;

    fn parts(&self) -> std::slice::Iter<'_, T> {
        self.iter()
    }
}

/// Code from a template like those of the `quote` crate: `#name` inserts the variable of that name,
/// `#(…)*` and `#(…),*` repeat for every element of the variables inside, each used once.
macro_rules! quote {
    () => {
        $crate::emit::rust::source::Source::new()
    };
    ($($template:tt)*) => {{
        let mut source = $crate::emit::rust::source::Source::new();
        $crate::emit::rust::source::tokens!(source $($template)*);
        source
    }};
}

/// Adds the tokens of a template.
macro_rules! tokens {
    ($to:ident) => {};
    ($to:ident # ($($inner:tt)*) * $($rest:tt)*) => {
        $crate::emit::rust::source::repeated!($to [] [$($inner)*] [] $($inner)*);
        $crate::emit::rust::source::tokens!($to $($rest)*);
    };
    ($to:ident # ($($inner:tt)*) $between:tt * $($rest:tt)*) => {
        $crate::emit::rust::source::repeated!($to [$between] [$($inner)*] [] $($inner)*);
        $crate::emit::rust::source::tokens!($to $($rest)*);
    };
    ($to:ident # $part:ident $($rest:tt)*) => {
        $to.insert(&$part);
        $crate::emit::rust::source::tokens!($to $($rest)*);
    };
    ($to:ident ($($inner:tt)*) $($rest:tt)*) => {
        $to.push("(");
        $crate::emit::rust::source::tokens!($to $($inner)*);
        $to.push(")");
        $crate::emit::rust::source::tokens!($to $($rest)*);
    };
    ($to:ident [$($inner:tt)*] $($rest:tt)*) => {
        $to.push("[");
        $crate::emit::rust::source::tokens!($to $($inner)*);
        $to.push("]");
        $crate::emit::rust::source::tokens!($to $($rest)*);
    };
    ($to:ident {$($inner:tt)*} $($rest:tt)*) => {
        $to.push("{");
        $crate::emit::rust::source::tokens!($to $($inner)*);
        $to.push("}");
        $crate::emit::rust::source::tokens!($to $($rest)*);
    };
    ($to:ident $token:tt $($rest:tt)*) => {
        $to.push(stringify!($token));
        $crate::emit::rust::source::tokens!($to $($rest)*);
    };
}

/// Adds a repeated template: finds its variables, then iterates over all of them together.
macro_rules! repeated {
    ($to:ident $between:tt $template:tt [$($part:ident)*] # $next:ident $($rest:tt)*) => {
        $crate::emit::rust::source::repeated!($to $between $template [$($part)* $next] $($rest)*)
    };
    ($to:ident $between:tt $template:tt $parts:tt ($($inner:tt)*) $($rest:tt)*) => {
        $crate::emit::rust::source::repeated!($to $between $template $parts $($inner)* $($rest)*)
    };
    ($to:ident $between:tt $template:tt $parts:tt [$($inner:tt)*] $($rest:tt)*) => {
        $crate::emit::rust::source::repeated!($to $between $template $parts $($inner)* $($rest)*)
    };
    ($to:ident $between:tt $template:tt $parts:tt {$($inner:tt)*} $($rest:tt)*) => {
        $crate::emit::rust::source::repeated!($to $between $template $parts $($inner)* $($rest)*)
    };
    ($to:ident $between:tt $template:tt $parts:tt $token:tt $($rest:tt)*) => {
        $crate::emit::rust::source::repeated!($to $between $template $parts $($rest)*)
    };
    ($to:ident [$($between:tt)*] [$($template:tt)*] [$($part:ident)*]) => {{
        #[allow(unused_imports, reason = "iterators or lists")]
        use $crate::emit::rust::source::{ListedParts as _, Parts as _};
        $(let mut $part = $part.parts();)*
        let mut copies = 0;
        loop {
            $(let Some($part) = $part.next() else {
                break;
            };)*
            if copies > 0 {
                $($to.push(stringify!($between));)*
            }
            copies += 1;
            $crate::emit::rust::source::tokens!($to $($template)*);
        }
    }};
}

pub(super) use {quote, repeated, tokens};
