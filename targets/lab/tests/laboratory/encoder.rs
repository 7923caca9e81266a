//! Motors of the library with a coarse encoder on the shaft in place of their own sensors.

use hexagen_lab::engine::MotorSource;

/// Bits of a turn of the shaft.
const BITS: u32 = 12;

/// A motor with an encoder whose angle falls in forward rotation.
pub fn with_encoder(motor: &str, pole_pairs: u32) -> MotorSource {
    let mut source = MotorSource::of_library(motor).expect("is in the library");
    let is_other = |line: &&str| !line.starts_with("rotor =") && !line.starts_with("angle_");
    let lines: Vec<&str> = source.text.lines().filter(is_other).collect();
    let text = lines.join("\n") + "\n";
    let fields = format!(
        "[motor]\nrotor = \"angle\"\nangle_pole_pairs = {pole_pairs}\nangle_bits = {BITS}\n\
         angle_offset = \"-73 deg\"\nangle_direction = \"backward\"\n"
    );
    source.text = text.replacen("[motor]\n", &fields, 1);
    source
}
