//! The control loop of this firmware, and its interrupt.
#![expect(
    unsafe_code,
    reason = "the bench finds the interrupt's function by its symbol"
)]

use crate::board::REGISTERS;
use core::cell::Cell;
use critical_section::Mutex;
use hexagen_firmware::hexagen::{self, ControlLoop, Drive, SetPoint};
use hexagen_firmware::interrupt::control_period;
use static_cell::StaticCell;

hexagen::controller! {
    /// The drive of this firmware, separate from those of the test bench.
    pub HubDrive {
        motor: "../motors/trivedi-keshri-660w.toml",
        controller: pdcc { reference: quasi_square, saturation: keep_angle, emf: held },
    }
}

static DRIVE: StaticCell<Drive<HubDrive>> = StaticCell::new();

/// The drive's control loop, used only by the interrupt once the timer runs.
static CONTROL: Mutex<Cell<Option<ControlLoop<'static, HubDrive>>>> = Mutex::new(Cell::new(None));

/// The drive's halves: the set-point for `main`, the control loop for the interrupt. Once, before
/// the timer starts.
pub fn hand_over() -> &'static SetPoint<HubDrive> {
    let (set_point, control) = DRIVE.init(Drive::new()).split();
    critical_section::with(|token| CONTROL.borrow(token).set(Some(control)));
    set_point
}

/// A call of the control loop, once it is installed.
#[inline]
pub fn with_control(call: impl FnOnce(&mut ControlLoop<'static, HubDrive>)) {
    critical_section::with(|token| {
        let place = CONTROL.borrow(token);
        if let Some(mut control) = place.take() {
            call(&mut control);
            place.set(Some(control));
        }
    });
}

/// The timer's interrupt. Nothing interrupts it, so that the critical section delays nothing.
#[unsafe(no_mangle)]
pub extern "C" fn interrupt_trivedi_keshri_660w_pdcc() {
    with_control(|control| control_period(control, &REGISTERS));
}
