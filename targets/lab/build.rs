//! Embeds the motor library and compiles its controllers in.
//!
//! Writes `library.rs`: the texts of all motor files, the modules of the generated drives and a
//! table of them. Every motor has the controller of its file; the paper's motor also has the
//! variants of the result table and of the paper's experiment.

#[path = "src/readings.rs"]
mod readings;

use hexagen_codegen::spec::KINDS;
use std::collections::BTreeSet;
use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

/// A link to `targets/motors`, which a package holds as a folder.
const FOLDER: &str = "motors";
const PAPER_MOTOR: &str = "trivedi-keshri-660w";

/// The variants of the result table, each with both ways of reading Hall edges. The program looks
/// drives up by their normalised specification, so a variant that is missing here is interpreted.
const VARIANTS: [&str; 12] = [
    "pdcc:reference=quasi_square,modulation=three_phase,saturation=nearest,emf=model",
    "pdcc:modulation=pair,saturation=keep_angle,emf=model",
    "pdcc:modulation=three_phase,saturation=torque_priority,advance=2,emf=model",
    "pdcc:modulation=three_phase,saturation=torque_priority,advance=2,emf=estimated",
    "pdcc:modulation=pair,saturation=torque_priority,advance=1.5,emf=model",
    "pdcc:modulation=three_phase,saturation=nearest,reference=proportional,emf=model",
    "fcs-mpc:candidates=table2,off_leg=nominal,emf=estimated,emf_filter=1",
    "fcs-mpc:candidates=table2,off_leg=physical,emf=model",
    "phcc:table=derived,off_leg=physical,emf=model",
    "pi-pwm:reference=quasi_square,feed_forward=off,bandwidth=800Hz,integral_time=0.5ms,saturation=nearest",
    "pi-pwm:reference=quasi_square,feed_forward=on,bandwidth=1kHz,emf=model,saturation=nearest",
    "pi-pwm:six_step=on,bandwidth=600Hz",
];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    let out = env::var("OUT_DIR")?;
    let mut motors = String::new();
    let mut modules = String::new();
    let mut drives = String::new();
    for name in names()? {
        let file = format!("{FOLDER}/{name}.toml");
        let toml = fs::read_to_string(&file)?;
        writeln!(
            motors,
            "    super::Library {{ name: {name:?}, file: \"{name}.toml\", text: {toml:?} }},"
        )?;
        for written in generate(&name, &file)? {
            let module = name.replace('-', "_");
            let path = format!("/{name}.rs");
            writeln!(modules, "    /// Drives of the motor `{name}`.")?;
            writeln!(
                modules,
                "    pub mod motor_{module} {{ include!(concat!(env!(\"OUT_DIR\"), {path:?})); }}"
            )?;
            for drive in written.types {
                writeln!(
                    drives,
                    "    super::BuiltIn::of::<drives::motor_{module}::{drive}>({name:?}),"
                )?;
            }
        }
    }
    let text = format!(
        "pub static MOTORS: &[super::Library] = &[\n{motors}];\n\
         pub static DRIVES: &[super::BuiltIn] = &[\n{drives}];\n\
         /// The drives that are compiled into this program, by motor.\n\
         pub mod drives {{\n{modules}}}\n"
    );
    fs::write(Path::new(&out).join("library.rs"), text)?;
    Ok(())
}

/// Names of all motor files, without ending, sorted.
fn names() -> Result<Vec<String>, Box<dyn Error>> {
    println!("cargo:rerun-if-changed={FOLDER}");
    let mut names = vec![];
    for entry in fs::read_dir(FOLDER)? {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "toml") {
            names.extend(
                path.file_stem()
                    .and_then(|stem| stem.to_str())
                    .map(str::to_owned),
            );
        }
    }
    names.sort_unstable();
    Ok(names)
}

/// Generates the drives of one motor. A motor that no controller can be made for is left out: the
/// program says why when it is asked.
fn generate(name: &str, file: &str) -> Result<Vec<hexagen_codegen::Written>, Box<dyn Error>> {
    // Every controller is generated for every motor; the program gives the warnings of those that
    // are asked for.
    let mut builder = ["HX0601", "HX0602", "HX0604", "HX0610", "HX0611"]
        .into_iter()
        .fold(hexagen_codegen::Builder::new(), |builder, code| {
            builder.allow(code)
        })
        .motor(file);
    // The motor's own controller first, then every kind that it can have with all options at their
    // defaults.
    builder = builder.controller("pdcc");
    for kind in KINDS.map(|kind| kind.name) {
        if kind != "pdcc" && has_controller(file, kind)? {
            builder = builder.controller(kind);
        }
    }
    if name == PAPER_MOTOR {
        let of_table = VARIANTS.iter().flat_map(|options| {
            ["timer", "sampled"]
                .map(|capture| format!("{options},discretisation=euler,hall_capture={capture}"))
        });
        let of_readings = readings::READINGS
            .iter()
            .flat_map(|readings| [readings.literal, readings.corrected].map(str::to_owned));
        let of_improvements = readings::IMPROVEMENTS
            .iter()
            .map(|improvement| improvement.variant.to_owned());
        // Some are rows of the table, or have a kind's defaults.
        let mut known = BTreeSet::new();
        for variant in of_table.chain(of_readings).chain(of_improvements) {
            if known.insert(normalised(file, &variant)?) {
                builder = builder.controller(variant);
            }
        }
    }
    match builder.generate() {
        Ok(written) => Ok(written),
        Err(hexagen_codegen::BuildError::Specification(errors)) => {
            for error in errors {
                for line in error.to_string().lines() {
                    println!("cargo:warning={line}");
                }
            }
            Ok(vec![])
        }
        Err(error) => Err(error.into()),
    }
}

/// Whether a controller of this kind can be made for the motor; the program says why when it
/// cannot.
fn has_controller(file: &str, kind: &str) -> Result<bool, Box<dyn Error>> {
    use hexagen_codegen::pipeline::generate;
    use hexagen_codegen::spec::{apply_variant, check, parse_toml};
    let Ok(mut ast) = parse_toml(&fs::read_to_string(file)?, file) else {
        return Ok(false);
    };
    Ok(apply_variant(&mut ast, kind).is_ok()
        && check(&ast).is_ok_and(|(spec, origins)| generate(&spec, &origins).is_ok()))
}

/// The normalised specification of a variant; its text where it has errors, which the builder
/// reports.
fn normalised(file: &str, variant: &str) -> Result<String, Box<dyn Error>> {
    use hexagen_codegen::spec::{apply_variant, check, parse_toml};
    let checked = parse_toml(&fs::read_to_string(file)?, file).and_then(|mut ast| {
        apply_variant(&mut ast, variant)?;
        check(&ast)
    });
    Ok(checked.map_or_else(|_| variant.to_owned(), |(spec, _)| spec.to_toml()))
}
