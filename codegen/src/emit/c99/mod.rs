//! The C99 emitter: from a verified graph to a header and a source for toolchains without Rust.
//!
//! The same plan as the Rust emitter's, so the same stages under the same names with the same proven ranges. Portable
//! by construction: exact widths of 16 bits and more, no signed overflow, no right shift of a negative number
//! (`helpers`), nothing but `stdbool.h` and `stdint.h` included. Nothing here can fail.

mod expression;
mod function;
mod helpers;
mod interface;
mod layout;
mod methods;
mod names;
mod stage;

use crate::interface::Interface;
use crate::ir::{Constant, Table, VerifiedGraph};
use expression::element;
use function::{emit_setter, emit_step, emit_stores};
use interface::Types;
use layout::{INDENT, words};
use names::{Names, number, typed_number};
use std::collections::BTreeSet;

/// A drive in C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sources {
    /// Begin of every public name, and name of both files: `hub_drive` of `HubDrive`.
    pub name: String,
    /// Text of the header, `hub_drive.h`.
    pub header: String,
    /// Text of the source, `hub_drive.c`.
    pub source: String,
}

/// The header and the source of one drive of this type name.
pub fn emit_c99(graph: &VerifiedGraph, interface: &Interface, type_name: &str) -> Sources {
    let program = graph.program();
    let setters = program.setters.iter().map(|setter| setter.name.clone());
    let names = Names::new(type_name, interface, setters.collect());
    let types = Types {
        program,
        interface,
        names: &names,
    };
    let mut body = types.common();
    let mut code = emit_step(program, &names);
    if words(&code).contains("leg_of") {
        body.push_str(&types.leg_of());
    }
    body.push_str(&code);
    body.push_str(&emit_stores(program, &names));
    for setter in &program.setters {
        body.push_str(&emit_setter(program, setter, &names));
    }
    body.push_str(&types.functions());
    let used = words(&body);
    code = String::new();
    let is_used = |name: &str| used.contains(&names.constant(name));
    let constants = program.constants.iter();
    let constants = constants.filter(|constant| is_used(&constant.name));
    code.extend(constants.map(|constant| emit_constant(constant, &names)));
    code.push_str(&types.own_constants());
    let tables = program.tables.iter().filter(|table| is_used(&table.name));
    code.extend(tables.map(|table| emit_table(table, &names)));
    code.extend(helpers(&used));
    Sources {
        header: types.header(),
        source: head(&names, interface) + &code + &body,
        name: names.prefix,
    }
}

fn helpers(used: &BTreeSet<String>) -> impl Iterator<Item = String> {
    helpers::used(used)
        .into_iter()
        .map(|text| format!("{text}\n"))
}

/// What stands before everything: where to read on, and how functions off the normal path are marked.
fn head(names: &Names, interface: &Interface) -> String {
    let begin = interface.header.first().cloned().unwrap_or_default();
    let see = format!("Specification, accuracy and use: {}.h.", names.prefix);
    let cold = names.public_upper("COLD");
    format!(
        "{}#include \"{}.h\"\n\n{}#if defined(__GNUC__) || defined(__clang__)\n\
         #define {cold} __attribute__((cold, noinline))\n#else\n#define {cold}\n#endif\n\n",
        names.comment("", &[begin, see]),
        names.prefix,
        names.comment("", &["Off the normal path, and not to be inlined into it."]),
    )
}

fn emit_constant(constant: &Constant, names: &Names) -> String {
    let comment = names.comment("", &constant.doc);
    let (name, raw) = (names.constant(&constant.name), typed_number(constant.raw));
    format!("{comment}#define {name} {raw}\n\n")
}

/// A table in the smallest elements that hold it, 16 bits at least: not every core has smaller ones.
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
