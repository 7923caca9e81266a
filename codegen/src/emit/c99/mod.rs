//! The C99 emitter: from a verified graph to a header and a source for toolchains without Rust.
//!
//! Same plan as the Rust emitter, so the same stages, names and proven ranges, with the runtime in
//! C (`hexagen-c99`). Portable by construction: exact widths of 16 bits and more, no signed
//! overflow, no right shift of a negative number. Nothing here can fail.

mod commands;
mod drive;
mod expression;
mod function;
mod header;
mod layout;
mod limits;
mod names;
mod stage;

use crate::interface::Interface;
use crate::ir::{Constant, Table, VerifiedGraph};
use drive::Drive;
use expression::element;
use function::emit_step;
use layout::{INDENT, words};
use names::{Names, number, typed_number, verbatim};

/// A drive in C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// Prefix of every public name, and name of both files: `hub_drive` of `HubDrive`.
    pub name: String,
    /// Text of the header, `hub_drive.h`.
    pub header: String,
    /// Text of the source, `hub_drive.c`.
    pub source: String,
}

/// The runtime in C, once per program: names and texts of its files.
pub const RUNTIME: [(&str, &str); 2] = hexagen_c99::FILES;

/// The header and the source of one drive of this type name.
pub fn emit_c99(graph: &VerifiedGraph, interface: &Interface, type_name: &str) -> Sources {
    let program = graph.program();
    let names = Names::new(type_name, program, interface);
    let step = emit_step(program, &names);
    let drive = Drive {
        program,
        interface,
        names: &names,
        step: &step,
    };
    let body = step.definitions.clone() + &drive.functions();
    let used = words(&body);
    let is_used = |name: &str| !name.is_empty() && used.contains(&names.constant(name));
    let mut source = head(&names, interface);
    let constants = program.constants.iter();
    let constants = constants.filter(|constant| is_used(&constant.name));
    source.extend(constants.map(|constant| emit_constant(constant, &names)));
    let tables = program.tables.iter().filter(|table| is_used(&table.name));
    source.extend(tables.map(|table| emit_table(table, &names)));
    source.push_str(&drive.constants());
    source.push_str(&body);
    Sources {
        header: drive.header(),
        source,
        name: names.prefix,
    }
}

/// The head of the source: generator, scale and specification.
fn head(names: &Names, interface: &Interface) -> String {
    let mut lines = vec![
        format!("Use and accuracy: {}.h. Generated from:", names.prefix),
        String::new(),
    ];
    lines.extend(
        interface
            .spec_toml
            .lines()
            .map(|line| format!("{INDENT}{line}")),
    );
    format!("{}#include \"{}.h\"\n\n", verbatim(&lines), names.prefix)
}

fn emit_constant(constant: &Constant, names: &Names) -> String {
    let comment = names.comment("", &constant.doc);
    let (name, raw) = (names.constant(&constant.name), typed_number(constant.raw));
    format!("{comment}#define {name} {raw}\n\n")
}

/// A table in its smallest element type of at least 16 bits: not every core has 8.
fn emit_table(table: &Table, names: &Names) -> String {
    let comment = names.comment("", &table.doc);
    let (name, kind) = (names.constant(&table.name), element(table));
    let lines: Vec<String> = table
        .values
        .chunks(8)
        .map(|values| {
            let values: Vec<String> = values.iter().copied().map(number).collect();
            format!("{INDENT}{}", values.join(", "))
        })
        .collect();
    let count = table.values.len();
    format!(
        "{comment}static const {kind} {name}[{count}] = {{\n{}\n}};\n\n",
        lines.join(",\n")
    )
}
