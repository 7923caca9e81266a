//! Expands the calls of the other crate like the macro, and prints the time of each part of the
//! generator. Part of the scratch workspace that `cargo xtask compile-time` writes.

use hexagen_codegen::expand_controller;
use hexagen_codegen::stopwatch::Part;

fn main() {
    let root = std::env::current_dir().expect("a folder");
    for call in include_str!("calls").lines() {
        let tokens = call.parse().expect("tokens");
        drop(expand_controller(tokens, &root));
    }
    for part in Part::ALL {
        let name = match part {
            Part::Parsing => "parsing",
            Part::Design => "design",
            Part::ProofRanges => "proof ranges",
            Part::Emission => "emission",
        };
        println!("{name}: {}", part.taken().as_secs_f64());
    }
}
