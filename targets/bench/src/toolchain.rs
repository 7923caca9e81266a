//! Finds a target's compiler and emulator: installed ones first, then Debian's own Rust, which
//! builds `core` from its sources.

use crate::targets::Target;
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Debian's packages of all targets.
const PACKAGES: [&str; 8] = [
    "rustc-web",
    "cargo-web",
    "rust-web-clippy",
    "rust-web-src",
    "qemu-system-arm",
    "qemu-system-misc",
    "gcc-arm-none-eabi",
    "gcc-riscv64-unknown-elf",
];

/// Debian's compiler and package tool; those on the path may be others.
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
const DEBIAN_CARGO: &str = "/usr/bin/cargo";
const DEBIAN_CLIPPY: &str = "/usr/bin/cargo-clippy";

/// Compiler of a target.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Toolchain {
    /// The compiler on the path, which has the target.
    Installed {
        /// Output of `rustc --version`.
        version: String,
    },
    /// Debian's compiler, with the sources of `core`.
    Debian {
        /// Output of `rustc --version`.
        version: String,
        /// A linker of the LLVM project.
        linker: PathBuf,
    },
}

/// No tools to compile or run firmware of a target.
#[derive(Debug, thiserror::Error)]
#[error(
    "firmware for {} cannot be {what} here: {reason}\n\
     install: rustup target add {}, {} and {}\n\
     or, on Debian: apt-get install --no-install-recommends {}",
    .target.name(), .target.triple(), .target.c_compiler(), .target.emulator(), PACKAGES.join(" ")
)]
pub struct Missing {
    target: Target,
    what: &'static str,
    reason: String,
}

impl Missing {
    fn new(target: Target, what: &'static str, reason: impl Into<String>) -> Self {
        Self {
            target,
            what,
            reason: reason.into(),
        }
    }
}

/// The toolchain of a target, with its emulator and C compiler. If one is missing and this is a
/// continuous integration run as root, Debian's packages are installed first.
///
/// # Errors
/// The missing tool and how to get it.
pub fn find(target: Target) -> Result<Toolchain, Missing> {
    let found = look(target);
    if found.is_err() && env::var_os("CI").is_some() && install() {
        return look(target);
    }
    found
}

fn look(target: Target) -> Result<Toolchain, Missing> {
    let emulator = target.emulator();
    if output(Command::new(emulator).arg("--version")).is_none() {
        let reason = format!("`{emulator}` is not on the path");
        return Err(Missing::new(target, "run", reason));
    }
    let c_compiler = target.c_compiler();
    if output(Command::new(c_compiler).arg("--version")).is_none() {
        let reason = format!("`{c_compiler}`, for drives in C, is not on the path");
        return Err(Missing::new(target, "compiled", reason));
    }
    compiler(target)
}

fn compiler(target: Target) -> Result<Toolchain, Missing> {
    let mut rustc = plain("rustc");
    let sysroot = output(rustc.args(["--print", "sysroot"])).unwrap_or_default();
    let libraries = Path::new(sysroot.trim()).join("lib/rustlib");
    if libraries.join(target.triple()).join("lib").is_dir()
        && let Some(version) = output(plain("rustc").arg("--version"))
    {
        let version = version.trim().to_owned();
        return Ok(Toolchain::Installed { version });
    }
    let absent = |reason: &str| Err(Missing::new(target, "compiled", reason));
    let Some(version) = output(Command::new(DEBIAN_RUSTC).arg("--version")) else {
        return absent("the compiler on the path lacks the target, and Debian's is not installed");
    };
    let root = output(Command::new(DEBIAN_RUSTC).args(["--print", "sysroot"])).unwrap_or_default();
    let sources = Path::new(root.trim()).join("lib/rustlib/src/rust/library/core");
    let tools = [DEBIAN_CARGO, DEBIAN_CLIPPY];
    if !sources.is_dir() || !tools.iter().all(|tool| Path::new(tool).is_file()) {
        return absent(
            "Debian's Rust is installed without cargo, its lints or the sources of `core`",
        );
    }
    let Some(linker) = linker(&libraries) else {
        return absent("neither the compiler on the path nor Debian has a linker `lld`");
    };
    Ok(Toolchain::Debian {
        version: version.trim().to_owned(),
        linker,
    })
}

/// `rust-lld` of the compiler on the path, else Debian's `lld`.
fn linker(libraries: &Path) -> Option<PathBuf> {
    let hosts = libraries.read_dir().into_iter().flatten().flatten();
    hosts
        .map(|host| host.path().join("bin/rust-lld"))
        .chain([PathBuf::from("/usr/bin/ld.lld")])
        .find(|path| path.is_file())
}

/// Installs Debian's packages; true on success.
fn install() -> bool {
    let run = |arguments: &[&str]| {
        println!("== set-up: apt-get {}", arguments.join(" "));
        Command::new("apt-get")
            .env("DEBIAN_FRONTEND", "noninteractive")
            .args(arguments)
            .status()
            .is_ok_and(|status| status.success())
    };
    let mut install = vec!["install", "-y", "-qq", "--no-install-recommends"];
    install.extend(PACKAGES);
    run(&["update", "-qq"]) && run(&install)
}

/// A program on the path, without the environment of an outer cargo.
fn plain(program: &str) -> Command {
    let mut command = Command::new(program);
    for name in [
        "RUSTUP_TOOLCHAIN",
        "CARGO",
        "RUSTC",
        "RUSTFLAGS",
        "CARGO_ENCODED_RUSTFLAGS",
    ] {
        command.env_remove(name);
    }
    command
}

fn output(command: &mut Command) -> Option<String> {
    let output = command.output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then_some(text)
}

impl Toolchain {
    /// Output of `rustc --version`.
    pub fn version(&self) -> &str {
        match self {
            Self::Installed { version } | Self::Debian { version, .. } => version,
        }
    }

    /// A cargo command, `build` or `clippy`, for a target.
    pub fn cargo(&self, name: &str, target: Target) -> Command {
        let mut command = match self {
            Self::Installed { .. } => plain("cargo"),
            Self::Debian { linker, .. } => {
                let triple = target.triple().replace('-', "_").to_uppercase();
                // By its own path: cargo would look beside rustup's commands first.
                let is_lint = name == "clippy";
                let mut command = plain(if is_lint { DEBIAN_CLIPPY } else { DEBIAN_CARGO });
                command
                    .env("CARGO", DEBIAN_CARGO)
                    .env("RUSTC", DEBIAN_RUSTC)
                    .env("RUSTC_BOOTSTRAP", "1")
                    .env(format!("CARGO_TARGET_{triple}_LINKER"), linker);
                command
            }
        };
        command.args([name, "--release", "--target", target.triple()]);
        if matches!(self, Self::Debian { .. }) {
            command.arg("-Zbuild-std=core");
        }
        command
    }
}
