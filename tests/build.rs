//! Generates covering arrays over motors and options for each kind of controller, the code of those of
//! their drives that the tests compile, and drives with planted faults.
//!
//! In a push a motor meets both word lengths, and of the rows those are compiled that together have
//! every value and every motor; the environment's `HEXAGEN_WHOLE_PRODUCTS` lets a motor meet every
//! option value, and compiles all rows.

#[expect(dead_code, reason = "shared with the tests, which use the rest")]
#[path = "src/library.rs"]
mod library;
#[path = "src/mutation.rs"]
mod mutation;
#[expect(dead_code, reason = "shared with the tests, which use the rest")]
#[path = "src/options.rs"]
mod options;
#[path = "src/pairwise.rs"]
mod pairwise;

use hexagen_codegen::emit::rust::{Surface, emit_rust, format_rust};
use library::Motor;
use options::{Kind, generate_toml, kinds};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

/// Makes every motor meet every option value, and compiles every row.
const WHOLE_PRODUCTS: &str = "HEXAGEN_WHOLE_PRODUCTS";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src");
    println!("cargo:rerun-if-env-changed={WHOLE_PRODUCTS}");
    println!("cargo:rerun-if-changed={}", library::FOLDER);
    let out_dir = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let motors = library::motors();
    write_covering_arrays(&out_dir, &motors);
    write_mutants(&out_dir);
}

/// The text of emitted modules with one fault each.
fn write_mutants(out_dir: &Path) {
    let (mut text, mut list) = (String::new(), String::new());
    let mut number = 0;
    for (place, drive) in mutation::MUTATED.iter().enumerate() {
        let toml = drive.toml(Some("Mutant"));
        let module = emit(&toml, "Mutant").expect("the drive generates");
        for mutant in mutation::mutants(&module, 1) {
            let (what, module) = (mutant.what, mutant.text);
            writeln!(text, "mod mutant_{number:02} {{\n{module}\n}}").expect("a string takes all");
            writeln!(
                list,
                "    ({place}, {what:?}, is_noticed::<mutant_{number:02}::Mutant>),"
            )
            .expect("a string takes all");
            number += 1;
        }
    }
    let tail = format!(
        "/// Place of the drive, what is wrong, and whether it is detected.\n\
         pub const MUTANTS: &[(usize, &str, IsNoticed)] = &[\n{list}];\n"
    );
    fs::write(out_dir.join("mutants.rs"), text + &tail).expect("OUT_DIR can be written");
}

/// A drive's emitted module.
fn emit(toml: &str, name: &str) -> Option<String> {
    let (_, generated) = generate_toml(toml).ok()?;
    let tokens = emit_rust(
        &generated.graph,
        &generated.interface,
        &Surface::public(name),
    );
    Some(format_rust(&tokens))
}

/// The covering arrays of all kinds of controllers.
fn write_covering_arrays(out_dir: &Path, motors: &[Motor]) {
    let (mut modules, mut rows, mut refused) = (String::new(), String::new(), String::new());
    let mut specifications = String::new();
    for kind in kinds() {
        let array = CoveringArray::of(&kind, motors);
        modules.push_str(&array.modules);
        rows.push_str(&array.rows);
        refused.push_str(&array.refused);
        specifications.push_str(&array.specifications);
    }
    let tail = format!(
        "/// Kind of controller, what the row is, and its comparison with the model over so many steps\n\
         /// from a seed.\n\
         pub const ROWS: &[(&str, &str, Verify)] = &[\n{rows}];\n\
         /// Pairs without a row, and the codes of the diagnostics that reject them.\n\
         pub const REFUSED: &[(&str, &str)] = &[\n{refused}];\n"
    );
    fs::write(out_dir.join("covering_array.rs"), modules + &tail).expect("OUT_DIR can be written");
    let list = format!(
        "/// All rows of the covering arrays.\n\
         pub const SPECIFICATIONS: &[Row] = &[\n{specifications}];\n"
    );
    fs::write(out_dir.join("covering_specifications.rs"), list).expect("OUT_DIR can be written");
}

/// Rows of a kind, with every pair of option values, and every motor with both word lengths or with
/// every option value: specifications of all, code of those that are compiled.
#[derive(Default)]
struct CoveringArray {
    modules: String,
    rows: String,
    specifications: String,
    refused: String,
}

impl CoveringArray {
    fn of(kind: &Kind, motors: &[Motor]) -> Self {
        let mut array = Self::default();
        let first = kind.choice_of(&[]);
        // A motor without this controller is in no pair.
        let (able, unable): (Vec<&Motor>, Vec<&Motor>) = motors
            .iter()
            .partition(|motor| refusal(&kind.drive_toml(motor, &first, None)).is_empty());
        for motor in unable {
            let codes = refusal(&kind.drive_toml(motor, &first, None));
            array.refuse(&format!("{} motor={}", kind.name, motor.name), &codes);
        }
        let toml = |row: &[usize], name: Option<&str>| {
            let (motor, choice) = row.split_last().expect("the motor's axis");
            kind.drive_toml(able[*motor], choice, name)
        };
        let mut lengths: Vec<usize> = kind.axes.iter().map(|axis| axis.values.len()).collect();
        lengths.push(able.len());
        let is_whole = env::var_os(WHOLE_PRODUCTS).is_some();
        let is_paired = |one: usize, other: usize| {
            let is_motor = other == kind.axes.len();
            !is_motor || is_whole || kind.axes[one].name == "word"
        };
        let accepts = |row: &[usize]| generate_toml(&toml(row, None)).is_ok();
        let covering = pairwise::cover(&lengths, is_paired, accepts);
        let compiled = if is_whole {
            (0..covering.rows.len()).collect()
        } else {
            pairwise::each_value(&covering.rows)
        };
        for (number, row) in covering.rows.iter().enumerate() {
            let name = format!("{}{number:02}", type_name(kind));
            let toml = toml(row, Some(&name));
            let (motor, choice) = row.split_last().expect("the motor's axis");
            let what = format!("{name} {} {}", able[*motor].name, kind.describe(choice));
            let is_compiled = compiled.contains(&number);
            writeln!(
                array.specifications,
                "    Row {{ kind: {:?}, what: {what:?}, toml: {toml:?}, is_compiled: {is_compiled} }},",
                kind.name
            )
            .expect("a string takes all");
            if !is_compiled {
                continue;
            }
            let module = emit(&toml, &name).expect("an accepted row generates");
            array.modules.push_str(&module);
            writeln!(
                array.rows,
                "    ({:?}, {what:?}, verify::<{name}>),",
                kind.name
            )
            .expect("a string takes all");
        }
        let setting = |(axis, value): (usize, usize)| match kind.axes.get(axis) {
            Some(axis) => format!("{}={}", axis.name, axis.values[value].name),
            None => format!("motor={}", able[value].name),
        };
        for &(one, two) in &covering.open {
            let mut row = vec![0; lengths.len()];
            (row[one.0], row[two.0]) = (one.1, two.1);
            let what = format!("{} {} {}", kind.name, setting(one), setting(two));
            array.refuse(&what, &refusal(&toml(&row, None)));
        }
        array
    }

    fn refuse(&mut self, what: &str, codes: &str) {
        writeln!(self.refused, "    ({what:?}, {codes:?}),").expect("a string takes all");
    }
}

/// `FcsMpc`
fn type_name(kind: &Kind) -> String {
    let words = kind.name.split('-');
    words
        .map(|word| word[..1].to_uppercase() + &word[1..])
        .collect()
}

/// Codes of the diagnostics that reject a drive; empty if it is valid.
fn refusal(toml: &str) -> String {
    let codes = generate_toml(toml).err().into_iter().flatten();
    let codes: BTreeSet<String> = codes.map(|error| error.code.to_string()).collect();
    codes.into_iter().collect::<Vec<_>>().join(" ")
}
