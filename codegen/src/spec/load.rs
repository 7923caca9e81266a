//! Reading motor files.

use super::SpecAst;
use super::toml_syntax::parse_toml;
use crate::diagnostics::{Diagnostics, Location, catalogue};
use std::path::Path;

/// Reads and parses the motor file `relative` under `root` (the crate's folder).
///
/// Messages name the relative path only. `at`: where the path was written.
///
/// # Errors
/// If the path is absolute, or the file cannot be read, is not UTF-8 or is not TOML.
pub fn load_motor_file(root: &Path, relative: &str, at: &Location) -> Result<SpecAst, Diagnostics> {
    if is_absolute(relative) {
        return Err(catalogue::absolute_motor_file(at).into());
    }
    let bytes = std::fs::read(root.join(relative)).map_err(|error| {
        catalogue::unreadable_motor_file(at, relative, &error.kind().to_string())
    })?;
    parse_toml(&motor_text(bytes, relative)?, relative)
}

/// The text of a motor file; `file_name` is used in messages.
///
/// # Errors
/// If the bytes are not UTF-8.
pub fn motor_text(bytes: Vec<u8>, file_name: &str) -> Result<String, Diagnostics> {
    String::from_utf8(bytes).map_err(|error| {
        let offset = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let before = String::from_utf8_lossy(&bytes[..offset]);
        let at = Location::in_file(file_name, &before, offset);
        catalogue::motor_file_is_no_text(&at, bytes[offset], offset).into()
    })
}

/// Whether a path is absolute on any system.
pub(crate) fn is_absolute(path: &str) -> bool {
    Path::new(path).has_root() || path.contains(':')
}

#[cfg(test)]
mod tests {
    use super::load_motor_file;
    use crate::diagnostics::Location;
    use crate::spec::toml_syntax::type_name;
    use std::path::Path;

    #[test]
    fn names_of_types() {
        assert_eq!(
            type_name("targets/motors/trivedi-keshri-660w.toml"),
            "TrivediKeshri660w"
        );
        assert_eq!(type_name("5sme.toml"), "Motor5sme");
    }

    #[test]
    fn no_absolute_path_is_read_or_told() {
        let at = Location::File {
            file: "macro".into(),
            line: 1,
            column: 1,
        };
        let error = load_motor_file(Path::new("/nowhere"), "/etc/hub.toml", &at)
            .expect_err("is absolute")
            .to_string();
        assert!(
            error.contains("absolute") && !error.contains("/etc"),
            "{error}"
        );
        let error = load_motor_file(Path::new("/nowhere"), "hub.toml", &at)
            .expect_err("does not exist")
            .to_string();
        assert_eq!(
            error,
            "macro:1:1: error[HX0108]: `motor`: the file \"hub.toml\" cannot be read (entity not found); give a path relative to the crate's Cargo.toml"
        );
    }
}
