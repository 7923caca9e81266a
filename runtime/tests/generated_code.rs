//! The generated code of the crate's drives: a change of the motor file, of an option or of the
//! generator shows as a diff.

use hexagen_codegen::Builder;

#[test]
fn generated_code_is_as_it_was_read() {
    let code = Builder::new().motor("tests/motors/hub.toml").text();
    let code = code.unwrap_or_else(|error| panic!("{error}"));
    insta::assert_snapshot!("hub", code);
}
