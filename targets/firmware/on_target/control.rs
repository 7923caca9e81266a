//! The control loop of this firmware, and its interrupt.
#![expect(
    unsafe_code,
    reason = "the interrupt's function has a stable name, and a static of its own"
)]

use crate::board::REGISTERS;
use hexagen_firmware::interrupt::control_period;
use hexagen_firmware::{Handed, hexagen};

hexagen::controller! {
    /// The drive of this firmware, a type of its own beside those of the test bench.
    pub HubDrive {
        motor: "../motors/trivedi-keshri-660w.toml",
        controller: pdcc { saturation: keep_angle, emf: held },
    }
}

type Loop = <HubDrive as hexagen::Drive>::LoopHalf<'static>;
type SetPoint = <HubDrive as hexagen::Drive>::SetPointHalf;

static DRIVE: Handed<HubDrive> = Handed::new();
static CONTROL: Handed<Loop> = Handed::new();

/// The drive's halves: the set-point for `main`, the control loop for the interrupt, after `prepare` had it. Once,
/// before the timer starts.
pub fn hand_over(prepare: impl FnOnce(&mut Loop)) -> &'static SetPoint {
    // SAFETY: called once, from `main`; the interrupt does not run yet.
    let (set_point, control) = unsafe { DRIVE.hand_over(HubDrive::new()) }.split();
    // SAFETY: likewise.
    prepare(unsafe { CONTROL.hand_over(control) });
    set_point
}

/// What the timer's interrupt does; behind [`hand_over`] alone.
#[unsafe(no_mangle)]
pub extern "C" fn interrupt_trivedi_keshri_660w_pdcc() {
    // SAFETY: the only one that takes the control loop; the timer starts behind the hand-over.
    let control = unsafe { CONTROL.take_turn() };
    control_period(control, &REGISTERS);
}

/// Begins again from rest; from where the interrupt's function is called, and behind [`hand_over`], too.
pub fn reset() {
    // SAFETY: as above.
    unsafe { CONTROL.take_turn() }.reset();
}
