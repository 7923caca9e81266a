//! Demonstration of a main program while its interrupt controls the current.

use crate::registers::Registers;
use hexagen::{Control, Mode, Sample, SetPoint};
use semihosting::{eprintln, println, process};

/// Hall codes of a rotor that turns forward, from sector 1 on.
const CODES: [u8; 6] = [1, 5, 4, 6, 2, 3];

/// Control periods of a sector.
const SECTOR: usize = 40;

/// Control periods of the demonstration.
const PERIODS: usize = 2400;

/// ADCs at mid-scale, and a turning rotor.
fn sample(period: usize) -> Sample {
    Sample::with_hall([2048; 2], CODES[period / SECTOR % CODES.len()])
}

/// Waits until the drive controls, sets a current, turns the rotor, and ends the emulator:
/// successfully, if the drive controlled all the time and pulsed its legs.
pub fn run<C: Control>(
    set_point: &SetPoint<C>,
    registers: &Registers,
    start_timer: impl FnOnce(),
    wait_for_interrupt: impl Fn(),
) -> ! {
    let mut started = None;
    registers.feed(&sample(0));
    start_timer();
    for period in 0..PERIODS {
        registers.feed(&sample(period));
        wait_for_interrupt();
        let status = set_point.status();
        if status.mode == Mode::Run && started.is_none() {
            started = Some(period);
            set_point.set_current_ma(2_000);
        }
    }
    let (status, legs) = (set_point.status(), registers.legs());
    let from = started.unwrap_or(PERIODS);
    println!("{PERIODS} wake-ups, control from the {from}th on; {status:?}, {legs:?}");
    if status.is_running() && started.is_some() && legs.compare() != [0; 3] {
        process::exit(0)
    }
    eprintln!("the drive does not control");
    process::exit(1)
}
