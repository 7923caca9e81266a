//! What rust-analyzer shows of a macro call: documentation as Markdown, definitions, and errors
//! while one types. `cargo xtask editors` installs the server and runs this test.

mod session;

use lsp_types::{Code, Diagnostic, Location, Message};
use session::Session;
use std::fs;
use std::path::{Path, PathBuf};

/// A user's crate.
const SOURCE: &str = "#![no_std]

hexagen::controller! {
    /// Rear hub drive.
    pub HubDrive {
        motor: {
            pole_pairs: 4,
            resistance: 135 mohm per_phase,
            inductance: 0.22 mH per_phase,
            winding: star,
            back_emf: 0.1648 V/(rad/s) line_to_line peak,
            emf_shape: trapezoidal,
            rated_current: 20 A,
            rated_torque: 3.3 Nm,
            rated_speed: 2000 rpm,
        },
        inverter: {
            bus_voltage: 48 V, f_pwm: 20 kHz, timer_clock: 72 MHz, adc_bits: 12, adc_range: 40 A,
            current_sensing: in_phase, hall_timer_clock: 1 MHz,
        },
        controller: fcs-mpc { emf: model, off_leg: nominal },
    }
}

use hexagen::{Control, Drive, Sample, arith::Word};

pub fn control(drive: &mut Drive<HubDrive>) -> u32 {
    let (set_point, mut control) = drive.split();
    set_point.set_current_ma(12_500);
    control.step(&Sample::with_hall([2048, 2048], 0b101));
    let _word = HubDrive::current(Word(0));
    HubDrive::ADC_BITS
}
";

/// The end of the macro call in the source.
const BEHIND_THE_CALL: &str = "use hexagen::{";

#[test]
#[ignore = "needs rust-analyzer: `cargo xtask editors` installs it"]
fn an_editor_shows_documentation_definitions_and_errors() {
    let mut session = Session::begin(&crate_of_a_user());
    documentation_is_markdown(&mut session);
    definitions_are_places(&mut session);
    errors_come_and_go_while_one_types(&mut session);
    let complaints = session.end();
    assert!(!complaints.contains("panicked"), "{complaints}");
}

fn documentation_is_markdown(session: &mut Session) {
    let call = "pub HubDrive {";
    for (before, text, begin) in [
        (
            BEHIND_THE_CALL,
            "HubDrive",
            "Rear hub drive.\n\nFinite-control-set",
        ),
        (
            "    HubDrive::",
            "ADC_BITS",
            "Bits of the phase-current ADCs.",
        ),
        (
            "_word = HubDrive::",
            "current",
            "Set-point word of the current in amperes",
        ),
        ("set_point.", "set_current_ma", "[`set_current`]"),
        (
            call,
            "resistance",
            "`resistance` of the motor: ohm with `per_phase`",
        ),
        (call, "back_emf", "`back_emf` of the motor: V/(rad/s)"),
        (
            call,
            "f_pwm",
            "`f_pwm` or `sampling_time` of the inverter: Hz",
        ),
        (call, "fcs", "Finite-control-set model predictive control."),
        (
            "fcs-mpc { ",
            "emf",
            "`emf` of `controller`: Source of the EMF",
        ),
        (call, "off_leg", "`off_leg` of `fcs-mpc`: "),
    ] {
        let shown = session.hover(before, text);
        // Above the last rule stand path and signature.
        let about = shown
            .rsplit("\n---\n")
            .next()
            .unwrap_or_default()
            .trim_start();
        assert!(about.starts_with(begin), "`{text}` shows: {shown}");
        let is_comment = |line: &str| line == "/" || line.starts_with("/ ");
        assert!(!shown.lines().any(is_comment), "`{text}` shows: {shown}");
    }
}

fn definitions_are_places(session: &mut Session) {
    let in_call = |session: &Session, places: &[Location]| {
        let lines = call(session);
        let is_in = |place: &Location| {
            place.uri.as_ref() == session.file() && lines.contains(&place.range.start.line)
        };
        places.iter().any(is_in)
    };
    for (before, text) in [
        (BEHIND_THE_CALL, "HubDrive"),
        ("    HubDrive::", "ADC_BITS"),
        ("_word = HubDrive::", "current"),
    ] {
        let places = session.definitions(before, text);
        assert!(in_call(session, &places), "`{text}`: {places:?}");
    }
    for (before, text, file) in [
        ("set_point.", "set_current_ma", "/runtime/src/set_point.rs"),
        ("control.", "step", "/runtime/src/drive.rs"),
        ("pub HubDrive {", "resistance", "/runtime/src/lib.rs"),
    ] {
        let places = session.definitions(before, text);
        let is_there = |place: &Location| place.uri.as_ref().ends_with(file);
        assert!(places.iter().any(is_there), "`{text}`: {places:?}");
    }
}

fn errors_come_and_go_while_one_types(session: &mut Session) {
    assert_eq!(session.diagnostics(), []);
    for (right, wrong, marked, code) in [
        ("135 mohm", "135 mH", "135 mH", "[HX0203]"),
        ("bus_voltage: 48 V", "bus_voltage: 4 V", "4 V", "[HX0302]"),
        ("inductance:", "inductanse:", "inductanse", "[HX0103]"),
        ("emf: model", "emf: modell", "modell", "[HX0207]"),
    ] {
        session.replace(right, wrong);
        let at = session.position("pub HubDrive {", marked);
        let found = session.diagnostics();
        let is_meant = |found: &Diagnostic| {
            found.code == Some(Code::String("macro-error".to_owned()))
                && matches!(&found.message, Message::String(text) if text.starts_with(code))
                && found.range.start == at
                && call(session).contains(&found.range.end.line)
        };
        assert!(found.iter().any(is_meant), "`{wrong}`: {found:?}");
        // Documentation stays while the call has an error.
        let shown = session.hover("pub HubDrive {", "rated_torque");
        assert!(shown.contains("`rated_torque` of the motor"), "{shown}");
        session.replace(wrong, right);
        assert_eq!(session.diagnostics(), [], "`{right}` again");
    }
}

/// The lines of the macro call, from 0.
fn call(session: &Session) -> std::ops::Range<u32> {
    let begin = session.position("#![no_std]", "hexagen::controller!");
    begin.line..session.position("", BEHIND_THE_CALL).line
}

/// Writes a crate as a user has it, with the dependencies of this repository's versions.
fn crate_of_a_user() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("editors");
    let runtime = repository().join("runtime");
    let manifest = format!(
        "[package]\nname = \"firmware\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\nhexagen = {{ path = '{}' }}\n\n[workspace]\n",
        runtime.display()
    );
    let written = fs::create_dir_all(folder.join("src"))
        .and_then(|()| fs::write(folder.join("Cargo.toml"), manifest))
        .and_then(|()| fs::write(folder.join("src/lib.rs"), SOURCE))
        .and_then(|()| fs::copy(repository().join("Cargo.lock"), folder.join("Cargo.lock")));
    written.expect("the folder for tests can be written");
    folder
}

fn repository() -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    folder.canonicalize().expect("the repository is there")
}
