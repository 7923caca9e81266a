//! Generation in build scripts: motor files in, one Rust file per motor out, or a header and a
//! source in C99 per drive.
//!
//! The tokens are those of the macro; the file is formatted for readers.

use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::emit::c99::{RUNTIME, Sources, emit_c99};
use crate::emit::module_name;
use crate::emit::rust::{Surface, emit_rust, format_rust};
use crate::pipeline::{Generated, generate, warning_in_c, warnings};
use crate::spec::{Board, SpecAst, apply_variant, check, motor_text, parse_toml};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Generates controllers in a build script.
///
/// ```no_run
/// # fn main() -> Result<(), hexagen_codegen::BuildError> {
/// hexagen_codegen::Builder::new()
///     .motor("motors/hub.toml")
///     .controller("pdcc:emf=model,advance=2")
///     .name("HubDrive")
///     .generate()?;
/// # Ok(())
/// # }
/// ```
///
/// and in the crate: `include!(concat!(env!("OUT_DIR"), "/hub.rs"));`
///
/// Without a call of `controller` a motor takes the controller of its file. With several
/// controllers, each is a type of the same Rust file.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    root: PathBuf,
    out_dir: Option<PathBuf>,
    motors: Vec<Motor>,
    folders: Vec<String>,
    allowed: Vec<String>,
    language: Language,
    /// Whether the last motor came from a folder, whose files have their own controllers.
    in_folder: bool,
    /// The first call without a motor, and its place.
    misplaced: Option<(String, String)>,
}

/// Output language.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Language {
    #[default]
    Rust,
    C99,
}

#[derive(Clone, Debug)]
struct Motor {
    path: String,
    board: Option<String>,
    drives: Vec<Wanted>,
}

/// One controller of a motor.
#[derive(Clone, Debug, Default)]
struct Wanted {
    variant: Option<String>,
    name: Option<String>,
}

/// Files written for a motor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The motor file as it was given.
    pub motor: String,
    /// The Rust file; of C99, the header and the source of each type in turn.
    pub files: Vec<PathBuf>,
    /// Names of the types in them, in the order of the controllers.
    pub types: Vec<String>,
    /// Warnings that are not allowed.
    pub warnings: Vec<String>,
}

/// Error of a build script.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// Errors in specifications, of all motors; each with file, line and column.
    #[error("{}", list(.0))]
    Specification(Vec<Diagnostics>),
    /// A file or folder could not be read or written.
    #[error("{path}: {error}")]
    Io {
        /// As it was given.
        path: String,
        /// The system's error.
        error: io::Error,
    },
    /// Neither [`Builder::out_dir`] nor the environment variable `OUT_DIR` is set.
    #[error("OUT_DIR is not set: call this in a build script, or say `.out_dir(…)`")]
    NoOutDir,
    /// Two controllers of one motor have the same type name.
    #[error("{motor}: two controllers are named {name}; tell them apart with `.name(…)`")]
    SameName {
        /// The motor file.
        motor: String,
        /// The name.
        name: String,
    },
    /// Two types of one motor have the same name in snake case.
    #[error(
        "{motor}: {first} and {second} would both stand in a module `{module}`; tell them apart with `.name(…)`"
    )]
    SameModule {
        /// The motor file.
        motor: String,
        /// The first type.
        first: String,
        /// The second type.
        second: String,
        /// The module.
        module: String,
    },
    /// [`Builder::controller`] or [`Builder::name`] without a preceding [`Builder::motor`].
    #[error("{call} {place}; say it after the `.motor(…)` that it belongs to")]
    Misplaced {
        /// The call as it was written.
        call: String,
        /// Its place.
        place: String,
    },
    /// Two motor files would be written to the same file.
    #[error("{first} and {second} would both be written to {file}; {remedy}")]
    SameFile {
        /// The motor file given first.
        first: String,
        /// The motor file given later.
        second: String,
        /// Its name.
        file: String,
        /// What to change.
        remedy: &'static str,
    },
    /// A type name is not valid in Rust.
    #[error("{motor}: `{name}` is no name for a Rust type; give one with `.name(…)`")]
    BadName {
        /// The motor file.
        motor: String,
        /// The name.
        name: String,
    },
}

fn list(errors: &[Diagnostics]) -> String {
    let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

impl Builder {
    /// A builder with motor files relative to the crate whose build script runs.
    pub fn new() -> Self {
        Self {
            root: env::var_os("CARGO_MANIFEST_DIR")
                .map(PathBuf::from)
                .unwrap_or_default(),
            ..Self::default()
        }
    }

    /// Folder of the motor files, in place of the crate's.
    #[must_use]
    pub fn root(mut self, root: impl Into<PathBuf>) -> Self {
        self.root = root.into();
        self
    }

    /// Output folder, in place of `OUT_DIR`.
    #[must_use]
    pub fn out_dir(mut self, out_dir: impl Into<PathBuf>) -> Self {
        self.out_dir = Some(out_dir.into());
        self
    }

    /// Adds a motor file; later [`Self::controller`] and [`Self::name`] calls belong to it.
    #[must_use]
    pub fn motor(mut self, path: impl Into<String>) -> Self {
        self.motors.push(Motor {
            path: path.into(),
            board: None,
            drives: vec![],
        });
        self.in_folder = false;
        self
    }

    /// The board of the last [`Self::motor`], in place of its file's: a name of the library, or a
    /// path relative to the crate. Its fields replace those of the motor file.
    #[must_use]
    pub fn board(mut self, name: impl Into<String>) -> Self {
        let name = name.into();
        if let Some(motor) = self.owner("board", &name) {
            motor.board = Some(name);
        }
        self
    }

    /// Adds every `*.toml` of a folder, in the order of names, each with its own controller.
    #[must_use]
    pub fn motors(mut self, folder: impl Into<String>) -> Self {
        self.folders.push(folder.into());
        self.in_folder = true;
        self
    }

    /// Adds a controller of the last [`Self::motor`]: `pdcc:emf=model,advance=2`.
    #[must_use]
    pub fn controller(mut self, variant: impl Into<String>) -> Self {
        let variant = variant.into();
        if let Some(motor) = self.owner("controller", &variant) {
            motor.drives.push(Wanted {
                variant: Some(variant),
                name: None,
            });
        }
        self
    }

    /// Names the type of the last controller, or of the last motor's own one. The default name
    /// comes from motor and variant: `HubPdccEmfModelAdvance2`.
    #[must_use]
    pub fn name(mut self, name: impl Into<String>) -> Self {
        let name = name.into();
        if let Some(motor) = self.owner("name", &name) {
            if motor.drives.is_empty() {
                motor.drives.push(Wanted::default());
            }
            if let Some(wanted) = motor.drives.last_mut() {
                wanted.name = Some(name);
            }
        }
        self
    }

    /// The motor that a call belongs to; the first call without one is recorded.
    fn owner(&mut self, method: &str, argument: &str) -> Option<&mut Motor> {
        let place = if self.in_folder {
            let folder = self.folders.last().map_or("", String::as_str);
            format!("follows `.motors({folder:?})`, whose files take their own controllers")
        } else if self.motors.is_empty() {
            "stands before the first motor".to_owned()
        } else {
            return self.motors.last_mut();
        };
        self.misplaced
            .get_or_insert((format!("`.{method}({argument:?})`"), place));
        None
    }

    /// Silences a warning by its code, such as `HX0601`.
    #[must_use]
    pub fn allow(mut self, code: impl Into<String>) -> Self {
        self.allowed.push(code.into());
        self
    }

    /// Writes C99 in place of Rust: the type `HubDrive` becomes `hub_drive.h` and `hub_drive.c`,
    /// the same step bit for bit, beside the shared runtime `hexagen.h` and `hexagen.c`, which is
    /// compiled once.
    #[must_use]
    pub fn c99(mut self) -> Self {
        self.language = Language::C99;
        self
    }

    /// Generates everything and writes one file per motor: `motors/hub.toml` becomes `hub.rs`.
    /// Prints the files to watch and the warnings for cargo.
    ///
    /// # Errors
    /// A call without a motor; motors with the same output file; all errors of all specifications,
    /// before anything is written; else the first file that cannot be read or written.
    pub fn generate(self) -> Result<Vec<Written>, BuildError> {
        let out_dir = self
            .out_dir
            .clone()
            .or_else(|| env::var_os("OUT_DIR").map(PathBuf::from));
        let out_dir = out_dir.ok_or(BuildError::NoOutDir)?;
        let sources = self.sources()?;
        if self.language == Language::C99 {
            for (name, text) in RUNTIME {
                write_whole(&out_dir.join(name), text)?;
            }
        }
        for warning in sources.iter().flat_map(|(_, source)| &source.warnings) {
            println!("cargo:warning={warning}");
        }
        sources
            .into_iter()
            .map(|(motor, source)| source.write(&out_dir, motor))
            .collect()
    }

    /// Generates everything and returns the code, for snapshot tests; writes nothing, and needs no
    /// `out_dir`. A line with its name stands before each of several files. The shared runtime of C99
    /// is not part of it.
    ///
    /// # Errors
    /// As [`generate`](Self::generate).
    pub fn text(self) -> Result<String, BuildError> {
        let sources = self.sources()?;
        let files: Vec<_> = sources
            .iter()
            .flat_map(|(_, source)| &source.files)
            .collect();
        Ok(match files.as_slice() {
            [(_, text)] => text.clone(),
            files => files
                .iter()
                .map(|(name, text)| format!("// {}\n{text}", name.display()))
                .collect::<Vec<_>>()
                .join("\n"),
        })
    }

    /// The files of all motors, with the motors.
    fn sources(&self) -> Result<Vec<(String, Source)>, BuildError> {
        if let Some((call, place)) = self.misplaced.clone() {
            return Err(BuildError::Misplaced { call, place });
        }
        let (mut sources, mut errors) = (vec![], vec![]);
        let motors = self.all_motors()?;
        if self.language == Language::Rust {
            check_files(&motors)?;
        }
        for motor in motors {
            match self.source_of(&motor) {
                Ok(source) => sources.push((motor.path, source)),
                Err(BuildError::Specification(more)) => errors.extend(more),
                Err(other) => return Err(other),
            }
        }
        if !errors.is_empty() {
            return Err(BuildError::Specification(errors));
        }
        check_written(&sources)?;
        Ok(sources)
    }

    fn all_motors(&self) -> Result<Vec<Motor>, BuildError> {
        let mut motors = self.motors.clone();
        for folder in &self.folders {
            println!("cargo:rerun-if-changed={folder}");
            let unreadable = |error| BuildError::Io {
                path: folder.clone(),
                error,
            };
            let mut names = vec![];
            for entry in fs::read_dir(self.root.join(folder)).map_err(unreadable)? {
                let name = entry.map_err(unreadable)?.file_name();
                let name = name.to_string_lossy();
                if Path::new(name.as_ref())
                    .extension()
                    .is_some_and(|extension| extension == "toml")
                {
                    names.push(format!("{folder}/{name}"));
                }
            }
            names.sort_unstable();
            motors.extend(names.into_iter().map(|path| Motor {
                path,
                board: None,
                drives: vec![],
            }));
        }
        Ok(motors)
    }
}

/// Name of the Rust file of a motor file: `hub.rs` of `motors/hub.toml`.
fn file_name(motor: &str) -> PathBuf {
    let stem = Path::new(motor).file_stem().unwrap_or_default();
    Path::new(stem).with_extension("rs")
}

/// Checks that each motor has its own Rust file. Names that differ only in case are one file on
/// some systems.
fn check_files(motors: &[Motor]) -> Result<(), BuildError> {
    let mut files: BTreeMap<String, &str> = BTreeMap::new();
    for motor in motors {
        let file = file_name(&motor.path).display().to_string();
        if let Some(first) = files.insert(file.to_lowercase(), &motor.path) {
            return Err(BuildError::SameFile {
                first: first.to_owned(),
                second: motor.path.clone(),
                file,
                remedy: if first == motor.path {
                    "give a motor once, with all its controllers behind it"
                } else {
                    "rename one of them, or give each a builder with an `.out_dir(…)` of its own"
                },
            });
        }
    }
    Ok(())
}

/// Checks that each drive has its own files, which in C are named by type.
fn check_written(sources: &[(String, Source)]) -> Result<(), BuildError> {
    let mut files: BTreeMap<String, &str> = BTreeMap::new();
    for (motor, source) in sources {
        for (file, _) in &source.files {
            let file = file.display().to_string();
            if let Some(first) = files.insert(file.to_lowercase(), motor) {
                return Err(BuildError::SameFile {
                    first: first.to_owned(),
                    second: motor.clone(),
                    file,
                    remedy: "tell their types apart with `.name(…)`",
                });
            }
        }
    }
    Ok(())
}

/// The files of one motor.
#[derive(Default)]
struct Source {
    files: Vec<(PathBuf, String)>,
    types: Vec<String>,
    warnings: Vec<String>,
}

impl Builder {
    /// The specification of a motor with its board; tells the paths of the boards' files.
    fn specification(
        &self,
        text: &str,
        motor: &Motor,
        files: &mut Vec<String>,
    ) -> Result<SpecAst, Diagnostics> {
        let mut ast = parse_toml(text, &motor.path)?;
        if let Some(board) = &motor.board {
            let mut board = Board::named(board.as_str().into())?;
            files.extend(board.read(&self.root, Path::new(""))?);
            ast.put_on(board);
        }
        ast.read_board(&self.root, &motor.path, files)?;
        Ok(ast)
    }

    fn source_of(&self, motor: &Motor) -> Result<Source, BuildError> {
        println!("cargo:rerun-if-changed={}", motor.path);
        let bytes = fs::read(self.root.join(&motor.path)).map_err(|error| BuildError::Io {
            path: motor.path.clone(),
            error,
        })?;
        let mut files = vec![];
        let ast = motor_text(bytes, &motor.path)
            .and_then(|text| self.specification(&text, motor, &mut files));
        for file in files {
            println!("cargo:rerun-if-changed={file}");
        }
        let ast = ast.map_err(|errors| BuildError::Specification(vec![errors]))?;
        let own = [Wanted::default()];
        let drives = if motor.drives.is_empty() {
            &own[..]
        } else {
            &motor.drives
        };
        let mut source = Source::default();
        let mut errors = vec![];
        for wanted in drives {
            match generate_wanted(&ast, wanted, self.language) {
                Ok((generated, warnings)) => {
                    source.add(&generated, &motor.path, self.language)?;
                    let warnings = warnings
                        .iter()
                        .filter(|warning| !self.allowed.contains(&warning.code.to_string()));
                    source.warnings.extend(warnings.map(ToString::to_string));
                }
                Err(more) => errors.push(more),
            }
        }
        if errors.is_empty() {
            Ok(source)
        } else {
            Err(BuildError::Specification(errors))
        }
    }
}

fn generate_wanted(
    ast: &SpecAst,
    wanted: &Wanted,
    language: Language,
) -> Result<(Generated, Vec<Diagnostic>), Diagnostics> {
    let mut ast = ast.clone();
    if let Some(variant) = &wanted.variant {
        apply_variant(&mut ast, variant)?;
        ast.name.text.push_str(&variant_name(variant));
    }
    if let Some(name) = &wanted.name {
        ast.name.text.clone_from(name);
    }
    let (spec, origins) = check(&ast)?;
    let generated = generate(&spec, &origins)?;
    let times = &generated.interface.times;
    let mut warnings = warnings(&spec, &origins, times);
    if language == Language::C99 {
        warnings.extend(warning_in_c(&origins, times));
    }
    Ok((generated, warnings))
}

impl Source {
    fn add(
        &mut self,
        generated: &Generated,
        motor: &str,
        language: Language,
    ) -> Result<(), BuildError> {
        let name = generated.interface.type_name.clone();
        if syn::parse_str::<syn::Ident>(&name).is_err() {
            return Err(BuildError::BadName {
                motor: motor.to_owned(),
                name,
            });
        }
        if self.types.contains(&name) {
            return Err(BuildError::SameName {
                motor: motor.to_owned(),
                name,
            });
        }
        let module = module_name(&name);
        if let Some(first) = self.types.iter().find(|known| module_name(known) == module) {
            return Err(BuildError::SameModule {
                motor: motor.to_owned(),
                first: first.clone(),
                second: name,
                module,
            });
        }
        match language {
            Language::Rust => self.add_rust(generated, motor, &name),
            Language::C99 => self.add_c99(generated, &name),
        }
        self.types.push(name);
        Ok(())
    }

    fn add_rust(&mut self, generated: &Generated, motor: &str, name: &str) {
        let Generated { graph, interface } = generated;
        let tokens = emit_rust(graph, interface, &Surface::public(name));
        let text = format_rust(&tokens);
        match self.files.as_mut_slice() {
            [] => self.files.push((file_name(motor), text)),
            [(_, known), ..] => {
                known.push('\n');
                known.push_str(&text);
            }
        }
    }

    fn add_c99(&mut self, generated: &Generated, name: &str) {
        let Generated { graph, interface } = generated;
        let Sources {
            name,
            header,
            source,
        } = emit_c99(graph, interface, name);
        let file = |ending: &str| PathBuf::from(format!("{name}.{ending}"));
        let files = [(file("h"), header), (file("c"), source)];
        self.files.extend(files);
    }

    /// Writes all files.
    fn write(self, out_dir: &Path, motor: String) -> Result<Written, BuildError> {
        let files = self.files.iter();
        let files = files.map(|(file, text)| write_whole(&out_dir.join(file), text));
        Ok(Written {
            motor,
            files: files.collect::<Result<_, _>>()?,
            types: self.types,
            warnings: self.warnings,
        })
    }
}

/// Writes beside the file and renames, so that no reader sees half of it. (The program's own writer
/// uses a crate for temporary files, which build scripts do without.)
fn write_whole(file: &Path, text: &str) -> Result<PathBuf, BuildError> {
    let mut beside = file.as_os_str().to_owned();
    beside.push(format!(".{}", std::process::id()));
    let failed = |error| BuildError::Io {
        path: file.display().to_string(),
        error,
    };
    fs::write(&beside, text)
        .and_then(|()| fs::rename(&beside, file))
        .inspect_err(|_| {
            let _ = fs::remove_file(&beside);
        })
        .map_err(failed)?;
    Ok(file.to_owned())
}

/// `PdccEmfModelAdvance1p5` of `pdcc:emf=model,advance=1.5`.
fn variant_name(variant: &str) -> String {
    let mut name = String::new();
    let mut begins = true;
    for letter in variant.chars() {
        match letter {
            '.' => name.push('p'),
            letter if letter.is_ascii_alphanumeric() && begins => {
                name.push(letter.to_ascii_uppercase());
            }
            letter if letter.is_ascii_alphanumeric() => name.push(letter),
            _ => {}
        }
        begins = !letter.is_ascii_alphanumeric() && letter != '.';
    }
    name
}

#[cfg(test)]
mod tests;
