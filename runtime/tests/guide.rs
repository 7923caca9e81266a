//! The guide's motor and board files, variants, C code, dependencies and links are what they say.

use hexagen_codegen::{BuildError, Builder};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs};

/// The repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// An empty folder for the files of a test.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).expect("a folder for tests");
    folder
}

/// The examples of a page in this language.
fn examples<'p>(page: &'p str, language: &str) -> Vec<&'p str> {
    let begin = format!("```{language}\n");
    let rest = page.split(begin.as_str()).skip(1);
    rest.filter_map(|text| text.split("```").next()).collect()
}

#[test]
fn files_of_the_guide_generate_a_drive() -> Result<(), BuildError> {
    let files = examples(include_str!("../src/guide/boards.md"), "toml");
    let [motor, board] = files.as_slice() else {
        panic!("a motor's file and a board's: {files:?}");
    };
    let folder = folder("files");
    fs::write(folder.join("wheel.toml"), motor).expect("a folder for tests");
    fs::write(folder.join("ours.toml"), board).expect("a folder for tests");
    let wheel = || {
        Builder::new()
            .root(&folder)
            .out_dir(&folder)
            .motor("wheel.toml")
    };
    for written in [wheel().generate()?, wheel().board("ours.toml").generate()?] {
        assert_eq!(written[0].types, ["Wheel"]);
        assert_eq!(written[0].warnings, [""; 0]);
    }
    Ok(())
}

/// The options in a file and on the command line are those of the macro.
#[test]
fn three_forms_of_options_are_one() -> Result<(), BuildError> {
    let page = include_str!("../src/guide/controllers.md");
    let [controller] = examples(page, "toml")[..] else {
        panic!("one controller");
    };
    let (_, variant) = page.split_once("--controller ").expect("a variant");
    let (variant, _) = variant.split_once(' ').expect("a variant");
    let [wheel, _] = examples(include_str!("../src/guide/boards.md"), "toml")[..] else {
        panic!("a motor's file and a board's");
    };
    let (motor, _) = wheel.split_once("[controller]").expect("a controller");
    let of = |name: &str, file: &str| {
        let folder = folder(name);
        fs::write(folder.join("wheel.toml"), file).expect("a folder for tests");
        Builder::new().root(&folder).motor("wheel.toml")
    };
    let by_default = of("default", wheel).text()?;
    let by_file = of("options", &(motor.to_owned() + controller)).text()?;
    let by_variant = of("default", wheel)
        .controller(variant)
        .name("Wheel")
        .text()?;
    assert!(by_file == by_variant);
    assert!(by_file != by_default);
    let macro_form = variant.replacen(':', " { ", 1).replace('=', ": ");
    let macro_form = format!("controller: {} }},", macro_form.replace(',', ", "));
    assert!(page.contains(&macro_form), "{macro_form}");
    Ok(())
}

/// Strict warning flags of users' projects.
const STRICT: [&str; 7] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Werror",
    "-pedantic",
    "-O2",
];

/// Output of the C compiler in this folder.
fn cc(folder: &Path, arguments: &[&str]) -> Output {
    let mut cc = Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()));
    let cc = cc.current_dir(folder).args(STRICT).args(arguments);
    cc.output().expect("a C compiler: `cc`, or what `CC` names")
}

/// The program of the chapter on C, on a board whose rotor stands.
#[test]
fn c_of_the_guide_controls_and_trips() -> Result<(), BuildError> {
    let page = include_str!("../src/guide/in_c.md");
    let ([motor], [program]) = (&examples(page, "toml")[..], &examples(page, "c")[..]) else {
        panic!("a motor's file and a program");
    };
    let folder = folder("c");
    for (file, text) in [
        ("wheel.toml", *motor),
        ("program.c", *program),
        ("board.h", include_str!("guide/board.h")),
        ("board.c", include_str!("guide/board.c")),
    ] {
        fs::write(folder.join(file), text).expect("a folder for tests");
    }
    let drive = Builder::new().root(&folder).out_dir(&folder);
    let written = drive.motor("wheel.toml").c99().generate()?;
    let warnings = &written[0].warnings;
    assert_eq!(warnings, &[""; 0]);
    let header = fs::read_to_string(folder.join("wheel.h")).expect("a header");
    let calls = page.split("`wheel_").skip(1);
    for call in calls.filter_map(|text| text.split('`').next()) {
        // The drive of the page has no speed loop.
        assert!(
            header.contains(&format!("wheel_{call}(")) || call == "set_speed_rpm",
            "{call}"
        );
    }
    let sources = ["board.c", "program.c", "wheel.c", "hexagen.c"];
    let built = cc(&folder, &[&sources[..], &["-o", "program"]].concat());
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let run = Command::new(folder.join("program")).output();
    let run = run.expect("it runs");
    assert_eq!(
        String::from_utf8_lossy(&run.stdout),
        "runs, trips, starts\n"
    );
    Ok(())
}

/// The README's lines of C belong into a program.
#[test]
fn c_of_the_readme_compiles() -> Result<(), BuildError> {
    let [program] = examples(include_str!("../../README.md"), "c")[..] else {
        panic!("one program");
    };
    let [motor] = examples(include_str!("../src/guide/in_c.md"), "toml")[..] else {
        panic!("a motor's file");
    };
    let folder = folder("readme");
    let head = "#include \"board.h\"\n#include \"hub.h\"\nvoid apply(const hexagen_legs *legs);\n\
                void start(void);\nvoid pwm_interrupt(void);\n";
    for (file, text) in [
        ("hub.toml", motor),
        ("program.c", &format!("{head}{program}")),
        ("board.h", include_str!("guide/board.h")),
    ] {
        fs::write(folder.join(file), text).expect("a folder for tests");
    }
    let drive = Builder::new().root(&folder).out_dir(&folder);
    drive.motor("hub.toml").c99().generate()?;
    let built = cc(&folder, &["-c", "program.c"]);
    let messages = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{messages}");
    Ok(())
}

/// Pages with links to each other, by the names that the links use.
const PAGES: [(&str, &str); 16] = [
    ("boards", include_str!("../src/guide/boards.md")),
    ("bring_up", include_str!("../src/guide/bring_up.md")),
    ("controllers", include_str!("../src/guide/controllers.md")),
    ("data_sheets", include_str!("../src/guide/data_sheets.md")),
    ("first_drive", include_str!("../src/guide/first_drive.md")),
    (
        "fixed_and_float",
        include_str!("../src/guide/fixed_and_float.md"),
    ),
    ("glossary", include_str!("../src/guide/glossary.md")),
    ("in_c", include_str!("../src/guide/in_c.md")),
    ("interrupt", include_str!("../src/guide/interrupt.md")),
    ("proofs", include_str!("../src/guide/proofs.md")),
    ("snapshots", include_str!("../src/guide/snapshots.md")),
    ("theory", include_str!("../src/guide/theory.md")),
    (
        "troubleshooting",
        include_str!("../src/guide/troubleshooting.md"),
    ),
    ("tuning", include_str!("../src/guide/tuning.md")),
    ("two_motors", include_str!("../src/guide/two_motors.md")),
    (
        "crate::specification",
        concat!(
            include_str!("../src/specification/fields.md"),
            include_str!("../src/specification/options.md"),
            include_str!("../src/specification/units.md")
        ),
    ),
];

/// The anchor that rustdoc gives a heading.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter_map(|sign| match sign {
        ' ' => Some('-'),
        '-' | '_' => Some(sign),
        _ => sign.is_alphanumeric().then_some(sign.to_ascii_lowercase()),
    });
    kept.collect()
}

/// rustdoc checks that the page of a link exists, but not its heading.
#[test]
fn links_lead_to_headings() {
    let mut links = 0;
    for (name, text) in PAGES {
        for target in text.split("](").skip(1) {
            let target = target.split(')').next().unwrap_or_default();
            let Some((page, fragment)) = target.split_once('#') else {
                continue;
            };
            let page = if page.is_empty() { name } else { page };
            let Some((_, there)) = PAGES.iter().find(|(name, _)| *name == page) else {
                continue;
            };
            let headings = there.lines().filter(|line| line.starts_with('#'));
            let mut anchors = headings.map(|line| anchor(line.trim_start_matches('#')));
            assert!(anchors.any(|anchor| anchor == fragment), "{name}: {target}");
            links += 1;
        }
    }
    assert!(links > 5, "{links}");
}

/// The dependencies that the pages tell name crates by their folders in the repository.
#[test]
fn dependencies_are_where_they_are_said_to_be() {
    for page in [
        include_str!("../src/guide/first_drive.md"),
        include_str!("../src/guide/snapshots.md"),
        include_str!("../../README.md"),
    ] {
        let lines = examples(page, "toml").concat();
        let lines = lines
            .lines()
            .filter_map(|line| line.split_once(" = { path = \"../hexagen/"));
        let crates: Vec<_> = lines.collect();
        assert!(!crates.is_empty());
        for (name, rest) in crates {
            let folder = rest.split('"').next().unwrap_or_default();
            let manifest = root().join(folder).join("Cargo.toml");
            let manifest = fs::read_to_string(&manifest).expect("a crate");
            assert!(
                manifest.contains(&format!("\nname = \"{name}\"\n")),
                "{name}"
            );
        }
    }
}

hexagen::controller! {
    /// Whose file states everything.
    pub Hub { motor: "tests/motors/hub.toml" }
}

#[test]
fn a_motor_file_may_state_everything() {
    assert_eq!(<Hub as hexagen::Control>::NAME, "Hub");
}
