//! Counts the whole interrupt of the firmware, called as a function on recorded inputs; the timer
//! does not run.
#![no_std]
#![no_main]

use hexagen_firmware::hexagen::ControlLoop;
use hexagen_firmware::interrupt::serve;
use hexagen_firmware::semihosted::run_with;
use hexagen_riscv32::board::REGISTERS;
use hexagen_riscv32::control::{hand_over, interrupt_trivedi_keshri_660w_pdcc, with_control};
use riscv_rt::entry;

#[entry]
fn main() -> ! {
    let set_point = hand_over();
    run_with(|link| {
        serve(
            link,
            set_point,
            &REGISTERS,
            || with_control(ControlLoop::reset),
            interrupt_trivedi_keshri_660w_pdcc,
        )
    })
}
