//! Generates the drives that the tests compile: the covering array over motors and options, and
//! drives with planted faults.

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
use options::{AXES, describe, drive_toml, generate_toml};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src");
    println!("cargo:rerun-if-changed={}", library::FOLDER);
    let out_dir = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let motors = library::motors();
    write_covering_array(&out_dir, &motors);
    write_mutants(&out_dir);
}

/// The text of emitted modules with one fault each.
fn write_mutants(out_dir: &Path) {
    let (mut text, mut list) = (String::new(), String::new());
    let mut number = 0;
    for (drive, (motor, settings)) in mutation::MUTATED.iter().enumerate() {
        let toml = drive_toml(
            &library::motor(motor),
            &options::choice_of(settings),
            Some("Mutant"),
        );
        let module = emit(&toml, "Mutant").expect("the drive generates");
        for mutant in mutation::mutants(&module, 1) {
            let (what, module) = (mutant.what, mutant.text);
            writeln!(text, "mod mutant_{number:02} {{\n{module}\n}}").expect("a string takes all");
            writeln!(
                list,
                "    ({drive}, {what:?}, is_noticed::<mutant_{number:02}::Mutant>),"
            )
            .expect("a string takes all");
            number += 1;
        }
    }
    let tail = format!(
        "/// Place of the drive, what is wrong, and whether it is noticed.\n\
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

/// Every pair of option values, and every motor with every option value.
fn write_covering_array(out_dir: &Path, motors: &[Motor]) {
    let mut lengths: Vec<usize> = AXES.iter().map(|axis| axis.values.len()).collect();
    lengths.push(motors.len());
    let toml = |row: &[usize], name: Option<&str>| {
        let (motor, choice) = row.split_last().expect("the motor's axis");
        drive_toml(&motors[*motor], choice, name)
    };
    let covering = pairwise::cover(&lengths, |row| generate_toml(&toml(row, None)).is_ok());
    let mut text = String::new();
    let mut list = String::new();
    for (number, row) in covering.rows.iter().enumerate() {
        let name = format!("Row{number:02}");
        let module = emit(&toml(row, Some(&name)), &name).expect("an accepted row generates");
        text.push_str(&module);
        let (motor, choice) = row.split_last().expect("the motor's axis");
        let what = format!("{name} {} {}", motors[*motor].name, describe(choice));
        writeln!(list, "    ({what:?}, verify::<{name}>),").expect("a string takes all");
    }
    let axis_name = |axis: usize| AXES.get(axis).map_or("motor", |axis| axis.name);
    let value_name = |axis: usize, value: usize| match AXES.get(axis) {
        Some(axis) => axis.values[value].0,
        None => &motors[value].name,
    };
    let open: Vec<String> = covering
        .open
        .iter()
        .map(|&((a, x), (b, y))| {
            let (one, two) = (value_name(a, x), value_name(b, y));
            format!("{}={one} {}={two}", axis_name(a), axis_name(b))
        })
        .collect();
    let tail = format!(
        "/// What each row is, and its comparison with the model over so many steps from a seed.\n\
         pub const ROWS: &[(&str, Verify)] = &[\n{list}];\n\
         /// Pairs of values that the generator refuses.\n\
         pub const REFUSED_PAIRS: &[&str] = &{open:?};\n"
    );
    fs::write(out_dir.join("covering_array.rs"), text + &tail).expect("OUT_DIR can be written");
}
