//! The firmware: a control loop in the timer's interrupt; `main` sets its current.
#![no_std]
#![no_main]

use hexagen_firmware::demonstration;
use hexagen_firmware::hexagen::ControlLoop;
use hexagen_riscv32::board::{REGISTERS, start_timer, wait_for_interrupt};
use hexagen_riscv32::control::{hand_over, with_control};
use riscv_rt::entry;

#[entry]
fn main() -> ! {
    let set_point = hand_over();
    with_control(ControlLoop::calibrate);
    demonstration::run(set_point, &REGISTERS, start_timer, wait_for_interrupt)
}
