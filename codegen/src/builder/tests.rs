//! Errors and warnings of the builder.

use super::{BuildError, Builder, variant_name};
use std::fs;

/// Error of a builder with the example motor under two paths.
fn refusal(test: &str, build: impl FnOnce(Builder) -> Builder) -> String {
    let folder = std::env::temp_dir().join(format!("hexagen-{test}-{}", std::process::id()));
    for name in ["front", "rear"] {
        fs::create_dir_all(folder.join(name)).expect("a temporary folder");
        fs::write(
            folder.join(name).join("hub.toml"),
            include_str!("../example.toml"),
        )
        .expect("a motor file");
    }
    let builder = Builder::new().root(&folder).out_dir(&folder);
    let outcome = build(builder).generate();
    let written = fs::read_dir(&folder).expect("the folder").count() > 2;
    fs::remove_dir_all(&folder).expect("the folder is ours");
    let error: BuildError = outcome.expect_err("the builder must refuse");
    assert!(!written, "something was written before the refusal");
    error.to_string()
}

#[test]
fn two_motors_of_one_file_name_are_refused() {
    assert_eq!(
        refusal("names", |b| b
            .motor("front/hub.toml")
            .motor("rear/hub.toml")),
        "front/hub.toml and rear/hub.toml would both be written to hub.rs; rename one of them, \
         or give each a builder with an `.out_dir(…)` of its own"
    );
    assert_eq!(
        refusal("folders", |b| b.motors("front").motors("rear")),
        "front/hub.toml and rear/hub.toml would both be written to hub.rs; rename one of them, \
         or give each a builder with an `.out_dir(…)` of its own"
    );
    assert_eq!(
        refusal("twice", |b| b
            .motor("front/hub.toml")
            .controller("pdcc")
            .motor("front/hub.toml")
            .controller("pi-pwm")),
        "front/hub.toml and front/hub.toml would both be written to hub.rs; give a motor once, \
         with all its controllers behind it"
    );
}

#[test]
fn controllers_and_names_without_a_motor_are_refused() {
    assert_eq!(
        refusal("early", |b| b.controller("pdcc").motor("front/hub.toml")),
        "`.controller(\"pdcc\")` stands before the first motor; say it after the `.motor(…)` \
         that it belongs to"
    );
    assert_eq!(
        refusal("name", |b| b.name("Hub").motor("front/hub.toml")),
        "`.name(\"Hub\")` stands before the first motor; say it after the `.motor(…)` that it \
         belongs to"
    );
    assert_eq!(
        refusal("folder", |b| b
            .motor("rear/hub.toml")
            .motors("front")
            .controller("pdcc")),
        "`.controller(\"pdcc\")` follows `.motors(\"front\")`, whose files take their own \
         controllers; say it after the `.motor(…)` that it belongs to"
    );
}

#[test]
fn types_of_one_file_have_names_and_modules_of_their_own() {
    let named = |test, second| {
        refusal(test, |b| {
            b.motor("front/hub.toml")
                .controller("pdcc")
                .name("HubDrive")
                .controller("pi-pwm")
                .name(second)
        })
    };
    assert_eq!(
        named("types", "HubDrive"),
        "front/hub.toml: two controllers are named HubDrive; tell them apart with `.name(…)`"
    );
    assert_eq!(
        named("modules", "HUBDrive"),
        "front/hub.toml: HubDrive and HUBDrive would both stand in a module `hub_drive`; tell \
         them apart with `.name(…)`"
    );
    assert_eq!(
        refusal("variants", |b| b
            .motor("front/hub.toml")
            .controller("pdcc")
            .controller("pdcc")),
        "front/hub.toml: two controllers are named TrivediKeshri660wPdcc; tell them apart with `.name(…)`"
    );
}

#[test]
fn variants_name_types() {
    assert_eq!(
        variant_name("pdcc:emf=model,advance=1.5"),
        "PdccEmfModelAdvance1p5"
    );
    assert_eq!(variant_name("fcs-mpc"), "FcsMpc");
}

#[test]
fn a_warning_is_told_unless_it_is_allowed() {
    let folder = std::env::temp_dir().join(format!("hexagen-warning-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a temporary folder");
    fs::write(folder.join("hub.toml"), include_str!("../example.toml")).expect("a motor file");
    let builder = Builder::new().root(&folder).out_dir(&folder);
    let builder = builder.motor("hub.toml").controller("phcc:table=printed");
    let told = builder.clone().generate();
    let allowed = builder.allow("HX0601").generate();
    fs::remove_dir_all(&folder).expect("the folder is ours");
    let told = told.expect("a warning is no error").remove(0).warnings;
    assert_eq!(told.len(), 1);
    assert!(told[0].contains("warning[HX0601]: `table`: "), "{told:?}");
    assert!(allowed.expect("generates").remove(0).warnings.is_empty());
}

#[test]
fn an_estimate_that_turns_too_far_is_told_unless_it_is_allowed() {
    let folder = std::env::temp_dir().join(format!("hexagen-turn-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a temporary folder");
    let slow = include_str!("../example.toml").replace("\"20 kHz\"", "\"4 kHz\"");
    fs::write(folder.join("hub.toml"), slow).expect("a motor file");
    let builder = Builder::new().root(&folder).out_dir(&folder);
    let builder = builder.motor("hub.toml").controller("pdcc:emf=estimated");
    let told = builder.clone().generate();
    let allowed = builder.allow("HX0602").generate();
    fs::remove_dir_all(&folder).expect("the folder is ours");
    let told = told.expect("a warning is no error").remove(0).warnings;
    assert!(
        matches!(&told[..], [one] if one.contains("warning[HX0602]: `emf`: ")),
        "{told:?}"
    );
    assert!(allowed.expect("generates").remove(0).warnings.is_empty());
}

#[test]
fn c99_is_written_by_type() {
    let folder = std::env::temp_dir().join(format!("hexagen-c99-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a temporary folder");
    for name in ["hub.toml", "rear.toml"] {
        fs::write(folder.join(name), include_str!("../example.toml")).expect("a motor file");
    }
    let builder = Builder::new().root(&folder).out_dir(&folder).c99();
    let builder = builder.motor("hub.toml").name("HubDrive");
    let written = builder.clone().generate();
    let same = builder.motor("rear.toml").name("HubDrive").generate();
    let source = fs::read_to_string(folder.join("hub_drive.c"));
    let runtime = ["hexagen.h", "hexagen.c"].map(|file| fs::read_to_string(folder.join(file)));
    fs::remove_dir_all(&folder).expect("the folder is ours");
    let written = written.expect("it generates").remove(0);
    let files = ["hub_drive.h", "hub_drive.c"].map(|file| folder.join(file));
    assert_eq!(written.files, files);
    assert!(
        source
            .expect("is written")
            .contains("\nhexagen_legs hub_drive_step(")
    );
    let runtime = runtime.map(|text| text.expect("is written beside them"));
    assert_eq!(runtime, [hexagen_c99::HEADER, hexagen_c99::SOURCE]);
    assert_eq!(
        same.expect_err("one name for two drives").to_string(),
        "hub.toml and rear.toml would both be written to hub_drive.h; tell their types apart with `.name(…)`"
    );
}

#[test]
fn a_motor_file_that_is_no_text_is_refused_with_its_byte() {
    let folder = std::env::temp_dir().join(format!("hexagen-latin-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a temporary folder");
    fs::write(folder.join("hub.toml"), b"[motor]\n# caf\xe9\n").expect("a motor file");
    let builder = Builder::new().root(&folder).out_dir(&folder);
    let outcome = builder.motor("hub.toml").generate();
    fs::remove_dir_all(&folder).expect("the folder is ours");
    let told = outcome.expect_err("is Latin-1").to_string();
    assert!(
        told.contains("hub.toml:2:6: error[HX0108]: the file is not UTF-8: byte 13"),
        "{told}"
    );
}

#[test]
fn a_board_of_the_builder_replaces_what_the_motor_file_says() {
    let folder = std::env::temp_dir().join(format!("hexagen-board-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a temporary folder");
    fs::write(folder.join("hub.toml"), include_str!("../example.toml")).expect("a motor file");
    let board = "[inverter]\ntimer_clock = \"170 MHz\"\n";
    fs::write(folder.join("mine.toml"), board).expect("a board's file");
    let written = Builder::new()
        .root(&folder)
        .out_dir(&folder)
        .motor("hub.toml")
        .board("mine.toml")
        .generate()
        .expect("the example generates");
    let text = fs::read_to_string(&written[0].files[0]).expect("the file is there");
    fs::remove_dir_all(&folder).expect("the folder is ours");
    assert!(text.contains("TIMER_PERIOD: u16 = 4250;"), "72 MHz still");
    assert!(
        refusal("no-board", |b| b.motor("front/hub.toml").board("vesc4"))
            .contains("argument `vesc4`: error[HX0112]")
    );
    assert!(
        refusal("early-board", |b| b.board("vesc-4").motor("front/hub.toml"))
            .contains("stands before the first motor")
    );
}

#[test]
fn the_text_is_that_of_the_files_and_nothing_is_written() {
    let folder = std::env::temp_dir().join(format!("hexagen-text-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a temporary folder");
    fs::write(folder.join("hub.toml"), include_str!("../example.toml")).expect("a motor file");
    let builder = || Builder::new().root(&folder).motor("hub.toml");
    let text = builder().text();
    let of_c = builder().c99().text();
    let found = fs::read_dir(&folder).expect("the folder").count();
    let written = builder().out_dir(&folder).generate();
    let file = written.map(|written| fs::read_to_string(&written[0].files[0]));
    let whole = file.expect("is generated").expect("is written");
    fs::remove_dir_all(&folder).expect("the folder is ours");
    assert_eq!(found, 1);
    assert_eq!(text.expect("is generated"), whole);
    let of_c = of_c.expect("is generated");
    let heads = of_c.lines().filter(|line| line.starts_with("// "));
    assert_eq!(heads.count(), 2, "{of_c}");
}
