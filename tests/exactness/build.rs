//! Has the reference models' text built over bounded words.

fn main() {
    println!("cargo::rustc-cfg=bounded");
    println!("cargo::rerun-if-changed=build.rs");
}
