//! The wording and the places of every error of `hexagen::controller!`, as the compiler shows them.

/// `TRYBUILD=overwrite cargo test -p hexagen-tests --test ui` refreshes the expected messages.
#[test]
fn errors_read_as_expected() {
    let cases = trybuild::TestCases::new();
    cases.compile_fail("ui/*.rs");
}
