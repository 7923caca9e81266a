//! The interpreted IR computes what the bit-true model computes, on every output and state bit.

use hexagen_tests::interpreter::compare;
use hexagen_tests::library::{PAPER_MOTOR, motor, motors};
use hexagen_tests::options::{choice_of, default_choice, describe, drive_toml, generate_toml};

#[test]
fn default_drive_of_the_paper_motor() {
    let toml = drive_toml(&motor(PAPER_MOTOR), &default_choice(), None);
    let (_, generated) = generate_toml(&toml).expect("the paper's motor generates");
    let report = compare(&generated, generated.graph.program(), 200_000, 1).unwrap_or_else(|what| panic!("{what}"));
    println!("{report}");
}
