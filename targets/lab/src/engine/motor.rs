//! Motors by name: a TOML file or a motor of the library.

use super::built_in::{Library, library};
use hexagen_codegen::diagnostics::{did_you_mean_one, similar};
use hexagen_codegen::spec::{motor_text, reason_of};
use std::path::{Path, PathBuf};

/// The TOML text of a motor, with its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MotorSource {
    /// Short name: the library's, or the file's without ending.
    pub name: String,
    /// File name for messages, as given.
    pub file: String,
    /// The text.
    pub text: String,
}

/// Error of reading a motor.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SourceError {
    /// Neither a file nor a motor of the library.
    #[error(
        "no motor `{given}`: neither a file that can be read ({reason}) nor a motor of the library{}",
        did_you_mean_one(meant)
    )]
    Unknown {
        /// As given.
        given: String,
        /// Why it cannot be read as a file.
        reason: String,
        /// The file that lacks its ending, or similar names of the library, quoted.
        meant: Vec<String>,
    },
    /// A file that is not UTF-8, with a rendered diagnostic.
    #[error("{0}")]
    Encoding(String),
}

impl MotorSource {
    /// The motor of a path or of a name of the library. A file takes precedence.
    ///
    /// # Errors
    /// If neither exists, or the file is not text.
    pub fn find(given: &str) -> Result<Self, SourceError> {
        let path = PathBuf::from(given);
        match std::fs::read(&path) {
            Ok(bytes) => Ok(Self {
                name: stem(&path),
                file: given.to_owned(),
                text: motor_text(bytes, given)
                    .map_err(|error| SourceError::Encoding(error.to_string()))?,
            }),
            Err(error) => Self::of_library(given.trim_end_matches(".toml")).ok_or_else(|| {
                let with_ending = format!("{given}.toml");
                let names: Vec<&str> = library().iter().map(|motor| motor.name).collect();
                let meant = if Path::new(&with_ending).is_file() {
                    vec![with_ending.as_str()]
                } else {
                    similar(given, &names)
                };
                SourceError::Unknown {
                    given: given.to_owned(),
                    reason: reason_of(&error),
                    meant: meant.iter().map(|name| format!("`{name}`")).collect(),
                }
            }),
        }
    }

    /// The motor of this name in the library.
    pub fn of_library(name: &str) -> Option<Self> {
        library()
            .iter()
            .find(|motor| motor.name == name)
            .map(Self::from)
    }
}

impl From<&Library> for MotorSource {
    fn from(motor: &Library) -> Self {
        Self {
            name: motor.name.to_owned(),
            file: motor.file.to_owned(),
            text: motor.text.to_owned(),
        }
    }
}

/// The name of a file without folder and ending.
pub fn stem(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}
