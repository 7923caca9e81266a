//! The motor and board files that the guide shows generate a drive.

use hexagen_codegen::{BuildError, Builder};
use std::fs;
use std::path::Path;

#[test]
fn files_of_the_guide_generate_a_drive() -> Result<(), BuildError> {
    let page = include_str!("../src/guide/boards.md");
    let files = page.split("```toml\n").skip(1);
    let files: Vec<_> = files.filter_map(|file| file.split("```").next()).collect();
    let [motor, board] = files.as_slice() else {
        panic!("a motor's file and a board's: {files:?}");
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    fs::write(folder.join("wheel.toml"), motor).expect("a folder for tests");
    fs::write(folder.join("ours.toml"), board).expect("a folder for tests");
    let wheel = || {
        Builder::new()
            .root(folder)
            .out_dir(folder)
            .motor("wheel.toml")
    };
    for written in [wheel().generate()?, wheel().board("ours.toml").generate()?] {
        assert_eq!(written[0].types, ["Wheel"]);
        assert_eq!(written[0].warnings, [""; 0]);
    }
    Ok(())
}
