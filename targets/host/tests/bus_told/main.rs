//! What emitted C makes of a bus voltage that is told, told no longer, or told by a call that never ends: calls are
//! interrupted, and ended for good, before each access to what contexts share.

use hexagen::DoubleBuffer;
use hexagen_codegen::emit::c99::emit_c99;
use hexagen_codegen::spec::parse_toml;
use hexagen_host::engine::prepare_ast;
use hexagen_tests::library::{PAPER_MOTOR, motor};
use std::env;
use std::fs;
use std::process::Command;

/// The bus as an ADC reads it.
const BUS: &str = "[inverter]\nv_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\n";

/// What stands before each access.
const HOOK: &str = "    hook();\n";

/// The source with a hook before each line that reads or writes what `set_bus` and the control loop share, and their
/// number.
fn hooked(source: &str) -> (String, usize) {
    let (mut text, mut hooks) = ("void hook(void);\n".to_owned(), 0);
    let mut is_inside = false;
    for line in source.lines() {
        is_inside |= ["store_bus(", " set_bus(", " pass_period("]
            .iter()
            .any(|name| line.starts_with("static") && line.contains(name));
        is_inside &= line != "}";
        let is_access = line.starts_with(' ')
            && (line.contains("buffer->") || line.contains("set_point->"))
            && !line.trim_start().starts_with('}');
        if is_inside && is_access {
            text.push_str(HOOK);
            hooks += 1;
        }
        text.push_str(line);
        text.push('\n');
    }
    (text, hooks)
}

/// Builds the drive of a controller with its interleavings, and runs them.
fn check(controller: &str, words: usize) {
    let text = motor(PAPER_MOTOR).text.replacen("[inverter]\n", BUS, 1);
    let ast = parse_toml(&text, "drive.toml").expect("TOML");
    let drive = prepare_ast(ast, "drive", Some(controller)).expect("it generates");
    let generated = &drive.generated;
    assert_eq!(
        drive.spec.inverter.bus_periods(),
        Some(2000),
        "100 ms of 50 us"
    );
    let sources = emit_c99(&generated.graph, &generated.interface, "HubDrive");
    let (source, hooks) = hooked(&sources.source);
    assert!(hooks > 4 * words, "{controller}: {hooks} hooks");
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in [
        ("hub_drive.h", sources.header.as_str()),
        ("hub_drive.c", &source),
        ("interleavings.c", include_str!("interleavings.c")),
    ] {
        fs::write(folder.path().join(name), text).expect("it is written");
    }
    let cc = env::var_os("CC").unwrap_or_else(|| "cc".into());
    let output = Command::new(cc)
        .current_dir(folder.path())
        .args([
            "-std=c99", "-Wall", "-Wextra", "-Werror", "-O1", "-o", "run",
        ])
        .arg(format!("-DWORDS={words}"))
        .arg(format!("-DGIVEN_UP={}", DoubleBuffer::<2>::GIVEN_UP))
        .args(["hub_drive.c", "interleavings.c"])
        .output()
        .expect("a C compiler runs");
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{controller}: {messages}");
    let output = Command::new(folder.path().join("run"))
        .output()
        .expect("it runs");
    let messages = String::from_utf8_lossy(&output.stdout);
    print!("{controller}: {messages}");
    assert!(output.status.success(), "{controller}: {messages}");
}

#[test]
fn the_status_shows_a_bus_voltage_that_is_no_longer_told() {
    check("pdcc", 2);
    check("phcc", 1);
}
