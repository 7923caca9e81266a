//! Counts the instructions of a call and measures its stack, on the emulated core itself.
//!
//! A call goes through a few lines of assembly that are the same for every function: load the
//! arguments, read the clock, call, read the clock. Their cost is measured with an empty function.
//! On RISC-V the clock is `minstret`. On Cortex-M it is SysTick of QEMU's MPS2 boards, 40 ns per
//! tick, under `-icount shift=10`, which takes 1024 ns per instruction: one instruction is 25.6
//! ticks, so none is missed.
#![expect(
    unsafe_code,
    reason = "the functions of counter.s are known to the linker only, and clocks lie at fixed addresses"
)]

use crate::drives::{LegsInC, SampleInC, StepFn};
use core::arch::global_asm;
use core::ffi::c_void;
use hexagen::{LegState, Sample};

#[cfg(target_arch = "arm")]
global_asm!(include_str!("counter_arm.s"));
#[cfg(target_arch = "riscv32")]
global_asm!(include_str!("counter_riscv32.s"));

/// Instructions of a loop, counted by hand.
const KNOWN: u32 = 64;

/// The function and its arguments, in the order in which the assembly loads them: four in
/// registers, two on the stack.
#[repr(C)]
struct Call {
    step: *const c_void,
    arguments: [usize; 6],
}

unsafe extern "C" {
    /// Ticks of a call.
    fn hexagen_counted_call(call: *const Call) -> u32;
    /// Bytes below the stack pointer that a call writes.
    fn hexagen_sounded_call(call: *const Call) -> u32;
    /// A step that returns at once.
    fn hexagen_empty_step();
    /// A step of [`KNOWN`] instructions.
    fn hexagen_known_step();
}

fn call<D>(
    assembly: unsafe extern "C" fn(*const Call) -> u32,
    step: StepFn<D>,
    drive: &mut D,
    sample: Sample,
) -> u32 {
    let mut legs = LegsInC {
        compare: [0; 3],
        state: [LegState::Off; 3],
    };
    let legs = (&raw mut legs).expose_provenance();
    let drive = core::ptr::from_mut(drive).expose_provenance();
    let in_c = SampleInC::from(sample);
    let in_c = (&raw const in_c).expose_provenance();
    let [adc_a, adc_b, _] = sample.adc();
    let [adc_a, adc_b, ticks] = [adc_a, adc_b, sample.ticks()].map(usize::from);
    let hall = usize::from(sample.hall());
    // Space for a returned structure precedes all other arguments.
    let (step, arguments) = match step {
        StepFn::Bits(step) => (step as *const c_void, [drive, adc_a, adc_b, hall, ticks, 0]),
        StepFn::Structure(step) => (step as *const c_void, [legs, drive, in_c, 0, 0, 0]),
    };
    // SAFETY: the assembly calls `step` by its type, with valid and unshared pointers.
    unsafe { assembly(&Call { step, arguments }) }
}

/// Instructions of one call, from the function's entry to its return, both included. `None` if the
/// count of a known loop is wrong: then the clock does not follow instructions.
pub fn count<D>(step: StepFn<D>, drive: &mut D, sample: Sample) -> Option<u32> {
    start_clock();
    let around = call(
        hexagen_counted_call,
        assembly(hexagen_empty_step),
        &mut (),
        sample,
    );
    // The empty step is one instruction.
    let of = |ticks: u32| instructions(ticks.wrapping_sub(around)) + 1;
    let known = call(
        hexagen_counted_call,
        assembly(hexagen_known_step),
        &mut (),
        sample,
    );
    if of(known) != KNOWN {
        return None;
    }
    Some(of(call(hexagen_counted_call, step, drive, sample)))
}

/// The call of [`count`] without counting, for a log of its instructions. `None` on hosts.
pub fn trace<D>(step: StepFn<D>, drive: &mut D, sample: Sample) -> Option<()> {
    call(hexagen_counted_call, step, drive, sample);
    Some(())
}

/// A step in assembly.
fn assembly(function: unsafe extern "C" fn()) -> StepFn<()> {
    // SAFETY: both such steps take any arguments, and touch no memory.
    StepFn::Bits(unsafe { core::mem::transmute(function) })
}

/// An interrupt's function as a step.
pub fn interrupt_step(interrupt: extern "C" fn()) -> StepFn<()> {
    // SAFETY: a function without arguments ignores them; its result is not used.
    StepFn::Bits(unsafe { core::mem::transmute(interrupt) })
}

/// Bytes of stack that one call uses.
pub fn sound<D>(step: StepFn<D>, drive: &mut D, sample: Sample) -> Option<u32> {
    Some(call(hexagen_sounded_call, step, drive, sample))
}

#[cfg(target_arch = "arm")]
fn start_clock() {
    /// SysTick: control (enabled, from the core's clock), reload value.
    const CONTROL: *mut u32 = 0xe000_e010 as *mut u32;
    const RELOAD: *mut u32 = 0xe000_e014 as *mut u32;
    // SAFETY: the core's own timer, used only here.
    unsafe {
        if CONTROL.read_volatile() & 1 == 0 {
            RELOAD.write_volatile(0x00ff_ffff);
            CONTROL.write_volatile(0b101);
        }
    }
}

#[cfg(target_arch = "arm")]
fn instructions(ticks: u32) -> u32 {
    // 24 bits; 1024 ns per instruction, 40 ns per tick.
    ((ticks & 0x00ff_ffff) * 40 + 512) >> 10
}

#[cfg(target_arch = "riscv32")]
fn start_clock() {}

#[cfg(target_arch = "riscv32")]
fn instructions(ticks: u32) -> u32 {
    ticks
}
