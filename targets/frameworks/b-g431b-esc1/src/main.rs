//! A drive on the ST B-G431B-ESC1 (STM32G431CB), in Embassy.
//!
//! The ADCs' interrupt runs the control loop, above the executor; a task asks for current, another
//! reports over defmt. What the board's peripherals do is in [`board`].
#![no_std]
#![no_main]

mod board;

use board::Board;
use core::cell::RefCell;
use critical_section::Mutex;
use defmt_rtt as _;
use embassy_executor::Spawner;
use embassy_stm32::interrupt;
use embassy_time::Timer;
use hexagen::{ControlLoop, Drive, SetPoint};
use panic_probe as _;
use static_cell::StaticCell;

hexagen::controller! {
    /// A motor of this board's class, with Hall sensors on connector J8.
    pub HubDrive {
        motor: "../../motors/anaheim-bly172s.toml",
        inverter: {
            bus_voltage: 24 V,
            f_pwm: 20 kHz,
            timer_clock: 170 MHz,
            dead_time: 500 ns,
            adc_bits: 12,
            adc_range: 60 A,
            adc_inverted: on,
            max_current: 5 A,
            hall_timer_clock: 1 MHz,
        },
        controller: pdcc { hall_capture: timer },
    }
}

static DRIVE: StaticCell<Drive<HubDrive>> = StaticCell::new();

/// What the control interrupt owns.
type Owned = (ControlLoop<'static, HubDrive>, Board);

/// Handed over before the interrupt is let in, and its alone from then on.
static CONTROL: Mutex<RefCell<Option<Owned>>> = Mutex::new(RefCell::new(None));

/// Both ADCs have sampled: once per control period. Nothing may interrupt it, so that the critical
/// section delays nothing.
#[interrupt]
fn ADC1_2() {
    critical_section::with(|token| {
        if let Some((control, board)) = CONTROL.borrow_ref_mut(token).as_mut() {
            let sample = board.sample();
            board::apply(control.step(&sample));
        }
    });
}

/// Asks for current; await commands of your own here.
#[embassy_executor::task]
async fn drive(set_point: &'static SetPoint<HubDrive>) {
    while !set_point.status().is_running() {
        Timer::after_millis(10).await;
    }
    set_point.set_current_ma(500);
}

/// Ten lines a second.
#[embassy_executor::task]
async fn telemetry(set_point: &'static SetPoint<HubDrive>) {
    loop {
        Timer::after_millis(100).await;
        defmt::info!("{} {}", set_point.status(), set_point.signals());
        if board::has_tripped() {
            defmt::error!("a comparator has cut the outputs: over-current at a shunt");
        }
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let peripherals = embassy_stm32::init(board::clocks());
    let (set_point, mut control) = DRIVE.init(Drive::new()).split();
    // Offsets of the current sensors, then bootstrap capacitors; control begins by itself.
    control.calibrate();
    let mut board = Board::new(peripherals);
    board.start();
    critical_section::with(|token| CONTROL.replace(token, Some((control, board))));
    board::let_interrupt_in();
    spawner.spawn(drive(set_point).expect("one of it"));
    spawner.spawn(telemetry(set_point).expect("one of it"));
}
