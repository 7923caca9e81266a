//! The firmware: a control loop in the timer's interrupt; `main` sets its current.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
use hexagen_cortex_m4::board::{REGISTERS, start_timer, wait_for_interrupt};
use hexagen_cortex_m4::control::{hand_over, with_control};
use hexagen_firmware::demonstration;
use hexagen_firmware::hexagen::ControlLoop;

#[entry]
fn main() -> ! {
    let set_point = hand_over();
    with_control(ControlLoop::calibrate);
    demonstration::run(set_point, &REGISTERS, start_timer, wait_for_interrupt)
}
