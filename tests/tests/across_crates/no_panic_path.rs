//! Optimised drives have no panic path, whatever else the compiler checks: the machine code of
//! step, setters and signals calls nothing of `core::panicking`.

use hexagen_codegen::emit::rust::{Surface, emit_rust, format_rust};
use hexagen_codegen::pipeline::generate;
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_lab::standalone::{MACROS, derived, fixed};
use hexagen_tests::library::{PAPER_MOTOR, motor, with_inertia};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Drives that together call every function of the runtime.
const CONTROLLERS: [&str; 7] = [
    "pdcc:reference=quasi_square,saturation=torque_priority",
    "pdcc:reference=quasi_square,word=16,saturation=keep_angle",
    "pdcc:modulation=pair,emf=model,saturation=nearest",
    "fcs-mpc:candidates=all",
    "phcc",
    "pi-pwm",
    REGULATED,
];

/// One with a setter more.
const REGULATED: &str = "pdcc:reference=quasi_square,speed_loop=on";

/// A measured bus: all setters, and the double buffer.
const BUS: &str = "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"100 V\"\n";

/// The emitted modules of all drives, and functions with the calls of firmware.
fn firmware() -> String {
    let toml = with_inertia(&motor(PAPER_MOTOR).text);
    let mut text = "#![no_std]\nuse hexagen::{ControlLoop, Legs, Sample, SetPoint, Signals, Status, fixed::types::I16F16};\n".to_owned();
    for (number, controller) in CONTROLLERS.iter().enumerate() {
        let name = format!("Drive{number}");
        let mut toml = toml.replace("[inverter]\n", &format!("[inverter]\n{BUS}"));
        if number % 2 == 0 {
            // No count is out of range.
            toml = toml.replace("adc_bits = 12", "adc_bits = 16");
        }
        let mut ast = parse_toml(&toml, "motor.toml").expect("TOML");
        apply_variant(&mut ast, controller).expect("a variant");
        let (spec, origins) = check(&ast).expect("a specification");
        let generated = generate(&spec, &origins).expect("a controller");
        let surface = Surface::public(&name);
        let tokens = emit_rust(&generated.graph, &generated.interface, &surface);
        let set_speed = if *controller == REGULATED {
            "main.set_speed(set);"
        } else {
            ""
        };
        write!(
            text,
            "{}
            #[unsafe(no_mangle)] pub fn step_{number}(drive: &mut ControlLoop<'_, {name}>, a: u16, b: u16, hall: u8) -> Legs {{
                drive.step(&Sample::with_hall([a, b], hall))
            }}
            #[unsafe(no_mangle)] pub fn restart_{number}(drive: &mut ControlLoop<'_, {name}>) {{ drive.reset(); drive.calibrate(); drive.precharge(); }}
            #[unsafe(no_mangle)] pub fn set_{number}(main: &SetPoint<{name}>, set: I16F16, bus: u16) -> Status {{
                main.set_current(set); main.set_torque(set); main.set_current_ma(bus.into()); main.set_bus(bus); {set_speed} main.status()
            }}
            #[unsafe(no_mangle)] pub fn signals_{number}(main: &SetPoint<{name}>) -> Option<Signals> {{ main.signals() }}\n",
            format_rust(&derived(tokens))
        )
        .expect("a string takes all");
    }
    text
}

/// Compiles one crate with all of the compiler's checks.
fn rustc(folder: &Path, level: &str, name: &str, file: &str, needs: &[&str], emit: &str) {
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    rustc.current_dir(folder).args([
        "--edition",
        "2024",
        "--crate-type",
        "rlib",
        "--cap-lints",
        "allow",
    ]);
    let level = format!("opt-level={level}");
    let flags = [level.as_str(), "overflow-checks=on", "debug-assertions=on"];
    let flags = flags.iter().flat_map(|flag| ["-C", flag]);
    rustc
        .args(flags)
        .args(["--crate-name", name, file, "-L", "."]);
    rustc.args(["--emit", emit, "-C", "codegen-units=1"]);
    // Of the runtime; what is off is in no firmware.
    rustc.args(["--cfg", "feature=\"signals\""]);
    for need in needs {
        rustc.args(["--extern", &format!("{need}=lib{need}.rlib")]);
    }
    let output = rustc.output().expect("rustc runs");
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{file}: {messages}");
}

/// Calls into `core::panicking` in the machine code at an optimisation level, with their functions.
fn panic_paths(level: &str) -> Vec<String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("no_panic_path_{level}"));
    fs::create_dir_all(&folder).expect("a folder");
    let runtime = Path::new(env!("CARGO_MANIFEST_DIR")).join("../runtime/src");
    let mut forms = 0;
    for entry in fs::read_dir(runtime).expect("the runtime's sources") {
        let path = entry.expect("a source").path();
        if path.extension().is_some_and(|ending| ending == "rs") {
            let text = fs::read_to_string(&path).expect("a source");
            // Code of firmware cores, not of this machine.
            let text = text
                .replace("cfg!(not(target_pointer_width = \"64\"))", "true")
                .replace("cfg!(target_arch = \"riscv32\")", "true");
            forms += text.matches("if true {").count();
            let name = path.file_name().expect("a name");
            fs::write(folder.join(name), text).expect("a source");
        }
    }
    assert_eq!(forms, 2, "forms for some cores");
    fs::write(folder.join("fixed.rs"), fixed()).expect("a source");
    fs::write(folder.join("hexagen_macros.rs"), MACROS).expect("a source");
    fs::write(folder.join("firmware.rs"), firmware()).expect("a source");
    rustc(&folder, level, "fixed", "fixed.rs", &[], "link");
    let macros = "hexagen_macros";
    rustc(&folder, level, macros, "hexagen_macros.rs", &[], "link");
    rustc(
        &folder,
        level,
        "hexagen",
        "lib.rs",
        &["fixed", macros],
        "link",
    );
    rustc(
        &folder,
        level,
        "firmware",
        "firmware.rs",
        &["hexagen"],
        "asm",
    );
    let code = fs::read_to_string(folder.join("firmware.s")).expect("machine code");
    // Signals of drives with the same units are one function.
    for function in ["step_6:", "set_6:", "signals_6"] {
        assert!(code.contains(function), "{function}");
    }
    let mut function = "";
    let mut paths = vec![];
    for line in code.lines() {
        match line.strip_suffix(':') {
            Some(label) if !label.starts_with('.') => function = label,
            _ if line.contains("panic") => paths.push(format!("{function}: {}", line.trim())),
            _ => {}
        }
    }
    paths
}

#[test]
fn optimised_code_has_no_panic_path() {
    for level in ["1", "2", "3", "s", "z"] {
        assert_eq!(
            panic_paths(level),
            Vec::<String>::new(),
            "opt-level {level}"
        );
    }
}

/// The documented exception; also proves that a panic path is detected.
#[test]
fn unoptimised_code_has_only_panic_paths_of_core() {
    let paths = panic_paths("0");
    assert!(!paths.is_empty());
    for path in paths {
        let function = path.split(':').next().unwrap_or_default();
        // A drive that is no constant is made by a function that the step does not call.
        assert!(
            function.contains("4core") || function.contains("3new"),
            "{path}"
        );
    }
}
