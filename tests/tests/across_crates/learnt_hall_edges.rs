//! What firmware reads of the learnt Hall edges.

use fixed::types::I16F16;
use hexagen::{Drive, Sample};

hexagen::controller! {
    /// At 625 rpm an electrical turn takes 480 periods of 50 ticks.
    pub Learning {
        motor: "../targets/motors/trivedi-keshri-660w.toml",
        controller: pdcc { hall_learning: on },
    }
}

/// Codes of sectors 1 to 6.
const CODES: [u8; 6] = [0b001, 0b101, 0b100, 0b110, 0b010, 0b011];

/// Periods of sectors 1 to 6 of 480, and their ticks. Sectors 1 and 4 last 64.5 degrees, 2 and 5 55.5, 3 and 6 60: the
/// sensor whose edges begin sectors 2 and 5 is 4.5 degrees late.
const SECTORS: [u16; 6] = [86, 74, 80, 86, 74, 80];
const TICKS: u16 = 50;
const EXPECTED: [f64; 3] = [0.0, 4.5, 0.0];

/// So many electrical turns without a current.
fn turn(drive: &mut Drive<Learning>, turns: usize) {
    for sector in (0..6).cycle().take(6 * turns) {
        for period in 0..SECTORS[sector] {
            let sample = Sample::with_hall([2048; 2], CODES[sector]);
            drive.step(&sample.hall_ticks(TICKS * period + TICKS / 2));
        }
    }
}

#[test]
fn firmware_reads_how_the_edges_stand_until_a_reset() {
    let mut drive = Drive::<Learning>::new();
    assert_eq!(drive.split().1.hall_offsets(), [I16F16::ZERO; 3]);
    turn(&mut drive, 40);
    let found = drive.split().1.hall_offsets().map(f64::from);
    for (found, expected) in found.into_iter().zip(EXPECTED) {
        assert!((found - expected).abs() < 0.3, "{found} for {expected}");
    }
    drive.reset();
    assert_eq!(drive.split().1.hall_offsets(), [I16F16::ZERO; 3]);
}
