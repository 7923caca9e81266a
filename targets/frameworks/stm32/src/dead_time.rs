//! The dead-time generator's bits, from clocks or from a specification.

/// Clocks of the longest dead time.
const LONGEST: u128 = 1008;

/// The bits `DTG` of a dead time in timer clocks, rounded up to what the timer can do; none of one
/// that is longer than 1008 clocks. The timer's `CKD` is 0 (RM0440, RM0090: `TIMx_BDTR`).
///
/// ```
/// use hexagen_stm32::dead_time;
///
/// // 500 ns at 170 MHz: 85 clocks.
/// assert_eq!(dead_time(85), Some(85));
/// // 360 ns at 168 MHz: 61 clocks; 1 us: 168, in steps of two.
/// assert_eq!((dead_time(61), dead_time(168)), (Some(61), Some(0x94)));
/// assert_eq!(dead_time(1009), None);
/// ```
#[must_use]
pub const fn dead_time(clocks: u16) -> Option<u8> {
    Some(match clocks {
        0..=127 => clocks as u8,
        128..=254 => 0x80 | (clocks.div_ceil(2) - 64) as u8,
        255..=504 => 0xc0 | (clocks.div_ceil(8) - 32) as u8,
        505..=1008 => 0xe0 | (clocks.div_ceil(16) - 32) as u8,
        _ => return None,
    })
}

/// The bits `DTG` of the dead time that a drive's `SPEC` states, rounded up to clocks of its timer,
/// so that board and drive go by one number. None if it states none, or one that the timer cannot
/// make.
///
/// ```
/// use hexagen_stm32::specified_dead_time;
///
/// let spec = "[inverter]\ndead_time = 3.6e-7\n";
/// assert_eq!(specified_dead_time(spec, 168_000_000), Some(61));
/// ```
#[must_use]
pub const fn specified_dead_time(spec: &str, timer_hz: u32) -> Option<u8> {
    let Some(number) = value_of(spec.as_bytes(), b"\ndead_time = ") else {
        return None;
    };
    let picoseconds = picoseconds(number);
    let clocks = (picoseconds * timer_hz as u128).div_ceil(1_000_000_000_000);
    if clocks > LONGEST {
        return None;
    }
    dead_time(clocks as u16)
}

/// Whether a drive samples its shunts in the low legs at the timer's turning point, where the update event can start the
/// ADCs; otherwise a compare event has to (`SPEC`: `sampling_lead`, second, negative behind the turning point).
///
/// ```
/// use hexagen_stm32::is_sampled_at_update;
///
/// assert!(is_sampled_at_update("[inverter]\nsampling_lead = 0.0\n"));
/// assert!(!is_sampled_at_update("[inverter]\nsampling_lead = -5e-7\n"));
/// ```
#[must_use]
pub const fn is_sampled_at_update(spec: &str) -> bool {
    match value_of(spec.as_bytes(), b"\nsampling_lead = ") {
        Some(number) => picoseconds(number) == 0,
        None => false,
    }
}

/// What follows a key, to the end of the text.
const fn value_of<'t>(text: &'t [u8], key: &[u8]) -> Option<&'t [u8]> {
    let mut rest = text;
    while rest.len() > key.len() {
        let mut same = 0;
        while same < key.len() && rest[same] == key[same] {
            same += 1;
        }
        if same == key.len() {
            return Some(rest.split_at(same).1);
        }
        rest = rest.split_at(1).1;
    }
    None
}

/// A number of seconds at the beginning of a text, as Rust prints it: `3.6e-7`, `0.00001`. Whole
/// picoseconds, to the nearest: what conversion of units left in the last digits is none of the
/// specification's.
const fn picoseconds(text: &[u8]) -> u128 {
    let (mut digits, mut exponent, mut written) = (0, 12_i32, 0_i32);
    let (mut is_behind_point, mut is_behind_e, mut is_negative) = (false, false, false);
    let mut at = 0;
    while at < text.len() {
        match text[at] {
            digit @ b'0'..=b'9' if is_behind_e => written = 10 * written + (digit - b'0') as i32,
            digit @ b'0'..=b'9' => {
                digits = 10 * digits + (digit - b'0') as u128;
                exponent -= is_behind_point as i32;
            }
            b'.' => is_behind_point = true,
            b'e' => is_behind_e = true,
            b'-' if is_behind_e => is_negative = true,
            // The sign of the whole number is not asked for.
            b'-' => {}
            _ => break,
        }
        at += 1;
    }
    exponent += if is_negative { -written } else { written };
    let power = 10_u128.pow(exponent.unsigned_abs());
    if exponent < 0 {
        (digits + power / 2) / power
    } else {
        digits * power
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::{dead_time, specified_dead_time};
    use std::format;

    /// What the reference manuals say that the bits stand for.
    fn clocks(bits: u8) -> u16 {
        let bits = u16::from(bits);
        match bits >> 5 {
            0..=3 => bits,
            4..=5 => 2 * (64 + (bits & 0x3f)),
            6 => 8 * (32 + (bits & 0x1f)),
            _ => 16 * (32 + (bits & 0x1f)),
        }
    }

    #[test]
    fn a_dead_time_is_the_shortest_that_is_not_below_the_wanted_one() {
        for wanted in 0..=1008 {
            let found = dead_time(wanted).map(clocks);
            let shortest = (0..=255).map(clocks).filter(|&time| time >= wanted).min();
            assert_eq!(found, shortest, "{wanted}");
        }
    }

    #[test]
    fn a_specified_dead_time_is_rounded_up_to_clocks() {
        let bits = |number: &str, hz| {
            let spec = format!("[inverter]\nno_dead_time = 1.0\ndead_time = {number}\nf_pwm = 2e4");
            specified_dead_time(&spec, hz)
        };
        assert_eq!(bits("5e-7", 170_000_000), Some(85));
        assert_eq!(bits("5.000000000000001e-7", 170_000_000), Some(85));
        assert_eq!(bits("4.999999999999999e-7", 170_000_000), Some(85));
        assert_eq!(bits("5.01e-7", 170_000_000), Some(86));
        assert_eq!(bits("1e-6", 168_000_000), dead_time(168));
        assert_eq!(bits("0.00001", 100_000_000), dead_time(1000));
        assert_eq!(bits("1.009e-5", 100_000_000), None);
        assert_eq!(bits("1.0", 170_000_000), None);
    }

    #[test]
    fn without_a_dead_time_there_are_no_bits() {
        for spec in [
            "",
            "[inverter]\nf_pwm = 2e4\n",
            "\ndead_time_compensation = \"on\"\n",
        ] {
            assert_eq!(specified_dead_time(spec, 170_000_000), None);
        }
    }
}
