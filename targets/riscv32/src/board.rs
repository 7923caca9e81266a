//! The board: its timer, and the registers of the motor's peripherals.
#![expect(
    unsafe_code,
    reason = "peripherals lie at fixed addresses, and vectors have fixed names"
)]

use hexagen_firmware::Registers;
use riscv::register::mie;

/// ADCs, Hall port and PWM timer.
pub static REGISTERS: Registers = Registers::new();

/// The hart's timer of `virt`, 10 MHz: compare value and time, 64 bits each.
const MTIMECMP: *mut u64 = 0x0200_4000 as *mut u64;
const MTIME: *const u64 = 0x0200_bff8 as *const u64;

/// Counts of a control period of 50 us.
const PERIOD: u64 = 500;

/// The vector of the machine's timer interrupt.
#[unsafe(no_mangle)]
extern "C" fn MachineTimer() {
    // SAFETY: the timer's compare register, which only this interrupt writes after its first run.
    unsafe { MTIMECMP.write_volatile(MTIMECMP.read_volatile() + PERIOD) };
    crate::control::interrupt_trivedi_keshri_660w_pdcc();
}

/// Starts the timer whose interrupt runs the control loop.
pub fn start_timer() {
    // SAFETY: the timer's registers; its interrupt is not enabled before.
    unsafe {
        MTIMECMP.write_volatile(MTIME.read_volatile() + PERIOD);
        mie::set_mtimer();
        riscv::interrupt::enable();
    }
}

/// Sleeps until an interrupt has run.
pub fn wait_for_interrupt() {
    riscv::asm::wfi();
}
