//! Peers of the drives, counted on the same inputs.
#![no_std]
#![no_main]

use cortex_m_rt::entry;
// The vector table.
use hexagen_cortex_m4 as _;
use hexagen_firmware::hexagen::fixed::types::I16F16;
use hexagen_firmware::peers::{FcsMpc, FocLoop, IdspLoop, Pdcc, Phcc, PiPwm};
use hexagen_firmware::semihosted::run;

hexagen_firmware::peers! {
    step_f32_pdcc: Pdcc<f32>;
    step_f32_fcs_mpc: FcsMpc<f32>;
    step_f32_phcc: Phcc<f32>;
    step_f32_pi_pwm: PiPwm<f32>;
    step_i16f16_pdcc: Pdcc<I16F16>;
    step_i16f16_fcs_mpc: FcsMpc<I16F16>;
    step_i16f16_phcc: Phcc<I16F16>;
    step_i16f16_pi_pwm: PiPwm<I16F16>;
    step_foc: FocLoop;
    step_idsp: IdspLoop;
}

#[entry]
fn main() -> ! {
    enable_fpu();
    run(PEERS)
}

/// Lets the core's floating-point unit work. This program is built with instructions for it, the others are not.
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
