//! A drive on the ST B-G431B-ESC1 (STM32G431CB), in Embassy.
//!
//! The ADCs' interrupt runs the control loop, above the executor; a task asks for current, another
//! reports over defmt. What the board's peripherals do is in [`board`].
#![no_std]
#![no_main]

mod board;

use board::Board;
use core::cell::RefCell;
use core::sync::atomic::{AtomicU16, Ordering};
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
    ///
    /// The board has a shunt in each lower leg. Those of phases a and b are read, at once by two
    /// ADCs; all legs are pulsed, so that both can be read in every period.
    pub HubDrive {
        motor: "../../motors/anaheim-bly172s.toml",
        board: "st-b-g431b-esc1",
        inverter: { bus_voltage: 24.5 V, sensed_phases: ab, conversion_time: 0 us, max_current: 5 A },
        controller: pdcc,
    }
}

static DRIVE: StaticCell<Drive<HubDrive>> = StaticCell::new();

/// The set-point in milliamperes; with `None` all legs stay off. `BRING-UP.md` says what to put
/// here when.
const SET_POINT_MA: Option<i32> = None;

/// What was sampled last, for people: counts of phases a and b, and the Hall code.
static SAMPLED: [AtomicU16; 3] = [const { AtomicU16::new(0) }; 3];

/// Room for the state words of a trip.
const STATE_WORDS: usize = 64;

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
            if SET_POINT_MA.is_none() {
                control.coast();
            }
            board::apply(control.step(&sample));
            let [a, b, _] = sample.adc();
            for (place, word) in SAMPLED.iter().zip([a, b, sample.hall().into()]) {
                place.store(word, Ordering::Relaxed);
            }
        }
    });
}

/// Asks for current as soon as it is controlled; await commands of your own here.
#[embassy_executor::task]
async fn drive(set_point: &'static SetPoint<HubDrive>) {
    while !set_point.status().is_running() {
        Timer::after_millis(10).await;
    }
    set_point.set_current_ma(SET_POINT_MA.unwrap_or(0));
}

/// Ten times a second: mode and fault, counts and Hall code, and the signals of a controlled
/// period. A trip is told once, with all that the drive keeps of its control period.
#[embassy_executor::task]
async fn telemetry(set_point: &'static SetPoint<HubDrive>) {
    let mut is_told = false;
    loop {
        Timer::after_millis(100).await;
        let status = set_point.status();
        let [a, b, hall] = SAMPLED.each_ref().map(|word| word.load(Ordering::Relaxed));
        defmt::info!("{} {}", status.mode, status.fault);
        defmt::info!("counts {} {}, Hall code {=u16:03b}", a, b, hall);
        defmt::info!("{}", set_point.signals());
        if board::has_tripped() {
            defmt::error!("a comparator has cut the outputs: over-current at a shunt");
        }
        let mut words = [0; STATE_WORDS];
        let trip = set_point.trip(&mut words);
        if let (Some(trip), false) = (trip, is_told) {
            defmt::error!("{}", trip);
            for (name, word) in Drive::<HubDrive>::state_names().zip(words) {
                defmt::error!("{=str}: {=i32}", name, word);
            }
        }
        is_told = trip.is_some();
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
