//! A drive in RTIC: the control loop is a local resource of the task that the sampling interrupt
//! starts.
#![no_std]
#![no_main]

#[rtic::app(device = lm3s6965)]
mod app {
    use cortex_m::asm::wfi;
    use hexagen_frameworks::{ControlLoop, Drive, REGISTERS, SetPoint};

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        control: ControlLoop,
        set_point: &'static SetPoint,
    }

    #[init(local = [drive: Drive = Drive::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let (set_point, mut control) = context.local.drive.split();
        // Offsets of the current sensors, then bootstrap capacitors; control follows automatically.
        control.calibrate();
        // Start the PWM timer and the ADCs' trigger here.
        (Shared {}, Local { control, set_point })
    }

    /// The ADCs have sampled: once per control period, at the highest priority.
    #[task(binds = ADC0_SEQUENCE_0, priority = 8, local = [control])]
    fn control_period(context: control_period::Context) {
        let control = context.local.control;
        REGISTERS.apply(control.step(&REGISTERS.sample()));
    }

    #[idle(local = [set_point])]
    fn idle(context: idle::Context) -> ! {
        context.local.set_point.set_current_ma(5_000);
        loop {
            wfi();
        }
    }
}
