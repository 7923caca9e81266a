//! Running the program and looking at what it says.

use serde_json::Value;
use std::ffi::OsStr;
use std::process::{Command, Output};
use std::sync::LazyLock;

/// The motor that most tests run: known by name.
pub const PAPER: &str = "trivedi-keshri-660w";

/// The program, ready for arguments.
pub fn hexagen() -> Command {
    Command::new(env!("CARGO_BIN_EXE_hexagen"))
}

/// What a run said.
#[derive(Debug)]
pub struct Said {
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        let said = Self {
            code: output.status.code().expect("the program ends by itself"),
            stdout: String::from_utf8(output.stdout).expect("text on stdout"),
            stderr: String::from_utf8(output.stderr).expect("text on stderr"),
        };
        assert!(!said.stderr.contains("panicked"), "{}", said.stderr);
        said
    }
}

/// Runs the program to its end.
pub fn run<A: AsRef<OsStr>>(arguments: impl IntoIterator<Item = A>) -> Said {
    let output = hexagen().args(arguments).output();
    output.expect("the program starts").into()
}

impl Said {
    /// Expects success, and one JSON object and nothing else on stdout.
    #[track_caller]
    pub fn json(&self) -> Value {
        assert_eq!(self.code, 0, "{self:?}");
        self.json_whatever_the_code()
    }

    #[track_caller]
    pub fn json_whatever_the_code(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout).expect("one JSON value");
        assert!(value.is_object(), "{value}");
        value
    }

    /// Expects bad input: code 2, nothing on stdout, all of `texts` on stderr.
    #[track_caller]
    pub fn assert_bad_input(&self, texts: &[&str]) {
        assert_eq!((self.code, self.stdout.as_str()), (2, ""), "{self:?}");
        for text in texts {
            assert!(
                self.stderr.contains(text),
                "no `{text}` in\n{}",
                self.stderr
            );
        }
    }
}

/// What `motors` says; simulating the whole library takes long.
pub static LIBRARY: LazyLock<Said> = LazyLock::new(|| run(["motors"]));

/// What `motors --json` says.
pub static LIBRARY_AS_JSON: LazyLock<Value> = LazyLock::new(|| run(["motors", "--json"]).json());

/// The keys of an object, in their order.
#[track_caller]
pub fn keys(value: &Value) -> Vec<&str> {
    let object = value.as_object().expect("an object");
    object.keys().map(String::as_str).collect()
}

/// A number of an object.
#[track_caller]
pub fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("no number `{key}` in {value}"))
}
