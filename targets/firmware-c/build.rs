//! Emits the drives of `src/list.rs` as C99, compiles them for the target, and writes their
//! interface for Rust: `drives.rs`, a list of calls of the macro in `src/drive.rs`.

use hexagen_codegen::emit::c99::{RUNTIME, emit_c99};
use hexagen_codegen::ir::Program;
use hexagen_codegen::pipeline::{Generated, generate};
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

#[path = "src/list.rs"]
mod list;

/// Flags that emitted C is documented to pass.
const STRICT: [&str; 6] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Werror",
    "-pedantic",
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src/list.rs");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    for (name, text) in RUNTIME {
        fs::write(out.join(name), text)?;
    }
    let drives = list::DRIVES.iter().map(|drive| compile(drive, &out));
    let drives: Result<String, _> = drives.collect();
    // After the libraries that call it.
    build(&out)
        .file(out.join("hexagen.c"))
        .try_compile("hexagen_c")?;
    fs::write(
        out.join("drives.rs"),
        format!(
            "const _: () = assert!(size_of::<StatusInC>() == {STATUS});\ndrives! {{\n{}}}\n",
            drives?
        ),
    )?;
    Ok(())
}

/// Emits and compiles one drive; its line of `drives.rs`.
fn compile(drive: &list::InC, out: &Path) -> Result<String, Box<dyn Error>> {
    let file = format!("../motors/{}.toml", drive.motor);
    println!("cargo:rerun-if-changed={file}");
    let options = [drive.options, word_choice()]
        .into_iter()
        .filter(|part| !part.is_empty());
    let options = options.collect::<Vec<_>>().join(", ");
    let given = options.replace(": ", "=").replace(", ", ",");
    let variant = format!("{}:{given}", drive.kind.replace('_', "-"));
    let mut ast = parse_toml(&fs::read_to_string(&file)?, &file).map_err(|why| why.to_string())?;
    apply_variant(&mut ast, variant.trim_end_matches(':')).map_err(|why| why.to_string())?;
    drive.name.clone_into(&mut ast.name.text);
    let (spec, origins) = check(&ast).map_err(|why| why.to_string())?;
    let Generated { graph, interface } =
        generate(&spec, &origins).map_err(|why| why.to_string())?;
    let program = graph.program();
    let sources = emit_c99(&graph, &interface, drive.name);
    let prefix = &sources.name;
    let size = size(program);

    let write = |ending: &str, text: &str| {
        let path = out.join(format!("{prefix}{ending}"));
        fs::write(&path, text).map(|()| path)
    };
    write(".h", &sources.header)?;
    let source = write(".c", &sources.source)?;
    // Rust reserves exactly the size that C needs, and takes a status in the way that its size asks for.
    let check = format!(
        "#include \"{prefix}.h\"\nextern char {prefix}_has_room[(sizeof({prefix}) == {size}) ? 1 : -1];\n\
         extern char {prefix}_has_status[(sizeof(hexagen_status) == {STATUS}) ? 1 : -1];\n"
    );
    let check = write("_size.c", &check)?;
    build(out)
        .files([source, check])
        // The firmware calls, and the bench counts, the public function itself.
        .define(&format!("{prefix}_step"), drive.symbol)
        .try_compile(&format!("{prefix}_c"))?;

    let names: Vec<&str> = program
        .states
        .iter()
        .map(|word| word.name.as_str())
        .collect();
    let list::InC {
        name,
        symbol,
        motor,
        kind,
        ..
    } = drive;
    let spec = &interface.spec_toml;
    let words = size / 4;
    let functions = [
        "init",
        "set_current",
        "set_torque",
        "reset",
        "calibrate",
        "precharge",
        "coast",
        "brake",
        "resume",
        "status",
        "state_words",
        "set_state_words",
    ];
    let functions = functions.map(|function| format!("{function}: {prefix}_{function}"));
    Ok(format!(
        "    {name}: [u32; {words}], {symbol}, {{ {} }}, \"../motors/{motor}.toml\", {kind:?}, {options:?}, {names:?}, {spec:?};\n",
        functions.join(", ")
    ))
}

/// The compiler, with the flags of all files.
fn build(out: &Path) -> cc::Build {
    let mut build = cc::Build::new();
    build
        .include(out)
        .opt_level(2)
        .define("HEXAGEN_VERIFICATION", None)
        // Enumerations as small as in Rust, no start-up code or library of the compiler.
        .flags(["-fshort-enums", "-ffreestanding", "-fno-jump-tables"])
        .flags(STRICT);
    build
}

/// Options for the core's word length.
fn word_choice() -> &'static str {
    let target = env::var("TARGET").unwrap_or_default();
    if target.starts_with("thumbv6m") {
        "target: cortex_m0"
    } else {
        ""
    }
}

/// Bytes of a supervisor, of a sample, of the number of a trip, and of a status.
const SUPERVISOR: usize = 60;
const SAMPLE: usize = 16;
const TRIP_NUMBER: usize = 4;
const STATUS: usize = 6;

/// Bytes of a drive: set-point words, status, supervisor and state, and the record of a trip, which
/// has a sample, a supervisor, a state and the set-point words.
fn size(program: &Program) -> usize {
    let words = program.states.iter();
    let state = words.fold(0_usize, |end, word| {
        let bytes = if word.storage_bits == 16 { 2 } else { 4 };
        end.next_multiple_of(bytes) + bytes
    });
    let kept = 4 * program.params.len() + SUPERVISOR + state.next_multiple_of(4);
    let status = 4;
    status + kept + TRIP_NUMBER + SAMPLE + kept
}
