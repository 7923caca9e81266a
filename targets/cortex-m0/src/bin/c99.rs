//! The bench's end on this core for the drives that are emitted as C.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
// The vector table.
use hexagen_cortex_m0 as _;
use hexagen_firmware::semihosted::run;
use hexagen_firmware_c::DRIVES;

#[entry]
fn main() -> ! {
    run(DRIVES)
}
