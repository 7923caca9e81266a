//! The motors of `targets/motors`, found by directory.

use std::fs;
use std::path::Path;

/// The folder of motor files, relative to this crate.
pub const FOLDER: &str = "../targets/motors";

/// The motor of the published results.
pub const PAPER_MOTOR: &str = "trivedi-keshri-660w";

/// A motor file of the library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Motor {
    /// File name without ending.
    pub name: String,
    /// TOML text.
    pub text: String,
}

/// All motors, in the order of their names.
///
/// # Panics
/// If the library cannot be read or is empty.
pub fn motors() -> Vec<Motor> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(FOLDER);
    let entries = fs::read_dir(&folder).expect("the motor library can be read");
    let mut motors: Vec<Motor> = entries
        .map(|entry| entry.expect("a directory entry").path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .map(|path| Motor {
            name: path
                .file_stem()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned(),
            text: fs::read_to_string(&path).expect("a motor file can be read"),
        })
        .collect();
    assert!(!motors.is_empty(), "no motor in {FOLDER}");
    motors.sort_by(|one, other| one.name.cmp(&other.name));
    motors
}

/// A motor's text with an inertia, as a speed loop needs one.
pub fn with_inertia(text: &str) -> String {
    if text.contains("\ninertia") {
        text.to_owned()
    } else {
        text.replacen("[motor]\n", "[motor]\ninertia = \"3 kg cm2\"\n", 1)
    }
}

/// The motor of this file name.
///
/// # Panics
/// If the library has none.
pub fn motor(name: &str) -> Motor {
    motors()
        .into_iter()
        .find(|motor| motor.name == name)
        .expect("a motor of the library")
}
