//! The bench's end on this core: replays recorded vectors on every drive of this firmware.
#![no_std]
#![no_main]

use hexagen_firmware::semihosted::run;
use hexagen_riscv32::drives::DRIVES;
use riscv_rt::entry;

#[entry]
fn main() -> ! {
    run(DRIVES)
}
