//! Peers of the drives, counted on the same inputs.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
// The vector table.
use hexagen_cortex_m0 as _;
use hexagen_firmware::semihosted::run;
use peers::PEERS;

#[path = "../../../firmware/on_target/peers.rs"]
mod peers;

#[entry]
fn main() -> ! {
    run(PEERS)
}
