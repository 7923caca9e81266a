//! The bench's end on this core for the drives that are emitted as C.
#![no_std]
#![no_main]

use hexagen_firmware::semihosted::run;
use hexagen_firmware_c::DRIVES;
use riscv_rt::entry;

#[entry]
fn main() -> ! {
    run(DRIVES)
}
