//! A drive in RTIC: the control loop is a local resource of the task that the sampling interrupt starts.
#![no_std]
#![no_main]

#[rtic::app(device = lm3s6965)]
mod app {
    use cortex_m::asm::wfi;
    use hexagen_frameworks::hexagen::fixed::types::I16F16;
    use hexagen_frameworks::{Control, HubDrive, REGISTERS, SetPoint};

    #[shared]
    struct Shared {}

    #[local]
    struct Local {
        control: Control,
        set_point: &'static SetPoint,
    }

    #[init(local = [drive: HubDrive = HubDrive::new()])]
    fn init(context: init::Context) -> (Shared, Local) {
        let (set_point, mut control) = context.local.drive.split();
        // Offsets of the current sensors, then bootstrap capacitors; control begins by itself.
        control.calibrate();
        // Start the PWM timer and what triggers the converters here.
        (Shared {}, Local { control, set_point })
    }

    /// The converters have sampled: once per control period, above everything else.
    #[task(binds = ADC0_SEQUENCE_0, priority = 8, local = [control])]
    fn control_period(context: control_period::Context) {
        let control = context.local.control;
        let sample = REGISTERS.sample();
        let legs = control.step(sample.adc_a, sample.adc_b, sample.hall);
        REGISTERS.apply(legs);
    }

    #[idle(local = [set_point])]
    fn idle(context: idle::Context) -> ! {
        context.local.set_point.set_current(I16F16::lit("5"));
        loop {
            wfi();
        }
    }
}
