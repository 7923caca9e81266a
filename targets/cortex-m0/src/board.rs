//! The board: its timer, and the registers of the motor's peripherals.
#![expect(
    unsafe_code,
    reason = "peripherals lie at fixed addresses, and vectors have fixed names"
)]

use hexagen_firmware::Registers;

/// ADCs, Hall port and PWM timer.
pub static REGISTERS: Registers = Registers::new();

/// Timer 0 of the nRF51, at 16 MHz.
const TIMER0: *mut u32 = 0x4000_8000 as *mut u32;

/// Interrupt of timer 0.
const TIMER0_IRQ: usize = 8;

/// Counts of a control period of 50 us.
const PERIOD: u32 = 800;

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
    // SAFETY: the timer's event of compare channel 0.
    unsafe { TIMER0.byte_add(0x140).write_volatile(0) };
    crate::control::interrupt_trivedi_keshri_660w_pdcc();
}

/// Starts the timer whose interrupt runs the control loop.
pub fn start_timer() {
    /// Interrupts 0 to 31: set enable.
    const NVIC_ISER: *mut u32 = 0xe000_e100 as *mut u32;
    // SAFETY: registers of timer 0 (width, prescaler, compare, shortcut to clear, interrupt, start)
    // and of the interrupt controller, used only here.
    unsafe {
        TIMER0.byte_add(0x508).write_volatile(0);
        TIMER0.byte_add(0x510).write_volatile(0);
        TIMER0.byte_add(0x540).write_volatile(PERIOD);
        TIMER0.byte_add(0x200).write_volatile(1);
        TIMER0.byte_add(0x304).write_volatile(1 << 16);
        NVIC_ISER.write_volatile(1 << TIMER0_IRQ);
        TIMER0.write_volatile(1);
    }
}

/// Sleeps until an interrupt has run.
pub fn wait_for_interrupt() {
    cortex_m::asm::wfi();
}
