//! The generated code of the crate's drives: a change of the motor file, of an option or of the
//! generator shows as a diff.

use hexagen_codegen::Builder;
use std::fs;

#[test]
fn generated_code_is_as_it_was_read() {
    let written = Builder::new()
        .motor("tests/motors/hub.toml")
        .out_dir(env!("CARGO_TARGET_TMPDIR"))
        .generate()
        .unwrap_or_else(|error| panic!("{error}"));
    for motor in written {
        assert_eq!(motor.types, ["Hub"]);
        assert_eq!(motor.warnings, [""; 0]);
        for file in motor.files {
            let name = file.file_name().expect("a file").to_string_lossy();
            let code = fs::read_to_string(&file).expect("what was written");
            insta::assert_snapshot!(name.as_ref(), code);
        }
    }
}
