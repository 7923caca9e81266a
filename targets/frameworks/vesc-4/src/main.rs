//! A drive on a VESC 4 (STM32F405, DRV8302, two shunts in the lower legs), in RTIC 2.
//!
//! The control loop is a local resource of the task that the ADCs' interrupt starts: no lock at
//! all. What the board's peripherals do is in [`board`].
#![no_std]
#![no_main]

mod board;

use panic_halt as _;

hexagen::controller! {
    /// A motor of this board's class, with Hall sensors. All legs are pulsed, so that the shunts in
    /// the lower legs of phases a and b can be read in every period. Hall edges are seen at samples, so
    /// that at the board's 12.5 kHz the torque would ripple by up to 6 % (HX0620).
    pub HubDrive {
        motor: "../../motors/trivedi-keshri-660w.toml",
        board: "vesc-4",
        inverter: { f_pwm: 20 kHz },
        controller: pdcc { hall_capture: sampled },
    }
}

/// The set-point in milliamperes; with `None` all legs stay off. `BRING-UP.md` says what to put
/// here when.
const SET_POINT_MA: Option<i32> = None;

#[rtic::app(device = stm32f4xx_hal::pac)]
mod app {
    use crate::board::{Board, Lights};
    use crate::{HubDrive, SET_POINT_MA};
    use cortex_m::asm::wfi;
    use hexagen::{ControlLoop, Drive, SetPoint};

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        control: ControlLoop<'static, HubDrive>,
        board: Board,
        set_point: &'static SetPoint<HubDrive>,
        lights: Lights,
    }

    #[init(local = [drive: Drive<HubDrive> = Drive::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let (set_point, mut control) = context.local.drive.split();
        // Offsets of the current sensors, then bootstrap capacitors; control begins by itself.
        control.calibrate();
        let (mut board, lights) = Board::new(context.device);
        board.start();
        let local = Local {
            control,
            board,
            set_point,
            lights,
        };
        (Shared {}, local)
    }

    /// Both ADCs have sampled: once per control period, above everything else.
    #[task(binds = ADC, priority = 15, local = [control, board])]
    fn control_period(context: control_period::Context) {
        let control_period::LocalResources { control, board, .. } = context.local;
        let sample = board.sample();
        if SET_POINT_MA.is_none() {
            control.coast();
        }
        board.apply(control.step(&sample));
    }

    /// Asks for current; the green light says that currents are controlled, the red one that the
    /// drive has tripped.
    #[idle(local = [set_point, lights])]
    fn idle(context: idle::Context) -> ! {
        let idle::LocalResources {
            set_point, lights, ..
        } = context.local;
        loop {
            let status = set_point.status();
            lights.show(status.is_running(), status.fault.is_some());
            if status.is_running() {
                set_point.set_current_ma(SET_POINT_MA.unwrap_or(0));
            }
            wfi();
        }
    }
}
