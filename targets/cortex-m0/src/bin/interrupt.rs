//! Counts the whole interrupt of the firmware, called as a function on recorded inputs; the timer does not run.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use hexagen_cortex_m0::board::REGISTERS;
use hexagen_cortex_m0::control::{hand_over, interrupt_trivedi_keshri_660w_pdcc, reset};
use hexagen_firmware::interrupt::serve;
use hexagen_firmware::semihosted::run_with;

#[entry]
fn main() -> ! {
    let set_point = hand_over(|_| ());
    run_with(|link| {
        serve(
            link,
            set_point,
            &REGISTERS,
            reset,
            interrupt_trivedi_keshri_660w_pdcc,
        )
    })
}
