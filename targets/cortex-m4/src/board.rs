//! The board: its timer, and the registers of the motor's peripherals.
#![expect(
    unsafe_code,
    reason = "peripherals lie at fixed addresses, and vectors have fixed names"
)]

use hexagen_firmware::Registers;

/// ADCs, Hall port and PWM timer.
pub static REGISTERS: Registers = Registers::new();

/// Timer 0 of the MPS2 board's CMSDK peripherals, at 25 MHz.
const TIMER0: *mut u32 = 0x4000_0000 as *mut u32;

/// Interrupt of timer 0.
const TIMER0_IRQ: usize = 8;

/// Counts of a control period of 50 us.
const PERIOD: u32 = 1250;

unsafe extern "C" {
    fn DefaultHandler();
}

/// Vectors of the board's peripherals; those of the core are cortex-m-rt's.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [unsafe extern "C" fn(); 32] = {
    let mut vectors = [DefaultHandler as unsafe extern "C" fn(); 32];
    vectors[TIMER0_IRQ] = timer0;
    vectors
};

extern "C" fn timer0() {
    // SAFETY: the timer's clear register.
    unsafe { TIMER0.add(3).write_volatile(1) };
    crate::control::interrupt_trivedi_keshri_660w_pdcc();
}

/// Starts the timer whose interrupt runs the control loop.
pub fn start_timer() {
    /// Interrupts 0 to 31: set enable.
    const NVIC_ISER: *mut u32 = 0xe000_e100 as *mut u32;
    // SAFETY: registers of timer 0 (control, value, reload) and of the interrupt controller, used
    // only here.
    unsafe {
        TIMER0.add(2).write_volatile(PERIOD - 1);
        TIMER0.add(1).write_volatile(PERIOD - 1);
        NVIC_ISER.write_volatile(1 << TIMER0_IRQ);
        TIMER0.write_volatile(0b1001);
    }
}

/// Sleeps until an interrupt has run.
pub fn wait_for_interrupt() {
    cortex_m::asm::wfi();
}
