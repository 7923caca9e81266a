//! A drive in Embassy: an interrupt above the executor runs the control loop, and tasks share its
//! set-point.
#![no_std]
#![no_main]

use core::cell::Cell;
use core::future::pending;
use critical_section::Mutex;
use embassy_executor::Spawner;
use hexagen_frameworks::{ControlLoop, Drive, REGISTERS, SetPoint};
use lm3s6965::interrupt;
use static_cell::StaticCell;

static DRIVE: StaticCell<Drive> = StaticCell::new();

/// Set before the interrupt is enabled; used only by it from then on.
static CONTROL: Mutex<Cell<Option<ControlLoop>>> = Mutex::new(Cell::new(None));

/// The ADCs have sampled: once per control period. Nothing may interrupt it, so that the critical
/// section delays nothing.
#[interrupt]
fn ADC0_SEQUENCE_0() {
    critical_section::with(|token| {
        let place = CONTROL.borrow(token);
        if let Some(mut control) = place.take() {
            REGISTERS.apply(control.step(&REGISTERS.sample()));
            place.set(Some(control));
        }
    });
}

#[embassy_executor::task]
async fn follow(set_point: &'static SetPoint) {
    set_point.set_current_ma(5_000);
    // Await commands here: every task may change the set-point, without a lock.
    pending::<()>().await;
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let (set_point, mut control) = DRIVE.init(Drive::new()).split();
    // Offsets of the current sensors, then bootstrap capacitors; control follows automatically.
    control.calibrate();
    critical_section::with(|token| CONTROL.borrow(token).set(Some(control)));
    // Start the PWM timer and the ADCs' trigger, and enable the interrupt, here.
    spawner.spawn(follow(set_point).expect("one instance"));
}
