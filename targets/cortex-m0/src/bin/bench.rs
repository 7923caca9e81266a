//! The bench's end on this core: replays recorded vectors on every drive of this firmware.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use hexagen_cortex_m0::drives::DRIVES;
use hexagen_firmware::semihosted::run;

#[entry]
fn main() -> ! {
    run(DRIVES)
}
