//! Peers of the drives, counted on the same inputs.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
// The vector table.
use hexagen_cortex_m4 as _;
use hexagen_firmware::semihosted::run;
use peers::PEERS;

#[path = "../../../firmware/on_target/peers.rs"]
mod peers;

#[entry]
fn main() -> ! {
    enable_fpu();
    run(PEERS)
}

/// Enables the core's floating-point unit. This program is built with instructions for it, the
/// others are not.
#[expect(unsafe_code, reason = "a register of the core")]
fn enable_fpu() {
    /// Access to coprocessors.
    const CPACR: *mut u32 = 0xe000_ed88 as *mut u32;
    // SAFETY: full access to coprocessors 10 and 11, before anything uses them.
    unsafe {
        CPACR.write_volatile(CPACR.read_volatile() | 0xf << 20);
        core::arch::asm!("dsb", "isb");
    }
}
