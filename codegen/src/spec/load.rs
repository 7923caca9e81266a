//! Reading motor files.

use super::ast::{Board, SpecAst};
use super::toml_syntax::{parse_board, parse_toml};
use crate::diagnostics::{Diagnostics, Location, catalogue};
use std::io::ErrorKind;
use std::path::Path;

/// Reads and parses the motor file `relative` under `root` (the crate's folder), and the board's file
/// that it names; tells the paths of both in `files`.
///
/// Messages name the relative path only. `at`: where the path was written.
///
/// # Errors
/// If the path is absolute, or the file cannot be read, is not UTF-8 or is not TOML.
pub fn load_motor_file(
    root: &Path,
    relative: &str,
    at: &Location,
    files: &mut Vec<String>,
) -> Result<SpecAst, Diagnostics> {
    if is_absolute(relative) {
        return Err(catalogue::absolute_motor_file(at).into());
    }
    let bytes = std::fs::read(root.join(relative))
        .map_err(|error| catalogue::unreadable_motor_file(at, relative, &reason_of(&error)))?;
    files.push(relative.to_owned());
    let mut ast = parse_toml(&motor_text(bytes, relative)?, relative)?;
    ast.read_board(root, relative, files)?;
    Ok(ast)
}

/// Why a file cannot be read, in words; those of the system differ from one to the next.
pub fn reason_of(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is none".to_owned(),
        kind => kind.to_string(),
    }
}

impl Board {
    /// Reads the file, where that is still to be done; its path relative to `root`, which a path
    /// under `folder` is. Nothing of a board of the library.
    ///
    /// # Errors
    /// If the path is absolute, or the file cannot be read or is no TOML.
    pub fn read(&mut self, root: &Path, folder: &Path) -> Result<Option<String>, Diagnostics> {
        if self.file.is_some() {
            return Ok(None);
        }
        let (given, at) = (&self.name.text, &self.name.location);
        if is_absolute(given) {
            return Err(catalogue::absolute_board_file(at).into());
        }
        let relative = folder.join(given).to_string_lossy().replace('\\', "/");
        let bytes = std::fs::read(root.join(&relative))
            .map_err(|error| catalogue::unreadable_board_file(at, &relative, &reason_of(&error)))?;
        self.file = Some(parse_board(&motor_text(bytes, &relative)?, &relative)?);
        Ok(Some(relative))
    }
}

impl SpecAst {
    /// Reads the board's file that the motor file `relative` under `root` names; tells its path.
    ///
    /// # Errors
    /// If its path is absolute, or it cannot be read, is not UTF-8 or is no TOML.
    pub fn read_board(
        &mut self,
        root: &Path,
        relative: &str,
        files: &mut Vec<String>,
    ) -> Result<(), Diagnostics> {
        let folder = Path::new(relative).parent().unwrap_or(Path::new(""));
        if let Some(board) = &mut self.board {
            files.extend(board.read(root, folder)?);
        }
        Ok(())
    }
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
pub(super) fn is_absolute(path: &str) -> bool {
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
        let error = load_motor_file(Path::new("/nowhere"), "/etc/hub.toml", &at, &mut vec![])
            .expect_err("is absolute")
            .to_string();
        assert!(
            error.contains("absolute") && !error.contains("/etc"),
            "{error}"
        );
        let error = load_motor_file(Path::new("/nowhere"), "hub.toml", &at, &mut vec![])
            .expect_err("does not exist")
            .to_string();
        assert_eq!(
            error,
            "macro:1:1: error[HX0108]: `motor`: the file \"hub.toml\" cannot be read (there is none); give a path relative to the crate's Cargo.toml"
        );
    }
}
