//! Building emitted code with rustc, or with the C compiler.

use crate::standalone::{MACROS, fixed};
use hexagen_codegen::emit::c99::{RUNTIME as RUNTIME_C, Sources};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::{env, fs, io};
use tempfile::TempDir;

/// A compiled program in a folder of its own, which is removed with it.
#[derive(Debug)]
pub struct External {
    folder: TempDir,
    /// The Rust runtime, kept for programs compiled meanwhile.
    _runtime: Option<Arc<TempDir>>,
}

/// Error of compiling emitted code.
#[derive(Clone, Debug, thiserror::Error)]
pub enum BuildError {
    /// The compiler cannot be started, or there is no folder to build in.
    #[error("{compiler} cannot run: {reason}")]
    NoCompiler {
        /// Its name.
        compiler: &'static str,
        /// Message of the operating system.
        reason: String,
    },
    /// The compiler reported errors.
    #[error("{compiler} fails on the {what}:\n{messages}")]
    Refused {
        /// Its name.
        compiler: &'static str,
        /// What was compiled.
        what: &'static str,
        /// Messages of the compiler.
        messages: String,
    },
}

/// Names of the compilers in messages.
const RUSTC: &str = "rustc";
const CC: &str = "the C compiler";

impl BuildError {
    /// Whether the compiler, or a folder for it, is missing.
    fn no_compiler(compiler: &'static str) -> impl Fn(io::Error) -> Self {
        move |error| Self::NoCompiler {
            compiler,
            reason: error.to_string(),
        }
    }
}

/// The runtime's sources, by a link to their folder, which a package contains as a folder.
const RUNTIME: [(&str, &str); 22] = [
    ("lib.rs", include_str!("../../../runtime/lib.rs")),
    ("angle.rs", include_str!("../../../runtime/angle.rs")),
    ("arith.rs", include_str!("../../../runtime/arith.rs")),
    ("bus.rs", include_str!("../../../runtime/bus.rs")),
    (
        "bus_watch.rs",
        include_str!("../../../runtime/bus_watch.rs"),
    ),
    ("command.rs", include_str!("../../../runtime/command.rs")),
    (
        "constants.rs",
        include_str!("../../../runtime/constants.rs"),
    ),
    ("control.rs", include_str!("../../../runtime/control.rs")),
    (
        "double_buffer.rs",
        include_str!("../../../runtime/double_buffer.rs"),
    ),
    ("drive.rs", include_str!("../../../runtime/drive.rs")),
    ("format.rs", include_str!("../../../runtime/format.rs")),
    ("limits.rs", include_str!("../../../runtime/limits.rs")),
    (
        "no_signals.rs",
        include_str!("../../../runtime/no_signals.rs"),
    ),
    ("sample.rs", include_str!("../../../runtime/sample.rs")),
    ("sensors.rs", include_str!("../../../runtime/sensors.rs")),
    (
        "set_point.rs",
        include_str!("../../../runtime/set_point.rs"),
    ),
    ("shared.rs", include_str!("../../../runtime/shared.rs")),
    ("signals.rs", include_str!("../../../runtime/signals.rs")),
    ("status.rs", include_str!("../../../runtime/status.rs")),
    (
        "supervisor.rs",
        include_str!("../../../runtime/supervisor.rs"),
    ),
    ("trip.rs", include_str!("../../../runtime/trip.rs")),
    ("word.rs", include_str!("../../../runtime/word.rs")),
];

const DRIVER: &str = include_str!("driver.rs");
const DRIVER_C: &str = include_str!("driver.c");

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
/// No rustc, or its messages.
pub fn compile(rust: &str, type_name: &str) -> Result<External, BuildError> {
    let runtime = runtime()?;
    let alias = format!("pub use super::emitted::{type_name} as TheDrive;\n");
    let files = [
        ("emitted.rs", rust),
        ("driver.rs", DRIVER),
        ("name.rs", &alias),
    ];
    let folder = folder_of(&files).map_err(BuildError::no_compiler(RUSTC))?;
    let mut rustc = rustc(folder.path());
    rustc
        .args(["--crate-type", "bin", "--crate-name", "drive", "-o"])
        .arg(executable())
        .arg("driver.rs")
        .args(libraries(runtime.path(), &["hexagen"]))
        .args(["-A", "dead_code"]);
    run(&mut rustc, RUSTC, "emitted code")?;
    Ok(External {
        folder,
        _runtime: Some(runtime),
    })
}

/// Strict warning flags of users' projects.
const C_FLAGS: [&str; 7] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Werror",
    "-pedantic",
    "-O2",
];

/// Properties of a C drive for the driver.
#[derive(Clone, Copy, Debug)]
pub struct Binding {
    /// State words.
    pub state_words: usize,
    /// Whether it has a measured bus voltage.
    pub has_bus: bool,
    /// Whether it has a speed loop.
    pub has_speed: bool,
    /// Whether its command has intervals.
    pub has_intervals: bool,
}

impl Binding {
    /// The text of `binding.h`.
    fn text(&self, name: &str) -> String {
        let Self {
            state_words,
            has_bus,
            has_speed,
            has_intervals,
        } = *self;
        let [bus, speed, intervals] = [has_bus, has_speed, has_intervals].map(i32::from);
        format!(
            "#include \"{name}.h\"\ntypedef {name} drive_type;\n\
             #define CALL(function) {name}_##function\n#define STATE_WORDS {state_words}\n\
             #define HAS_BUS {bus}\n#define HAS_SPEED {speed}\n#define HAS_INTERVALS {intervals}\n"
        )
    }
}

/// Compiles an emitted header and source with the runtime and the driver, by `CC` with these flags
/// after the strict ones.
///
/// # Errors
/// No C compiler, or its messages.
pub fn compile_c99(
    sources: &Sources,
    binding: &Binding,
    flags: &str,
) -> Result<External, BuildError> {
    let Sources {
        name,
        header,
        source,
    } = sources;
    let [header_file, source_file] = ["h", "c"].map(|ending| format!("{name}.{ending}"));
    let binding = binding.text(name);
    let own = [
        (header_file.as_str(), header.as_str()),
        (&source_file, source),
        ("binding.h", &binding),
        ("driver.c", DRIVER_C),
    ];
    let folder =
        folder_of(&[&own[..], &RUNTIME_C].concat()).map_err(BuildError::no_compiler(CC))?;
    let mut cc = Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()));
    cc.current_dir(folder.path())
        .args(C_FLAGS)
        .args(flags.split_whitespace())
        .arg("-DHEXAGEN_VERIFICATION")
        .args([&source_file, "hexagen.c", "driver.c", "-o"])
        .arg(executable());
    run(&mut cc, CC, "emitted code")?;
    Ok(External {
        folder,
        _runtime: None,
    })
}

/// The runtime as libraries: built once and shared as long as a program needs it.
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
    let fixed = fixed();
    let own = [("fixed.rs", fixed.as_str()), ("hexagen_macros.rs", MACROS)];
    let folder = folder_of(&[&own[..], &RUNTIME].concat());
    let folder = folder.map_err(BuildError::no_compiler(RUSTC))?;
    let at = folder.path();
    for (name, file, needs) in [
        ("fixed", "fixed.rs", &[][..]),
        ("hexagen_macros", "hexagen_macros.rs", &[]),
        ("hexagen", "lib.rs", &["fixed", "hexagen_macros"]),
    ] {
        let mut rustc = rustc(at);
        rustc
            .args(["--crate-type", "rlib", "--crate-name", name, file])
            .args(libraries(at, needs));
        run(&mut rustc, RUSTC, "runtime")?;
    }
    Ok(folder)
}

/// A new folder with these files.
fn folder_of(files: &[(&str, &str)]) -> io::Result<TempDir> {
    let folder = tempfile::Builder::new().prefix("hexagen-").tempdir()?;
    for (name, text) in files {
        fs::write(folder.path().join(name), text)?;
    }
    Ok(folder)
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

fn run(
    command: &mut Command,
    compiler: &'static str,
    what: &'static str,
) -> Result<(), BuildError> {
    let output = command.stdin(Stdio::null()).output();
    let output = output.map_err(BuildError::no_compiler(compiler))?;
    if output.status.success() {
        Ok(())
    } else {
        let messages = String::from_utf8_lossy(&output.stderr).into_owned();
        Err(BuildError::Refused {
            compiler,
            what,
            messages,
        })
    }
}
