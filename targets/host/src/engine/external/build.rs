//! Building emitted code with rustc.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::{env, fs, io};
use tempfile::TempDir;

/// A compiled program in a folder of its own, which goes with it.
#[derive(Debug)]
pub struct External {
    folder: TempDir,
    /// Kept so that programs compiled meanwhile find it built.
    _runtime: Arc<TempDir>,
}

/// Why emitted code was not compiled.
#[derive(Clone, Debug, thiserror::Error)]
pub enum BuildError {
    /// No compiler, or no place to build.
    #[error("rustc cannot run: {0}")]
    NoCompiler(String),
    /// The compiler refused.
    #[error("rustc refuses the {what}:\n{messages}")]
    Refused {
        /// What was compiled.
        what: &'static str,
        /// What the compiler said.
        messages: String,
    },
}

impl From<io::Error> for BuildError {
    fn from(error: io::Error) -> Self {
        Self::NoCompiler(error.to_string())
    }
}

/// The runtime's sources.
const RUNTIME: [(&str, &str); 8] = [
    ("lib.rs", include_str!("../../../../../runtime/src/lib.rs")),
    (
        "arith.rs",
        include_str!("../../../../../runtime/src/arith.rs"),
    ),
    (
        "boundary.rs",
        include_str!("../../../../../runtime/src/boundary.rs"),
    ),
    (
        "double_buffer.rs",
        include_str!("../../../../../runtime/src/double_buffer.rs"),
    ),
    (
        "drive.rs",
        include_str!("../../../../../runtime/src/drive.rs"),
    ),
    (
        "shared_word.rs",
        include_str!("../../../../../runtime/src/shared_word.rs"),
    ),
    (
        "status.rs",
        include_str!("../../../../../runtime/src/status.rs"),
    ),
    (
        "word.rs",
        include_str!("../../../../../runtime/src/word.rs"),
    ),
];

const DRIVER: &str = include_str!("driver.rs");

/// The macros that the runtime re-exports; emitted code calls none.
const MACROS: &str = "#[macro_export] macro_rules! controller { () => {} }\n\
    #[macro_export] macro_rules! verify { () => {} }\n";

/// Names, `from_bits` and `to_bits` of the `fixed` crate's signed 32-bit types.
fn fixed_types() -> String {
    let mut text = String::from(
        "#![no_std]\npub mod types {\n\
         #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]\n\
         pub struct FixedI32<const FRAC: u32>(i32);\n\
         impl<const FRAC: u32> FixedI32<FRAC> {\n\
         pub const fn from_bits(bits: i32) -> Self { Self(bits) }\n\
         pub const fn to_bits(self) -> i32 { self.0 }\n}\n",
    );
    for frac_bits in 0..=32 {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "pub type I{}F{frac_bits} = FixedI32<{frac_bits}>;",
            32 - frac_bits
        );
    }
    text.push_str("}\n");
    text
}

impl External {
    /// The executable.
    pub fn path(&self) -> PathBuf {
        self.folder.path().join(executable())
    }
}

fn executable() -> String {
    format!("drive{}", env::consts::EXE_SUFFIX)
}

/// Compiles an emitted module, whose type is `type_name`, together with the driver.
///
/// # Errors
/// No rustc, or what it said.
pub fn compile(rust: &str, type_name: &str) -> Result<External, BuildError> {
    let runtime = runtime()?;
    let folder = folder()?;
    fs::write(folder.path().join("emitted.rs"), rust)?;
    fs::write(folder.path().join("driver.rs"), DRIVER)?;
    let alias = format!("pub use super::emitted::{type_name} as TheDrive;\n");
    fs::write(folder.path().join("name.rs"), alias)?;
    let mut rustc = rustc(folder.path());
    rustc
        .args(["--crate-type", "bin", "--crate-name", "drive", "-o"])
        .arg(executable())
        .arg("driver.rs")
        .args(libraries(runtime.path(), &["hexagen"]))
        .args(["-A", "dead_code"]);
    run(&mut rustc, "emitted code")?;
    Ok(External {
        folder,
        _runtime: runtime,
    })
}

/// The runtime as libraries: built once and shared while any program needs it.
fn runtime() -> Result<Arc<TempDir>, BuildError> {
    static RUNTIME_FOLDER: Mutex<Weak<TempDir>> = Mutex::new(Weak::new());
    let mut shared = RUNTIME_FOLDER
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    if let Some(folder) = shared.upgrade() {
        return Ok(folder);
    }
    let folder = Arc::new(build_runtime()?);
    *shared = Arc::downgrade(&folder);
    Ok(folder)
}

fn build_runtime() -> Result<TempDir, BuildError> {
    let folder = folder()?;
    let at = folder.path();
    fs::write(at.join("fixed.rs"), fixed_types())?;
    fs::write(at.join("hexagen_macros.rs"), MACROS)?;
    for (name, text) in RUNTIME {
        fs::write(at.join(name), text)?;
    }
    for (name, file, needs) in [
        ("fixed", "fixed.rs", &[][..]),
        ("hexagen_macros", "hexagen_macros.rs", &[]),
        ("hexagen", "lib.rs", &["fixed", "hexagen_macros"]),
    ] {
        let mut rustc = rustc(at);
        rustc
            .args(["--crate-type", "rlib", "--crate-name", name, file])
            .args(libraries(at, needs));
        run(&mut rustc, "runtime")?;
    }
    Ok(folder)
}

fn folder() -> io::Result<TempDir> {
    tempfile::Builder::new().prefix("hexagen-").tempdir()
}

fn rustc(folder: &Path) -> Command {
    let mut rustc = Command::new(env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    rustc.current_dir(folder).args([
        "--edition",
        "2024",
        "-C",
        "opt-level=3",
        "--cap-lints",
        "warn",
    ]);
    rustc
}

fn libraries(folder: &Path, names: &[&str]) -> Vec<String> {
    let mut arguments = vec!["-L".to_owned(), folder.display().to_string()];
    for name in names {
        arguments.push("--extern".to_owned());
        arguments.push(format!(
            "{name}={}",
            folder.join(format!("lib{name}.rlib")).display()
        ));
    }
    arguments
}

fn run(rustc: &mut Command, what: &'static str) -> Result<(), BuildError> {
    let output = rustc.stdin(Stdio::null()).output()?;
    if output.status.success() {
        Ok(())
    } else {
        let messages = String::from_utf8_lossy(&output.stderr).into_owned();
        Err(BuildError::Refused { what, messages })
    }
}
