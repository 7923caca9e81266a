//! `hexagen generate`: code, intermediate form or data sheet of one controller.

use crate::cli::{
    DriveArguments, Emit, Failure, note, print_json, print_text, tell_warnings, write_file,
};
use clap::{Args, ValueEnum as _};
use hexagen_codegen::emit::c99::{RUNTIME, Sources, emit_c99};
use hexagen_codegen::emit::gappa::emit_gappa;
use hexagen_lab::engine::Prepared;
use hexagen_lab::times::longer_in_c;
use serde::Serialize;
use std::path::PathBuf;

/// Options of `generate`.
#[derive(Args, Clone, Debug)]
pub struct Options {
    /// The drive.
    #[command(flatten)]
    pub drive: DriveArguments,
    /// Text to print
    #[arg(long, value_enum, default_value = "rust")]
    pub emit: Emit,
    /// Write MOTOR.rs, .ir or .md, all MOTOR.*.g, or the drive's .h and .c with hexagen.h and
    /// hexagen.c into this folder instead of stdout
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON object with the texts of all files
    #[arg(long, conflicts_with = "out")]
    pub json: bool,
}

/// Runs the command.
///
/// # Errors
/// Diagnostics, or a file that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let drive = options.drive.prepare()?;
    tell_warnings(&drive);
    if let (Emit::C99 | Emit::Datasheet, Some(text)) = (options.emit, &drive.warning_in_c) {
        note(text);
    } else if let (Emit::C99, Some(text)) =
        (options.emit, longer_in_c(&drive.generated.interface.times))
    {
        note(&text);
    }
    let files = files_of(&drive, options.emit);
    if options.json {
        return print_json(&Texts {
            motor: &drive.motor,
            controller: &drive.variant,
            files: &files,
        });
    }
    match (&options.out, files.as_slice()) {
        (Some(folder), _) => {
            for File { name, text } in &files {
                let path = folder.join(name);
                write_file(&path, text.as_bytes())?;
                note(&path.display().to_string());
            }
            Ok(())
        }
        (None, [File { text, .. }]) => print_text(text),
        (None, _) => {
            let emit = options.emit.to_possible_value();
            let emit = emit.map_or(String::new(), |value| value.get_name().to_owned());
            Err(Failure::Argument(format!(
                "`--emit {emit}` makes several files; add `--out DIR`, or `--json`"
            )))
        }
    }
}

/// A file of a text.
#[derive(Debug, Serialize)]
struct File {
    name: String,
    text: String,
}

/// The texts of a drive.
#[derive(Debug, Serialize)]
struct Texts<'a> {
    motor: &'a str,
    controller: &'a str,
    files: &'a [File],
}

/// The files of a text, the same bytes for the same drive: for Gappa one per script, in C header and
/// source of drive and runtime.
fn files_of(drive: &Prepared, emit: Emit) -> Vec<File> {
    match emit {
        Emit::Gappa => emit_gappa(&drive.generated.graph)
            .iter()
            .map(|script| File {
                name: format!("{}.{}.g", drive.motor, script.name),
                text: script.to_string(),
            })
            .collect(),
        Emit::C99 => {
            let Sources {
                name,
                header,
                source,
            } = c99_of(drive);
            let own = [("h", header), ("c", source)];
            let own = own.map(|(ending, text)| File {
                name: format!("{name}.{ending}"),
                text,
            });
            let shared = RUNTIME.map(|(name, text)| File {
                name: name.to_owned(),
                text: text.to_owned(),
            });
            own.into_iter().chain(shared).collect()
        }
        Emit::Rust => vec![file_of(drive, emit, drive.rust())],
        Emit::Ir => vec![file_of(
            drive,
            emit,
            drive.generated.graph.program().to_string(),
        )],
        Emit::Datasheet => vec![file_of(drive, emit, drive.data_sheet())],
    }
}

fn file_of(drive: &Prepared, emit: Emit, text: String) -> File {
    let name = format!("{}.{}", drive.motor, emit.ending());
    File { name, text }
}

/// The drive in C, under the name of its type.
fn c99_of(drive: &Prepared) -> Sources {
    let generated = &drive.generated;
    emit_c99(
        &generated.graph,
        &generated.interface,
        &generated.interface.type_name,
    )
}
