//! What a program for a board logs over defmt: the bring-up reads it, and the control interrupt must
//! not wait for it.

use crate::BenchError;
use crate::cost::elf::{Image, Isa};
use object::{Object, ObjectSymbol};
use std::fs;
use std::path::Path;

/// What defmt calls for each frame.
const LOGGER: [&str; 3] = ["_defmt_acquire", "_defmt_write", "_defmt_release"];

/// Checks that a program has messages of level `info`, and that none masks interrupts.
///
/// # Errors
/// What is wrong with it.
pub fn check(program: &Path) -> Result<(), BenchError> {
    if messages(program)? == 0 {
        let text = "the program logs nothing below `error`: `DEFMT_LOG` was not `info`";
        return Err(BenchError::Failed(text.to_owned()));
    }
    let image = Image::read(program, Isa::Thumb)?;
    for name in LOGGER {
        if masks_interrupts(&image, name)? {
            let text = format!("`{name}` masks interrupts, and so a log frame delays control");
            return Err(BenchError::Failed(text));
        }
    }
    Ok(())
}

/// Number of messages of level `info`: each is a byte between two symbols of defmt's linker script.
fn messages(program: &Path) -> Result<u64, BenchError> {
    let bytes = fs::read(program)?;
    let file = object::File::parse(bytes.as_slice())?;
    let address = |name: &str| {
        let missing = || BenchError::Failed(format!("the program has no symbol `{name}`"));
        let symbol = file.symbols().find(|symbol| symbol.name() == Ok(name));
        Ok::<u64, BenchError>(symbol.ok_or_else(missing)?.address())
    };
    Ok(address("__DEFMT_MARKER_INFO_END")? - address("__DEFMT_MARKER_INFO_START")?)
}

/// Whether a function has an instruction that masks interrupts.
fn masks_interrupts(image: &Image, name: &str) -> Result<bool, BenchError> {
    let code = image.function(name)?;
    let mut at = code.start;
    while let Some(instruction) = image.instruction(at).filter(|_| at < code.end) {
        if instruction.masks_interrupts() {
            return Ok(true);
        }
        at += instruction.length();
    }
    Ok(false)
}
