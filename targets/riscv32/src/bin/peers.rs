//! Peers of the drives, counted on the same inputs.
#![no_std]
#![no_main]

use hexagen_firmware::semihosted::run;
use peers::PEERS;
use riscv_rt::entry;

#[path = "../../../firmware/on_target/peers.rs"]
mod peers;

#[entry]
fn main() -> ! {
    run(PEERS)
}
