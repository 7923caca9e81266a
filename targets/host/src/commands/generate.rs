//! `hexagen generate`: code, intermediate form or data sheet of one controller.

use crate::cli::{DriveArguments, Emit, Failure, note, print_text, tell_warnings, write_file};
use clap::Args;
use hexagen_codegen::emit::c99::{RUNTIME, Sources, emit_c99};
use hexagen_codegen::emit::gappa::emit_gappa;
use hexagen_lab::engine::Prepared;
use std::path::{Path, PathBuf};

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
}

/// A text of a drive; the same drive gives the same bytes.
pub fn text_of(drive: &Prepared, emit: Emit) -> String {
    let generated = &drive.generated;
    match emit {
        Emit::Rust => drive.rust(),
        Emit::C99 => {
            let Sources { header, source, .. } = c99_of(drive);
            header + "\n" + &source
        }
        Emit::Ir => generated.graph.program().to_string(),
        Emit::Datasheet => drive.data_sheet(),
        Emit::Gappa => emit_gappa(&generated.graph)
            .iter()
            .map(ToString::to_string)
            .collect::<Vec<_>>()
            .join("\n"),
    }
}

/// Runs the command.
///
/// # Errors
/// Diagnostics, or a file that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let drive = options.drive.prepare()?;
    tell_warnings(&drive);
    match options.emit {
        Emit::Gappa => return write_scripts(&drive, options.out.as_deref()),
        Emit::C99 => return write_c99(&drive, options.out.as_deref()),
        _ => {}
    }
    let text = text_of(&drive, options.emit);
    let Some(folder) = &options.out else {
        return print_text(&text);
    };
    let path = folder.join(format!("{}.{}", drive.motor, options.emit.ending()));
    write_file(&path, text.as_bytes())?;
    note(&path.display().to_string());
    Ok(())
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

/// Writes header and source of the drive and of the runtime; the source includes both headers.
fn write_c99(drive: &Prepared, folder: Option<&Path>) -> Result<(), Failure> {
    let folder = folder.ok_or_else(|| {
        Failure::Argument("`--emit c99` writes four files; add `--out DIR`".to_owned())
    })?;
    let Sources {
        name,
        header,
        source,
    } = c99_of(drive);
    let own = [("h", header), ("c", source)];
    let own = own.map(|(ending, text)| (format!("{name}.{ending}"), text));
    let shared = RUNTIME.map(|(name, text)| (name.to_owned(), text.to_owned()));
    for (name, text) in own.into_iter().chain(shared) {
        let path = folder.join(name);
        write_file(&path, text.as_bytes())?;
        note(&path.display().to_string());
    }
    Ok(())
}

/// Writes one file per script, as the checker reads them.
fn write_scripts(drive: &Prepared, folder: Option<&Path>) -> Result<(), Failure> {
    let folder = folder.ok_or_else(|| {
        Failure::Argument("`--emit gappa` writes several files; add `--out DIR`".to_owned())
    })?;
    for script in emit_gappa(&drive.generated.graph) {
        let path = folder.join(format!("{}.{}.g", drive.motor, script.name));
        write_file(&path, script.to_string().as_bytes())?;
    }
    note(&folder.display().to_string());
    Ok(())
}
